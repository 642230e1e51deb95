"""What guesses leave of a verdict, against Joukowsky's rise, which is in proportion to the wave speed."""

from math import pi

import pytest

import tline as tl
from tline.surge.operation import operate
from tline.surge.report import band_text

SPEED, DENSITY, FLOW, BORE, STATIC = 1000.0, 1000.0, 0.05, 0.3, 6e5
RISE = DENSITY * SPEED * FLOW / (pi / 4 * BORE**2)


@pytest.fixture(scope="module")
def surge():
    pipe = {"length": 500, "diameter": BORE, "wave_speed": SPEED, "density": DENSITY}
    tap = {"at": "c", "kind": "orifice", "flow": FLOW, "pressure_drop": STATIC}
    scene = tl.Scene(
        medium="hydraulic",
        t_end="1 s",
        start="steady",
        lines={"main": {"nodes": ["lake", "c"], **pipe}},
        loads={"lake": {"at": "lake", "kind": "reservoir", "pressure": STATIC}, "tap": tap},
        probes={"tap": {"at": "c"}},
    )
    return operate(scene, close="tap@0.1s", t_end="0.9 s")


def test_a_faster_wave_raises_the_highest_pressure_in_proportion(surge):
    band = surge.band()
    assert surge.worst.highest.highest == pytest.approx(STATIC + RISE, rel=1e-6)
    assert band.base.highest == pytest.approx(STATIC + RISE, rel=1e-6)
    below, above, governs = band.of("highest")
    assert (below, above) == (pytest.approx(0.15 * RISE, rel=1e-6), pytest.approx(0.15 * RISE, rel=1e-6))
    assert governs.guess.startswith("wave speed")
    assert [one.guess for one in band.varied] == ["wave speed × 0.85", "wave speed × 1.15"]  # it has no friction


def test_the_report_names_classes_and_what_governs(surge):
    low, high = ((STATIC + by * RISE) / 1e5 for by in (0.85, 1.15))
    text = "\n".join(band_text(surge.result, surge.band()))
    assert f"as guesses vary, the highest pressure is {low:.4g} to {high:.4g} bar, most by wave speed" in text
    assert "so it asks for PN 16" in text


def test_what_is_known_is_not_varied(surge):
    assert surge.band(known=["wave speed"]) is None
