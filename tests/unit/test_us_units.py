"""Every hydraulic scene that comes with tline, with all that it says in US units: the same lines, laws and sources."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

import tline as tl
from tline.scene.element import Element
from tline.scene.quantity import Quantity
from tline.units import to_si

US = {
    "m": "ft", "m^2": "ft^2", "m^3": "ft^3", "m/s": "ft/s", "m^3/s": "gpm", "Pa": "psi", "kg/m^3": "lb/ft^3",
    "kg m^2": "lb ft^2", "Pa s": "psi s", "m^2/s": "ft^2/s", "N/m": "lbf/in", "kg": "lb", "K": "degR", "Hz": "rpm",
}  # fmt: skip
SCENES = [name for name, scene in tl.examples.items() if scene.medium == "hydraulic"]


def in_us(part: Any) -> Any:
    """What was given, as a table, with every quantity that has a US unit in it."""
    if isinstance(part, Quantity):
        unit = US.get(part.unit or "")
        return part.typed if unit is None else f"{float(part) / to_si(f'1 {unit}', part.unit)!r} {unit}"
    if isinstance(part, Element):
        fields = type(part).model_fields
        return {fields[name].alias or name: in_us(getattr(part, name)) for name in part.model_fields_set}
    if isinstance(part, Mapping):
        return {key: in_us(value) for key, value in part.items()}
    return [in_us(value) for value in part] if isinstance(part, list | tuple) else part


@pytest.mark.parametrize("name", SCENES)
def test_the_same_scene_in_us_units(name):
    scene = tl.examples[name]
    other = tl.Scene(scene.folder, **in_us(scene))
    close: Any = {"rtol": 1e-12, "atol": 0.0}
    for key, line in scene.lines.items():
        ours, theirs = line.parameters, other.lines[key].parameters
        assert [theirs.z0, theirs.delay] == pytest.approx([ours.z0, ours.delay], rel=1e-12)
    for (where, one), (_, two) in zip(scene.placed, other.placed, strict=True):
        if hasattr(one, "law"):
            np.testing.assert_allclose(two.law().constants, one.law().constants, **close, err_msg=str(where))
    t = np.linspace(0.0, float(scene.t_end), 40)
    for key, source in scene.sources.items():
        np.testing.assert_allclose(other.sources[key].value.value(t, t), source.value.value(t, t), rtol=1e-11)
