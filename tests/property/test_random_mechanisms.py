"""Random mechanisms of masses, contacts, springs with play and a PID, against SciPy from event to event."""

import numpy as np
import pytest
from random_mechanisms import END, TIMES, by_friction, by_scipy, random_row


@pytest.mark.parametrize("seed", range(6))
def test_states_and_events_are_those_of_an_independent_integrator(seed):
    """`python -m benchmarks.attack mechanisms` has more of them; SciPy at 1e-12 is known to 1e-8 here."""
    row, times = random_row(seed), np.linspace(0.0, END, TIMES)
    status, found = by_friction(row, times)
    exact = by_scipy(row, times)
    assert status == 0
    assert [len(one) for one in found.events] == [len(one) for one in exact.events]
    for one, other in zip(found.events, exact.events, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-7)
    np.testing.assert_allclose(found.states, exact.states, rtol=0, atol=1e-8 * np.abs(exact.states).max())
