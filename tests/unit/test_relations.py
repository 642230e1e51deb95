"""The elimination behind "any sufficient set of quantities"."""

import math
from collections.abc import Mapping

import pytest
from hypothesis import given, settings, strategies as st

from tline.errors import InputError
from tline.line.parameters import choose
from tline.line.relations import Given, Relation, Relations, determine, listed, solve

CIRCLE = Relations(
    ({"diameter": 1, "2": -1, "radius": -1}, {"area": 1, "pi": -1, "radius": -2}), {"2": 2.0, "pi": math.pi}
)


@pytest.mark.parametrize("name", ["radius", "diameter", "area"])
def test_one_quantity_of_a_circle_gives_the_others(name: str) -> None:
    circle = {"radius": 3.0, "diameter": 6.0, "area": 9 * math.pi}
    # a handful of roundings: 1e-15
    assert solve(CIRCLE, Given({name: circle[name]})) == pytest.approx(circle, rel=1e-15)


def test_a_given_value_is_kept_to_the_last_bit() -> None:
    assert solve(CIRCLE, Given({"radius": 0.1, "area": math.pi * 0.1**2 * (1 + 1e-9)}))["radius"] == 0.1


def test_integer_powers_are_evaluated_without_logarithms() -> None:
    assert solve(CIRCLE, Given({"radius": 0.3}))["diameter"] == 0.6
    assert solve(Relations(({"b": 1, "a": -9},), {}), Given({"a": 3.0}))["b"] == 19683.0
    assert solve(Relations(({"b": 3, "a": -1},), {}), Given({"a": 27.0}))["b"] == pytest.approx(3, rel=1e-15)


def test_nothing_follows_from_nothing() -> None:
    assert solve(CIRCLE, Given({})) == {}


def test_quantities_tied_only_in_combination_stay_open() -> None:
    product = Relations(({"z": 1, "x": -1, "y": -1}, {"w": 1, "x": -2, "y": -2}), {})
    assert solve(product, Given({"z": 3.0})) == {"z": 3.0, "w": 9.0}


def test_redundant_values_agree_within_a_millionth() -> None:
    assert solve(CIRCLE, Given({"radius": 1.0, "diameter": 2.0 * (1 + 9e-7)}))
    with pytest.raises(InputError, match=r"clash"):
        solve(CIRCLE, Given({"radius": 1.0, "diameter": 2.0 * (1 + 1.1e-6)}))


def test_a_clash_names_exactly_the_quantities_that_disagree() -> None:
    system = Relations((*CIRCLE.relations, {"volume": 1, "area": -1, "height": -1}), CIRCLE.constants)
    with pytest.raises(InputError) as caught:
        solve(system, Given({"height": 1.0, "radius": 1.0, "diameter": 3.0}))
    assert str(caught.value) == "radius and diameter clash: 2*radius gives 2 but diameter is 3, 33.3 % apart"
    with pytest.raises(InputError, match=r"^height, radius and volume clash: height.* gives 3.142 but volume is 4"):
        solve(system, Given({"height": 1.0, "radius": 1.0, "diameter": 2.0, "volume": 4.0}))


def test_a_small_clash_is_shown_with_enough_digits() -> None:
    with pytest.raises(InputError, match=r"gives 2 but diameter is 2.00001, 0.0005 % apart"):
        solve(CIRCLE, Given({"radius": 1.0, "diameter": 2.00001}))


def test_a_clash_speaks_of_what_the_user_gave() -> None:
    with pytest.raises(InputError, match=r"^rod and diameter clash"):
        solve(CIRCLE, Given({"radius": 1.0, "diameter": 3.0}, {"radius": ("rod",)}))


def test_fractional_powers_are_written_readably() -> None:
    with pytest.raises(InputError, match=r"clash: area\^\(1/2\)/pi\^\(1/2\) gives 1 but radius is 2"):
        solve(CIRCLE, Given({"area": math.pi, "radius": 2.0}))


@pytest.mark.parametrize("radius", [1e-200, 1e200])
def test_a_value_outside_the_floats_is_refused(radius: float) -> None:
    with pytest.raises(InputError, match="area follows from radius and leaves the range of numbers"):
        solve(CIRCLE, Given({"radius": radius}))


def _parallel(name: str, known: Mapping[str, float]) -> float:
    if name == "total":
        return 1 / (1 / known["one"] + 1 / known["two"])
    return 1 / (1 / known["total"] - 1 / known["two" if name == "one" else "one"])


RESISTORS = Relations(
    ({"power": 1, "total": -1, "current": -2}, {"one": 1, "rho": -1, "length": -1}),
    {},
    Relation(("total", "one", "two"), _parallel, "one*two/(one + two)", "a part below the total"),
)


