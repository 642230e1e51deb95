"""A scene as plain data: what the solver knows of it, and that it is read once."""

from functools import cached_property

import numpy as np
import pytest
from random_elements import random_elements

import tline as tl
from tline import InputError, Scene, simulate
from tline.solver.description.description import Description, describe
from tline.solver.tolerance import search

PAIR = {
    "nodes1": ["a1", "a2"],
    "nodes2": ["b1", "b2"],
    "even": {"z0": 60, "delay": "1.1 ns"},
    "odd": {"z0": 40, "delay": "0.9 ns"},
}
CABLE = {"nodes": ["b1", "c"], "z0": 50, "delay": "2 ns"}


def scene(**more) -> Scene:
    parts = {
        "lines": {"cable": CABLE},
        "sources": {
            "s": {"at": "b1", "kind": "voltage", "value": {"shape": "step", "to": 1, "at": "1 ns"}, "resistance": 25}
        },
        "loads": {"k": {"at": "c", "kind": "switch", "before": 10, "after": 20, "time": "3 ns"}},
        "probes": {"p": {"line": "cable", "position": "25 %"}},
    }
    return Scene(medium="electrical", t_end="10 ns", **parts | more)


def test_coupled_conductors_are_lines_for_each_mode_and_two_ends():
    description = describe(scene(lines={"cable": CABLE, "pair": PAIR}, loads={}, probes={"p": {"at": "b2"}}))
    assert list(description.lines) == ["cable", "pair, mode 1", "pair, mode 2"]
    assert sorted(line.z0 for line in description.lines.values()) == [40, 50, 60]
    assert [end.conductors for end in description.coupled["pair"]] == [("a1", "a2"), ("b1", "b2")]
    probe = description.probes["p"]
    assert (probe.line, probe.share, probe.lines) == ("pair", 1.0, ["pair, mode 1", "pair, mode 2"])
    assert probe.conductor is not None
    assert (probe.conductor.end, probe.conductor.weights) == (1, (0.0, 1.0))
    with pytest.raises(InputError, match=r"lines\.pair: a picture knows no coupled conductors"):
        description.refuse_coupled("a picture")


def test_instants_and_places_are_those_of_the_scene():
    description = describe(scene())
    assert description.waveforms.keys() == {"sources.s"}
    assert np.concatenate(description.breaks).tolist() == [1e-9]
    assert description.switched == {"loads.k": 3e-9}
    assert (description.probes["p"].line, description.probes["p"].share) == ("cable", 0.25)
    assert description.probed == {"cable"}
    assert not description.lossy


def test_lumped_lines_leave_what_else_is_known_as_it_is():
    description = describe(scene(lines={"cable": CABLE, "stub": CABLE | {"nodes": ["c", "d"], "delay": "1 ps"}}))
    groups, nodes = description.grouped({"stub": 1})
    assert [len(group.nodes) for group in groups] == [1, 2]
    assert nodes["c"].lines == 1 / 50 == nodes["d"].lumped
    assert description.nodes["d"].lines == 1 / 50


@pytest.mark.parametrize("made", [scene(), random_elements(3)])
def test_it_is_read_once_in_a_run(made, monkeypatch):
    """Whatever is found for a described scene is found at most once, in all the runs to a tolerance."""
    read = dict.fromkeys((name for name, x in vars(Description).items() if isinstance(x, cached_property)), 0)

    def counted(name: str, found: cached_property) -> cached_property:
        def once(self):
            read[name] += 1
            return found.func(self)

        again = cached_property(once)
        again.__set_name__(Description, name)
        return again

    for name in read:
        monkeypatch.setattr(Description, name, counted(name, vars(Description)[name]))
    simulate(made, tol=1e-3)
    assert max(read.values()) == 1 == read["nodes"]


INSTANTS = 501


@pytest.mark.parametrize("name", ["cable_rc", "valve_closure", "loop", "vessel_valve"])
def test_the_second_result_is_the_first(name):
    scene = tl.examples[name]
    first, second = tl.simulate(scene), tl.simulate(scene)
    assert second.accuracy == first.accuracy
    assert second.notes == first.notes
    assert second.resolution == first.resolution
    for probe, seen in first.probes.items():
        t = np.linspace(0.0, seen.t[-1], INSTANTS)
        assert np.array_equal(second.probes[probe].at(t).u, seen.at(t).u)


def test_nothing_is_searched_again_but_for_another_tolerance_or_line(monkeypatch):
    scene = tl.examples["cable_rc"]
    tl.simulate(scene)
    searches = []
    refined = search.refined
    monkeypatch.setattr(search, "refined", lambda *given: searches.append(given) or refined(*given))
    tl.simulate(scene)
    assert not searches
    finer = tl.simulate(scene, tol=1e-8)
    assert len(searches) == 1
    assert finer.accuracy is not None
    assert finer.accuracy.tol == 1e-8
    tl.simulate(scene.change({"loads.receiver.capacitance": "5 pF"}))
    assert len(searches) == 2


def test_a_result_shares_no_array_with_the_next():
    scene = tl.examples["cable_rc"]
    first, second = tl.simulate(scene), tl.simulate(scene)
    before = second.probes["far"].u.copy()
    first.lines["cable"].a2.values[:] = 0.0
    assert np.array_equal(second.probes["far"].u, before)
    assert np.array_equal(tl.simulate(scene).probes["far"].u, before)
