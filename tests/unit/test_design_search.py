"""The search of the smallest size, on functions whose answer is known."""

import pytest

import tline as tl
from tline.design.search import PRECISION, SizeSearch, Trial, rounded, smallest


def search(margin, first=1.0, largest=float("inf"), error=0.0):
    runs = []

    def run(size):
        runs.append(size)
        return Trial(size, 0.0, 0.0, margin(size), error)

    return smallest(run, first, largest), runs


def size_of(search: SizeSearch) -> float:
    assert search.found is not None
    return search.found.size


@pytest.mark.parametrize("root", [3e-4, 0.17, 1.0, 42.0, 3e4])
@pytest.mark.parametrize("law", [lambda x: x - 1, lambda x: 1 - x**-2.0, lambda x: (x - 1) ** 3, lambda x: x**8 - 1])
def test_the_size_is_the_root_from_above_with_few_runs(root, law):
    found, runs = search(lambda size: law(size / root))
    assert root * (1 - 1e-12) <= size_of(found) <= root * PRECISION * 1.001
    assert len(runs) == len(set(runs)) <= 45
    assert found.turns is None


def test_a_plateau_and_a_jump_are_bisected():
    found, _ = search(lambda size: -1.0 if size < 7.77 else 1.0)
    assert size_of(found) == pytest.approx(7.77, rel=3e-3)


def test_a_larger_size_that_fails_is_seen_and_passed():
    found, _ = search(lambda size: -1.0 if size < 2 or 4 < size < 6 else 1.0)
    assert size_of(found) == pytest.approx(6, rel=3e-3)
    assert found.turns is not None


def test_errors_of_the_runs_are_no_turn():
    found, _ = search(lambda size: size - 3 + 1e-3 * (-1) ** round(1e6 * size), error=2e-3)
    assert found.turns is None


def test_where_none_is_large_enough_nothing_is_found():
    found, runs = search(lambda size: -1 / size, largest=10.0)
    assert found.found is None
    assert max(runs) == 10.0


def test_where_all_are_large_enough_the_smallest_tried_is_found():
    found, runs = search(lambda size: 1.0)
    assert size_of(found) == min(runs)


def test_sizes_have_four_digits():
    assert (rounded(0.00123456), rounded(123456.0)) == (0.001235, 123500.0)


def test_a_size_that_is_not_enough_is_told_with_its_unit():
    scene = tl.examples["pump_trip"].change({"t_end": "10 s"})
    with pytest.raises(
        tl.InputError, match=r"lowest: no size up to \d+ kg m\^2 keeps this gauge pressure at all nodes"
    ):
        tl.design.flywheel(scene, "pump", lowest="3.9999 bar", tol=1e-2)


def test_what_trials_do_not_resolve_is_a_note_and_no_warning():
    fast = {"at": "valve", "kind": "parallel", "resistance": 1e12, "capacitance": 1e-14}
    scene = tl.examples["valve_closure"].change({"loads.fast": fast, "solver": {"order": 2, "slab": "0.05 s"}})
    found = tl.design.closure(scene, "valve", highest="12 bar")
    assert [note for note in found.notes if note.startswith("loads.fast: its time scale")]