def test_a_law_takes_turns_with_the_relations() -> None:
    values = solve(RESISTORS, Given({"rho": 2.0, "length": 3.0, "two": 6.0, "current": 2.0}))
    assert (values["one"], values["total"]) == (6.0, 3.0)
    assert values["power"] == pytest.approx(12.0, rel=1e-15)
    back = solve(RESISTORS, Given({"power": 12.0, "current": 2.0, "two": 6.0, "length": 3.0}))
    assert back["rho"] == pytest.approx(2.0, rel=1e-14)  # a difference of reciprocals loses a digit


def test_a_law_that_is_broken_names_what_was_given() -> None:
    with pytest.raises(InputError) as caught:
        solve(RESISTORS, Given({"rho": 2.0, "length": 3.0, "two": 6.0, "total": 4.0}))
    assert str(caught.value) == (
        "rho, length, two and total clash: one*two/(one + two) gives 3 but total is 4, 25 % apart"
    )
    with pytest.raises(InputError, match=r"^one and total clash: a part below the total"):
        solve(RESISTORS, Given({"one": 2.0, "total": 4.0}))
    with pytest.raises(InputError, match=r"^one and total clash: a part below the total"):
        solve(RESISTORS, Given({"one": 2.0, "total": 2.0}))


def _missing(system: Relations, given: Mapping[str, float], target: str, offered: list[str]) -> str:
    with pytest.raises(InputError) as caught:
        determine(system, Given(dict(given)), ((target,),), offered)
    return str(caught.value)


def test_what_is_missing_is_listed_shortest_first() -> None:
    offered = ["rho", "length", "two", "total", "one", "current", "power"]
    assert _missing(RESISTORS, {"total": 1.0}, "power", offered) == "power cannot be found, add current or power"
    assert _missing(RESISTORS, {"rho": 1.0, "two": 1.0, "current": 1.0}, "power", offered) == (
        "power cannot be found, add length, total, one or power"
    )
    assert _missing(RESISTORS, {"current": 1.0}, "power", ["rho", "length", "two", "one"]) == (
        "power cannot be found, add two with one"
    )
    assert _missing(RESISTORS, {"current": 1.0}, "power", ["rho", "length", "two"]) == (
        "power cannot be found, add more than two other quantities"
    )


def test_alternatives_are_enough() -> None:
    assert determine(CIRCLE, Given({"radius": 1.0}), (("area", "volume"),), [])["area"] == math.pi
    with pytest.raises(InputError, match="volume or mass cannot be found"):
        determine(CIRCLE, Given({"radius": 1.0}), (("volume", "mass"),), [])


def test_many_suggestions_are_cut() -> None:
    system = Relations(tuple({"goal": 1, f"way{i}": -1} for i in range(9)), {})
    assert _missing(system, {}, "goal", [f"way{i}" for i in range(9)]) == (
        "goal cannot be found, add for example way0, way1, way2, way3, way4 or way5"
    )


def test_listed() -> None:
    assert [listed(names) for names in (["a"], ["a", "b"], ["a", "b", "c"])] == ["a", "a and b", "a, b and c"]


def test_choose_knows_names_and_says_which() -> None:
    assert choose({"steel": 1, "lead": 2}, " Steel ", "wall") == 1
    with pytest.raises(InputError, match=r"wall: unknown wall, expected 'steel' .known are 'steel' or 'lead'., got"):
        choose({"steel": 1, "lead": 2}, "stele", "wall")
    with pytest.raises(InputError, match="wall: unknown wall, expected 'steel' or 'lead', got 7"):
        choose({"steel": 1, "lead": 2}, 7, "wall")


CHAIN = Relations(
    ({"b": 1, "a": -2, "k": -1}, {"c": 2, "a": -1, "b": -3}, {"d": 3, "c": -1, "e": 2}, {"e": 1, "f": -1, "a": 1}),
    {"k": 1.7},
)


@settings(deadline=None)
@given(st.floats(0.01, 100), st.floats(0.01, 100), st.permutations(["a", "b", "c", "d", "e", "f"]), st.integers(1, 6))
def test_any_part_of_a_consistent_whole_gives_it_back(a: float, e: float, order: list[str], size: int) -> None:
    b = 1.7 * a**2
    c = math.sqrt(a * b**3)
    whole = {"a": a, "b": b, "c": c, "d": (c / e**2) ** (1 / 3), "e": e, "f": e * a}
    values = solve(CHAIN, Given({name: whole[name] for name in order[:size]}))
    # powers up to 12 of values that carry a few roundings each
    assert values == pytest.approx({name: whole[name] for name in values}, rel=1e-13)
    early, late = (len(set(order[:size]) & set(part)) for part in ("abc", "def"))
    assert (len(values) == len(whole)) == (late >= 2 or (late == 1 and early >= 1))
