"""A pipe that drains through a valve at its low end, with an air valve at its top: air for liquid, by volume."""

from math import pi, sqrt

import numpy as np
import pytest

import tline as tl
from tline.scene.site import GRAVITY
from tline.surge.worst import DRAINS, worst

HEIGHT, LENGTH, DIAMETER, CAPACITY, OPENS, TAKES = 30.0, 120.0, 0.2, 4e-5, 1.0, 0.5
PIPE = {"nodes": ["top", "low"], "length": LENGTH, "diameter": DIAMETER, "wave_speed": 1000, "density": 1000}
VOLUME, FLOW = pi / 4 * DIAMETER**2 * LENGTH, CAPACITY * sqrt(1000 * GRAVITY * HEIGHT)


def scene(t_end: float) -> tl.Scene:
    """A lake feeds it, until it is shut off."""
    opening, shutting = (
        {"shape": "ramp", "from": 1 - to, "to": to, "at": at, "duration": TAKES} for to, at in ((1, OPENS), (0, 0.2))
    )
    return tl.Scene(
        medium="hydraulic",
        t_end=t_end,
        start="steady",
        nodes={"lake": {"elevation": HEIGHT}, "top": {"elevation": HEIGHT}, "low": {"elevation": 0}},
        lines={"pipe": PIPE},
        links={"feed": {"nodes": ["lake", "top"], "kind": "orifice", "kv": 100, "opening": shutting}},
        loads={
            "lake": {"at": "lake", "kind": "reservoir", "pressure": 1000 * GRAVITY * HEIGHT + 1e3},
            "air": {"at": "top", "kind": "air valve", "inlet_diameter": 0.2, "outlet_diameter": 0.05},
            "drain": {"at": "low", "kind": "orifice", "flow": CAPACITY, "pressure_drop": 1.0, "opening": opening},
        },
        probes={"low": {"at": "low"}},
        solver={"order": 3, "slab": 0.01},
    )


def test_air_takes_the_room_of_what_flows_out_and_from_a_tenth_on_no_class_is_named():
    """Under the head of a full pipe the flow settles, for the waves that the opening makes die out at the drain."""
    late = OPENS + TAKES / 2 + 0.1 * VOLUME / FLOW
    short, long = (tl.simulate(scene(t_end), envelope=True) for t_end in (late - 0.2, late + 1))
    (air,) = (trace for trace in long.states if trace.word == "air volume")
    drawn = np.trapezoid(long.probes["low"].y, long.t)
    assert air.values[-1] == pytest.approx(drawn, rel=1e-3)
    assert air.values[-1] == pytest.approx(0.1 * VOLUME + FLOW, rel=0.01)
    (note,) = (note for note in long.notes if "they drain" in note)
    assert float(note.partition("after ")[2].partition(" s")[0]) == pytest.approx(late, rel=0.01)
    assert worst(long).untold == DRAINS
    assert worst(short).untold != DRAINS
    assert not any("they drain" in note for note in short.notes)
