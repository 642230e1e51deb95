"""Whatever has a file in tline/scene/elements: unit and record of its example tell of one law."""

import tomllib
from importlib import import_module

import numpy as np
import pytest

from tline.scene.element import Between
from tline.scene.elements import ELEMENTS
from tline.scene.law import ElementLaw, NonLinear
from tline.solver.description.laws import laws_of
from tline.solver.kernel.network import Crossing, Store
from tline.solver.kernel.units import unit_at
from tline.solver.steady.edges import Flows


def law_of(model: type) -> ElementLaw:
    place = {"nodes": ["a", "b"]} if issubclass(model, Between) else {"at": "b"}
    return model(**place, **tomllib.loads(model.example)).law()


def stored_by(law: ElementLaw):
    """What tells of the energy in a store, beside its unit; None where nothing does."""
    return getattr(import_module(f"tline.solver.kernel.{law.of_kind.unit.rpartition('.')[0]}"), "stored", None)


LAWS = {name: law_of(model) for name, model in ELEMENTS.items() if issubclass(model, NonLinear)}
STATELESS = [name for name, law in LAWS.items() if not law.of_kind.states]
FILLED = [name for name, law in LAWS.items() if stored_by(law)]


@pytest.mark.parametrize("name", LAWS)
def test_states_are_as_many_as_the_unit_takes(name):
    kind, c = LAWS[name].of_kind, np.array(LAWS[name].constants)
    assert unit_at(kind.unit).parameters[0] is (Store if kind.states else Crossing)
    assert len(kind.at_rest(c, c[0] + 1e5, 1.0)) == kind.states


@pytest.mark.parametrize("name", STATELESS)
@pytest.mark.parametrize("z", [1e-3, 1.0, 1e3])
def test_a_flow_fits_the_law_of_a_textbook(name, z):
    kind, c = LAWS[name].of_kind, np.array(LAWS[name].constants)
    textbook, passive = kind.flow(c), not kind.source(c)
    flows = Flows(laws_of([], [], 0, 0)[0]._replace(
        kind=np.array([kind.number]), at=np.zeros(1, int), constants=c, control=np.ones(1),
        source_impedance=np.array([z]),
    ))  # fmt: skip
    size = np.geomspace(1e-3, 1e6, 60)
    drops, through = np.sort(np.concatenate([-size, size])), []
    for v in drops:
        (flow,), (slope,) = flows(np.array([c[0] + v]))
        step = 1e-6 * abs(v)
        (more,), (less,) = (flows(np.array([c[0] + v + off]))[0] for off in (step, -step))
        assert slope == pytest.approx((more - less) / (2 * step), rel=1e-3, abs=1e-9 * abs(flow / v))
        assert not passive or flow * (v - z * flow) >= -1e-12 * abs(flow * v)
        if textbook is not None:
            slack = 8e-15 * max(abs(v), z * abs(flow))  # what rounding of the drop may change
            low, high = textbook(v - z * flow - slack), textbook(v - z * flow + slack)
            assert low - 1e-12 * abs(low) <= flow <= high + 1e-12 * abs(high)
        through.append(flow)
    assert (np.diff(through) >= 0).all()


@pytest.mark.parametrize("name", FILLED)
def test_a_state_tells_of_one_energy(name):
    """X grows by dX/dt = r i while the energy, a constant times X²/2, grows by what the flow brings."""
    law = LAWS[name]
    c, stored = np.array(law.constants), stored_by(law)
    (rest,) = law.of_kind.at_rest(c, c[0] + 1e5, 1.0)
    units = []
    for y in rest * np.linspace(0.5, 1.5, 7):
        x, slope, effort, share = stored(c, 0, y)
        more, less = (stored(c, 0, y + off)[0] for off in (1e-6 * y, -1e-6 * y))
        assert slope == pytest.approx((more - less) / (2e-6 * y), rel=1e-6)
        units.append(effort / (x * share))
    assert units == pytest.approx([units[0]] * 7, rel=1e-9)
    assert units[0] > 0
