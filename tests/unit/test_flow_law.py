"""Laws of friction and their slopes, and flows that balance by them."""

from math import log10, pi
from pathlib import Path

import numpy as np
import pytest

from tline import InputError, Scene
from tline.loss.flow_law import Colebrook, FlowLaw, PowerLaw, SwameeJain, quadratic, side_by_side
from tline.scene.file import read_scene
from tline.scene.line import Pipe
from tline.scene.site import GRAVITY
from tline.solver.assembly.diamonds import _power_table
from tline.solver.description.description import describe
from tline.solver.kernel.diamonds.full import bent, power
from tline.solver.steady import balance
from tline.solver.steady.steady_state import steady_state

LENGTH, DIAMETER, DENSITY = 1000.0, 0.3, 1000.0
PIPE = {"nodes": ["a", "b"], "length": LENGTH, "diameter": DIAMETER, "wave_speed": 1000, "density": DENSITY}
LAWS = [
    quadratic(3e4),
    PowerLaw(2e4, 0.0, 1.852),
    PowerLaw(2e4, 1e3, 1.852),
    Colebrook(3e4, 10.0, 4e6, 1e-3),
    SwameeJain(3e4, 10.0, 4e6, 1e-3),
]


def head(flow: float, **friction) -> float:
    line = Pipe.model_validate(PIPE | {"friction": friction})
    return line.steady_drop(flow)[0] / (DENSITY * GRAVITY)


def test_hazen_williams_manning_and_swamee_jain_by_their_formulas():
    """The usual forms in metres; EPANET's constant for feet rounds Hazen's and Williams' to 4 digits."""
    Q, d, L = 0.1, DIAMETER, LENGTH
    v = Q / (np.pi / 4 * d**2)
    assert head(Q, kind="hazen-williams", coefficient=100) == pytest.approx(
        10.67 * L * Q**1.852 / (100**1.852 * d**4.8704), rel=2e-3
    )
    assert head(Q, kind="manning", coefficient=0.013) == pytest.approx(
        0.013**2 * v**2 * L / (d / 4) ** (4 / 3), rel=1e-12
    )
    viscosity, rough = 1e-3, 1e-4
    f = 0.25 / log10(rough / d / 3.7 + 5.74 / (v * d * DENSITY / viscosity) ** 0.9) ** 2
    swamee = {"kind": "swamee-jain", "viscosity": viscosity, "roughness": rough}
    assert head(Q, **swamee) == pytest.approx(f * L / d * v**2 / (2 * GRAVITY), rel=1e-12)
    slow = 1e-5
    poiseuille = 128 * viscosity * L * slow / (np.pi * d**4) / (DENSITY * GRAVITY)
    assert head(slow, **swamee) == pytest.approx(poiseuille, rel=1e-12)


def test_local_losses_and_the_length_over_which_friction_acts():
    Q, v = 0.1, 0.1 / (np.pi / 4 * DIAMETER**2)
    for kind, coefficient in (("hazen-williams", 100), ("manning", 0.013)):
        alone = head(Q, kind=kind, coefficient=coefficient)
        both = head(Q, kind=kind, coefficient=coefficient, minor_loss=7, length=LENGTH / 4)
        assert both == pytest.approx(alone / 4 + 7 * v**2 / (2 * GRAVITY), rel=1e-12)


@pytest.mark.parametrize("bad", [{"coefficient": 0}, {"coefficient": -3}, {}, {"coefficient": 100, "minor_loss": -1}])
def test_mistakes(bad):
    from tline.scene.scene import Scene

    pipe = PIPE | {"friction": {"kind": "hazen-williams"} | bad}
    with pytest.raises(InputError, match=r"lines\.p\.friction"):
        Scene(medium="hydraulic", t_end=1, lines={"p": pipe})


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_slopes_are_those_of_the_drops(law: FlowLaw):
    flow = np.geomspace(1e-5, 10, 200)
    reynolds = 4e6 * flow
    flow = flow[np.abs(reynolds / 2040 - 1) > 0.05]
    step = 1e-4 * flow
    slope = (law(flow + step)[0] - law(flow - step)[0]) / (2 * step)
    smooth = np.abs(4e6 * flow / 2000 - 1) > 1e-3
    assert law(flow)[1][smooth] == pytest.approx(slope[smooth], rel=5e-3)


