"""Taylor series of bristles: a step grows with the sixteenth root of the tolerance where the contact is soft."""

import numpy as np
import pytest

from friction import METHODS, LuGre, Ramp, Spring, Testbench, simulate


def test_steps_grow_with_the_sixteenth_root_of_the_tolerance():
    bench, tols = Testbench(Ramp(0.0), spring=Spring(20.0, 0.05)), np.array([1e-4, 1e-7, 1e-10])
    steps = [simulate(LuGre(sigma0=20.0), bench, 10.0, "taylor", tol=tol, times=[10.0]).steps for tol in tols]
    assert -np.polyfit(np.log(tols), np.log(steps), 1)[0] == pytest.approx(1.0 / METHODS["taylor"].order, abs=0.015)
