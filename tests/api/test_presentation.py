"""Whatever the packages give out has a screen of text, a notebook form with its picture, and plain data."""

import json

import pytest
from matplotlib.figure import Figure

import tline as tl
from tline.presentation import SCREEN, Presentation, plain


def drives_run():
    torque = tl.drives.Torque.step(0.1)
    return tl.drives.simulate(tl.drives.CoupledDrives(), torque, torque, t_end=2.0, step=0.01)


DRAWN = {
    "run of a scene": lambda: tl.simulate(tl.examples["cable_mismatch"]),
    "friction": lambda: tl.friction.simulate(tl.friction.Karnopp(), tl.friction.Testbench(tl.friction.Ramp(0.5))),
    "chatter": lambda: tl.friction.simulate(tl.friction.Coulomb(), tl.friction.Testbench(), 10.0, "euler", h=0.01),
    "drives": drives_run,
    "design": lambda: tl.drives.design(tl.drives.CoupledDrives()),
    "transfer function": lambda: tl.drives.CoupledDrives().transfer("w1", "T1"),
    "exercise": lambda: tl.exercise("2a"),
}
TOLD = {
    "state space": lambda: tl.drives.CoupledDrives().state_space(),
    "pipe": lambda: tl.HydraulicLine(radius="10 cm", wave_speed=1500, density=980),
    "cable": lambda: tl.ElectricalLine(wave_speed=3e8, z0=300),
}


@pytest.mark.parametrize("make", (DRAWN | TOLD).values(), ids=DRAWN | TOLD)
def test_text_and_data(make):
    found = make()
    text = str(found)
    assert 1 <= len(text.splitlines()) <= SCREEN
    assert json.loads(json.dumps(found.to_dict())) == found.to_dict()
    assert found._repr_html_().startswith("<pre>")


@pytest.mark.parametrize("make", DRAWN.values(), ids=DRAWN)
def test_pictures(make):
    found = make()
    if not isinstance(found, tl.Result):  # whose axes show one quantity that is named
        axes = Figure().subplots()
        assert found.plot(axes) is axes
        assert axes.lines
    assert found.plot().axes
    assert 'src="data:image/png;base64,' in found._repr_html_()


def test_long_texts_are_cut_and_escaped():
    class Long(Presentation):
        def text_lines(self):
            return [f"a < {k}" for k in range(100)]

    assert str(Long()).splitlines()[-1] == "and 60 more lines"
    assert Long()._repr_html_().startswith("<pre>a &lt; 0\n")


def test_what_no_number_is_becomes_none():
    assert plain([float("nan"), 1j, range(2), {1: float("-inf")}]) == [None, [0.0, 1.0], [0, 1], {"1": None}]