def test_laws_side_by_side_are_the_same():
    laws = [*LAWS, None, PowerLaw(5.0, 0.0, 1.7), Colebrook(1.0, 0.0, 1e5, 0.0)]
    flow = np.array(0.02)
    seen = {}
    for places, law in side_by_side(laws, np.arange(len(laws))):
        drop, slope = law(np.full(len(places), 0.02))
        seen |= dict(zip(places.tolist(), zip(drop, slope, strict=True), strict=True))
    assert seen.keys() == {k for k, law in enumerate(laws) if law is not None}
    for k, found in seen.items():
        assert found == pytest.approx([float(each) for each in laws[k](flow)], rel=1e-14)


@pytest.mark.parametrize("n", [0.852, 1.0, 1 / 3, 2.0])
def test_powers_by_table_are_those_of_the_library(n):
    table = np.append(np.zeros(3), _power_table(n))  # at a place of its own
    x = np.append(np.exp(np.random.default_rng(1).uniform(-60, 60, 300)), [1.0, 2.0, np.nextafter(2.0, 0), 0.5])
    found = np.array([power(table, 3, each) for each in x])
    assert np.abs(found / x**n - 1).max() < 2e-14  # of n ln x, rounded
    assert power(table, 3, 0.0) == 0.0


def test_how_far_a_tangent_holds():
    """Of y² by three times what it is off, and not at all from rest, where its slope tells nothing."""
    base, away = 2.0, 0.1
    off = (base + away) ** 2 - (base**2 + 2 * base * away)
    assert off < bent(2 * base, base + away, base) < 3 * off
    assert bent(0.0, 1e-9, 0.0) > 1e200
    assert bent(0.0, 0.0, 0.0) == 0.0


NONE = 1e-12  # Pa, m³/s: where nothing drives
SCENES = Path(__file__).parents[2] / "scenes"


@pytest.mark.parametrize("name", ["town", "pump_trip", "valve_closure", "pipe_friction"])
@pytest.mark.parametrize("exact", [balance.EXACT, 0.0], ids=["by elimination", "at once"])
def test_large_networks_are_solved_like_small_ones(monkeypatch, name, exact):
    scene = read_scene(SCENES / f"{name}.toml")
    small, flows = steady_state(describe(scene))
    monkeypatch.setattr(balance, "MOST_DENSE", 0)
    monkeypatch.setattr(balance, "EXACT", exact)
    large, same = steady_state(describe(scene))
    assert large == pytest.approx(small, rel=1e-9, abs=1e-9 * max(small.values()) + NONE)
    assert same == pytest.approx(flows, abs=1e-9 * abs(flows).max() + NONE)


def test_a_pipe_between_reservoirs_follows_darcy(monkeypatch):
    """Δp = ρ f l/(2 d A²) Q², also where no effort is left to be found."""
    monkeypatch.setattr(balance, "MOST_DENSE", 0)
    pipe = {"nodes": ["high", "low"], "length": 100, "diameter": 0.2, "wave_speed": 1000, "density": 1000}
    scene = Scene(
        medium="hydraulic",
        t_end=1,
        start="steady",
        lines={"pipe": pipe | {"friction": {"kind": "darcy", "factor": 0.02}}},
        loads={
            "upper": {"at": "high", "kind": "reservoir", "pressure": 2e5},
            "lower": {"at": "low", "kind": "reservoir", "pressure": 1e5},
        },
        probes={"p": {"at": "low"}},
    )
    _, flows = steady_state(describe(scene))
    area = pi * 0.2**2 / 4
    assert flows[0] == pytest.approx(area * (1e5 * 2 * 0.2 / (1000 * 0.02 * 100)) ** 0.5)
