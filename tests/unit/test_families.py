"""Waveforms as sums of parts, each with the fronts that lie at one place of their slabs."""

import numpy as np
import pytest

from tline.scene.waveform import PiecewiseLinear, Pulses, Sine, Step
from tline.solver.convolution.families import changes_of, family_of, leads

END = 10.0
WAVEFORMS = [
    Step(to=2, at=1.3),
    Step(from_=1, to=2, at=0),
    Pulses(low=0.5, high=1, at=0.3, width=0.4, rise=0.05, fall=0.1, period=1.7),
    PiecewiseLinear(points=[(0.0, 0.0), (1.0, 3.0), (2.5, 3.0), (2.5, -1.0), (7.0, 0.0)]),
]


def test_leads_put_instants_at_edges():
    ahead = leads(np.array([0.3, 1.3 + 1e-12, 5.0, 7.25]))
    assert ahead == pytest.approx([0.0, 0.7, 0.75], abs=1e-9)
    assert family_of(np.array([2.0, 0.3, 4.25, 3.0 - 1e-12]), ahead).tolist() == [0, 1, 2, 0]


@pytest.mark.parametrize("waveform", WAVEFORMS, ids=lambda waveform: waveform.shape)
@pytest.mark.parametrize("steady", [True, False])
def test_parts_add_up_on_their_own_clocks(waveform, steady):
    changes = changes_of(waveform, steady, END)
    ahead = leads(changes.at)
    which = family_of(changes.at, ahead)
    parts = [changes.part(which == k, float(late)) for k, late in enumerate(ahead)]
    t = np.linspace(0.001, END - 0.001, 500)
    total = sum(part.value(t + late, t + late) for part, late in zip(parts, ahead, strict=True))
    assert total + changes.before == pytest.approx(waveform.value(t, t), abs=1e-12)
    just_before = [part.value(np.array(late / 2), np.array(-1e-3)) for part, late in zip(parts, ahead, strict=True)]
    assert sum(just_before) == 0.0
    for part, late in zip(parts, ahead, strict=True):
        assert np.abs(part.breaks(END + 1) - np.round(part.breaks(END + 1))).max(initial=0.0) < 1e-9, late


def test_nothing_happens_where_a_waveform_goes_on():
    assert changes_of(Step(to=1, at=2), steady=False, t_end=END).at.tolist() == [2.0]
    assert changes_of(Step(from_=1, to=2, at=2), steady=True, t_end=END).at.tolist() == [2.0]
    assert changes_of(Step(from_=1, to=2, at=2), steady=False, t_end=END).at.tolist() == [0.0, 2.0]
    straight = PiecewiseLinear(points=[(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)])
    assert changes_of(straight, steady=True, t_end=END).at.tolist() == [0.0, 2.0]


def test_curved_waveforms_stay_whole():
    sine = Sine(amplitude=1, frequency=4 / END)  # zero at both ends of the run
    changes = changes_of(sine, steady=True, t_end=END)
    assert changes.curved
    assert len(changes.at) >= 1
    late = changes.part(np.ones(len(changes.at), bool), 0.25)
    t = np.linspace(0.01, 9, 50)
    assert changes.before + late.value(t + 0.25, t + 0.25) == pytest.approx(sine.value(t, t))
    assert late.fastest() == sine.fastest()
