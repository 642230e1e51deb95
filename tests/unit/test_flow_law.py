"""Laws of what is lost per metre over the flow."""

from math import log10

import numpy as np
import pytest

from tline.errors import InputError
from tline.loss.flow_law import Colebrook, FlowLaw, PowerLaw, SwameeJain, quadratic, side_by_side
from tline.scene.line import Pipe
from tline.scene.site import GRAVITY

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
    for places, law in side_by_side(laws):
        drop, slope = law(np.full(len(places), 0.02))
        seen |= dict(zip(places.tolist(), zip(drop, slope, strict=True), strict=True))
    assert seen.keys() == {k for k, law in enumerate(laws) if law is not None}
    for k, found in seen.items():
        assert found == pytest.approx([float(each) for each in laws[k](flow)], rel=1e-14)
