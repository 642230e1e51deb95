"""Lattices of waves as pictures."""

from itertools import combinations

import pytest
from picture_scenes import JOUKOWSKY, RC_END, TANK, cables, quietly, texts, water_hammer

from tline.pictures.lattice import MOST_LEGS, bounces, plot_lattice
from tline.scene.scene import Scene


@pytest.mark.parametrize("close", ["0.1 s", "0.1017 s"])  # at a slab's edge, and inside a slab
def test_lattice_of_the_water_hammer(close: str) -> None:
    found = bounces(quietly(water_hammer(close)))
    start = float(close.split()[0])
    assert [front.t for front in found.fronts] == pytest.approx([start + 0.2 * k for k in range(len(found.fronts))])
    assert [front.end for front in found.fronts[:3]] == [1, 0, 1]
    signs = [1, -1, -1, 1] * 3  # a closed end returns the front as it is, a reservoir turns it
    jumps = [sign * JOUKOWSKY for sign in signs[: len(found.fronts)]]
    assert [front.jump for front in found.fronts] == pytest.approx(jumps, rel=1e-6)
    levels = [stay.first for stay in found.stays if stay.end == 1]
    assert levels == pytest.approx([TANK, *([TANK + JOUKOWSKY, TANK - JOUKOWSKY] * 3)[: len(levels) - 1]], rel=1e-6)


def test_lattice_writes_numbers_and_units() -> None:
    picture = plot_lattice(quietly(water_hammer()))
    (axes,) = picture.axes
    written = texts(picture)
    rise = f"{JOUKOWSKY / 1e5:.4g}"
    assert {f"+{rise}", f"\N{MINUS SIGN}{rise}", "6", f"{6 + JOUKOWSKY / 1e5:.4g}", "tank\n", "valve\n"} <= set(written)
    assert "pressure [bar]" in written
    assert (axes.get_ylabel(), axes.get_xlabel()) == (
        "time [s]",
        "on the legs: what the front adds to the pressure [bar]",
    )
    assert axes.get_ylim()[0] > axes.get_ylim()[1] == 0  # time runs down


@pytest.mark.parametrize("at", ["2 ns", "2.034 ns"])
def test_lattice_of_a_capacitive_end(at: str) -> None:
    """A capacitor is a short to a front, and 25 ohm at a 50-ohm cable return -1/3 of it; it then charges."""
    step = {"at": "near", "kind": "voltage", "resistance": 25, "value": {"shape": "step", "to": "1 V", "at": at}}
    scene = cables({"c": ("near", "far", "5 ns")}, loads=RC_END, sources={"in": step})
    fronts, stays = bounces(quietly(Scene(**scene.table() | {"solver": {"order": 5, "slab": "0.1 ns"}})))[2:]
    jumps = [2 / 3, -2 / 3, 2 / 9, -2 / 9, 2 / 27]
    # 1e-5: inside slabs the order is s, not 2 s - 1; a slab of 0.1 ns, the time constant is 0.8 ns
    assert [front.jump for front in fronts[:5]] == pytest.approx(jumps, abs=1e-5)
    charged = next(stay for stay in stays if stay.end == 1 and stay.start > 0)
    assert charged.first == pytest.approx(0, abs=1e-5)
    assert charged.last > 1


def test_lattice_tells_corners_from_jumps_and_ends_after_twelve_legs() -> None:
    ramp = {"at": "near", "kind": "voltage", "resistance": 25, "value": {"shape": "ramp", "to": 1, "duration": "3 ns"}}
    scene = cables({"c": ("near", "far", "5 ns")}, sources={"in": ramp}, t_end="500 ns")
    result = quietly(scene)
    assert len(bounces(result).fronts) == MOST_LEGS
    picture = plot_lattice(result)
    assert not any("+" in text for text in texts(picture))
    assert picture.axes[0].get_xlabel() == "dotted: a corner, where a slope changes"
    assert picture.axes[0].get_ylim()[0] < 50


@pytest.mark.parametrize("width", ["3 ns", "0.5 ns", "0.3 ns"])
def test_numbers_on_close_legs_do_not_cover_each_other(width: str) -> None:
    """The end of a pulse runs close behind its begin; matplotlib itself measures the texts."""
    value = {"shape": "pulses", "high": 1, "width": width, "at": "1 ns"}
    pulse = {"at": "near", "kind": "voltage", "resistance": 10, "value": value}
    picture = plot_lattice(quietly(cables({"c": ("near", "far", "5 ns")}, sources={"in": pulse})))
    picture.draw_without_rendering()
    boxes = [
        text.get_window_extent() for text in picture.axes[0].texts if text.get_text()[:1] in {"+", "\N{MINUS SIGN}"}
    ]
    assert len(boxes) >= 8
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))
