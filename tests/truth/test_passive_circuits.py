"""Circuits between line ends, exactly: scattering matrices in closed form, verdicts by conditions found by hand."""

from fractions import Fraction

import pytest

from passivity import RationalFunction, Status
from tline.scene.scene import Scene
from tline.solver.description.elements import active_parts, laws_not_through_the_origin
from tline.solver.description.passive import passive_circuits

Z0 = 60  # of 50 and 70 ohm the median


def between(links, loads=None, sources=None) -> Scene:
    lines = {
        "one": {"nodes": ["left", "a"], "z0": 50, "delay": 1},
        "two": {"nodes": ["b", "right"], "z0": 70, "delay": 1},
    }
    probes = {"p": {"at": "left"}}
    return Scene(
        medium="electrical", t_end=1, lines=lines, links=links, loads=loads or {}, sources=sources or {}, probes=probes
    )


def verdict(*given):
    scene = between(*given)
    (found,) = passive_circuits(scene, set(active_parts(scene)))
    return found


def negative(ohms, **more):
    return {"kind": "impedance", "expression": f"-{ohms}"} | more


def test_passive_elements_need_no_matrix():
    found = verdict(
        {
            "t": {"kind": "transformer", "nodes": ["a", "m"], "ratio": 2},
            "d": {"kind": "diode", "nodes": ["m", "b"], "saturation": 1e-14},
        }
    )
    assert (found.status, found.scattering) == (Status.PROVED, None)


@pytest.mark.parametrize(("beside", "status"), [(21, Status.PROVED), (20, Status.PROVED), (19, Status.REFUTED)])
def test_a_negative_resistor_in_series(beside, status):
    """S of a series resistance r is [r, 2 z0; 2 z0, r]/(r + 2 z0)."""
    r = beside - 20
    found = verdict(
        {"n": negative(20, nodes=["a", "m"]), "r": {"kind": "resistor", "nodes": ["m", "b"], "resistance": beside}}
    )
    assert (found.status, found.z0, found.ports) == (status, Z0, ["a", "b"])
    own, across = Fraction(r, r + 2 * Z0), Fraction(2 * Z0, r + 2 * Z0)
    assert [[entry.at_zero() for entry in row] for row in found.scattering.rows] == [[own, across], [across, own]]


@pytest.mark.parametrize(("resistance", "status"), [(24, Status.REFUTED), (25, Status.PROVED), (26, Status.PROVED)])
def test_a_negative_load_behind_a_coil(resistance, status):
    """At a node without a line R and L lead to either end; with equal waves each arm sees twice the load there."""
    coil = {"kind": "series", "resistance": resistance, "inductance": 3}
    links = {"one": coil | {"nodes": ["a", "m"]}, "two": coil | {"nodes": ["m", "b"]}}
    found = verdict(links, {"n": negative("12.5", at="m")})
    even = RationalFunction.from_expression(f"{resistance} - 25 + 3*s")
    odd = RationalFunction.from_expression(f"{resistance} + 3*s")
    (own, across), _ = found.scattering.rows
    assert own + across == (even - Z0) / (even + Z0)
    assert own - across == (odd - Z0) / (odd + Z0)
    assert found.status is status


@pytest.mark.parametrize(("gain", "status"), [("1.73", Status.PROVED), ("1.74", Status.REFUTED)])
def test_a_controlled_source_between_two_resistors(gain, status):
    """Y = [1/R, 0; -k/r, 1/r + 1/R]: Y + Y' >= 0 if (k/r)² <= 4/R (1/r + 1/R), here k² <= 3."""
    links = {"c": {"kind": "controlled source", "nodes": ["a", "b"], "gain": gain, "resistance": 50}}
    loads = {node: {"kind": "resistor", "at": node, "resistance": 100} for node in ("a", "b")}
    assert verdict(links, loads).status is status


def test_coupled_coils_with_a_negative_resistor():
    """Z = s [1, 3/2; 3/2, 4] with 5 - 7 ohm in series at the second port."""
    links = {
        "k": {"kind": "coupled inductors", "nodes": ["a", "m"], "inductance": [1, 4], "coupling": 0.75},
        "r": {"kind": "resistor", "nodes": ["m", "n"], "resistance": 5},
        "n": negative(7, nodes=["n", "b"]),
    }
    found = verdict(links)
    s, x, y = (RationalFunction.from_expression(text) for text in ("s", "s + 60", "4*s - 2 + 60"))
    determinant = x * y - s * s * Fraction(9, 4)
    (s11, s12), (s21, _) = found.scattering.rows
    assert abs(s11(0.3j) - (1 - 2 * Z0 * y / determinant)(0.3j)) < 1e-13
    assert abs(s12(2j) - (2 * Z0 * s * Fraction(3, 2) / determinant)(2j)) < 1e-13
    assert s12 == s21
    assert found.status is Status.REFUTED


def test_a_silent_source_is_its_resistance():
    source = {"s": {"kind": "voltage", "nodes": ["m", "b"], "value": 1, "resistance": 30}}
    assert verdict({"n": negative(29, nodes=["a", "m"])}, {}, source).status is Status.PROVED
    assert verdict({"n": negative(31, nodes=["a", "m"])}, {}, source).status is Status.REFUTED


def test_what_stands_outside_leaves_it_open():
    """A diode may or may not take up what a negative resistor gives; one that is covered needs no diode."""
    diode = {"d": {"kind": "diode", "nodes": ["m", "b"], "saturation": 1e-14}}
    open_ = verdict(diode | {"n": negative(20, nodes=["a", "m"])})
    assert open_.status is Status.UNDECIDED
    assert "refuted without links.d" in open_.why
    assert verdict(diode | {"n": negative(20, nodes=["a", "m"])} | covering(10)).status is Status.PROVED


def covering(ohms):
    return {"r": {"kind": "resistor", "nodes": ["a", "m"], "resistance": ohms}}


def test_no_waves_follow_where_all_cancels():
    loads = {"n": negative(40, at="a"), "r": {"kind": "resistor", "at": "a", "resistance": 120}}
    assert verdict({}, loads).status is Status.UNDECIDED


@pytest.mark.parametrize(
    ("points", "passes"),
    [
        ([[-1, -2], [0, 0], [3, 1]], True),
        ([[-1, -1], [3, 3]], True),
        ([[1, 2], [2, 4], [3, 9]], True),
        ([[-1, -1], [3, 4]], False),
        ([[0, -1], [0, 1], [2, 1]], True),
        ([[0, 1], [0, 2]], True),
        ([[0, 1], [0, 2], [1, 2], [1, 3]], True),
        ([[0.5, 0], [0.5, 1]], False),
        ([[1, 0], [2, 1]], False),
    ],
)
def test_tables_that_miss_the_origin_hold_a_source(points, passes):
    scene = between({"t": {"kind": "table", "nodes": ["a", "b"], "points": points}})
    assert (laws_not_through_the_origin(scene) == {}) == passes


def test_laws_of_pipes_that_hold_a_source():
    scene = Scene(
        medium="hydraulic",
        t_end=1,
        lines={"one": {"nodes": ["left", "a"], "z0": 1e6, "delay": 1}},
        loads={
            "outlet": {"at": "a", "kind": "orifice", "kv": 10},
            "basin": {"at": "a", "kind": "orifice", "kv": 10, "back_pressure": "1 bar"},
            "flap": {"at": "a", "kind": "check valve", "kv": 10, "back_pressure": "1 bar"},
        },
        probes={"p": {"at": "a"}},
    )
    assert list(laws_not_through_the_origin(scene)) == ["loads.basin"]
