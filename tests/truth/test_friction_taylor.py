"""Bristles by Taylor series where soft and by Rodas5P where stiff, against SciPy's DOP853 at 1e-13."""

import numpy as np
import pytest
from friction_by_scipy import END, TOLS, largest_errors, reference

from friction import Dahl, LuGre, Ramp, Sine, Spring, Table, Testbench

CASES = {
    "soft": (LuGre(sigma0=50.0), Testbench(Sine(2.0, 1.0))),
    "fast": (LuGre(sigma1=3.0, v_s=0.01), Testbench(Ramp(3.0), v0=-1.0)),  # from 100 v_s through the Stribeck peak
    "stiff at times": (LuGre(sigma0=1e4, sigma1=10.0), Testbench(Ramp(0.0), spring=Spring(200.0, 0.1))),
    "corners": (Dahl(sigma0=2e3), Testbench(Table([0.0, 0.5, 0.9, 1.4], [0.0, 1.5, -1.2, 0.3]))),
}


@pytest.mark.parametrize("case", CASES)
def test_errors_are_within_the_tolerance_and_the_estimate(case):
    model, bench = CASES[case]
    times = np.linspace(0.0, END, 101)
    exact = reference(model, bench, times)
    for tol in TOLS:
        errors, estimate = largest_errors(model, bench, exact, times, tol, "taylor")
        assert errors.max() <= min(tol, estimate)
