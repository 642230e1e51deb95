"""Modes of coupled conductors, and what a scene with them refuses."""

import numpy as np
import pytest

from tline import InputError, Scene, SceneError, simulate
from tline.interchange.netlist_text import spice_text
from tline.line.modes import even_and_odd, modes
from tline.pictures.lattice import only_line
from tline.pictures.path import route
from tline.scene.line import Cable
from tline.scene.plausible import plausibility_notes
from tline.solver.description.description import describe
from tline.solver.stability.growth import Characteristic
from tline.study.reference.network import ReferenceNetwork

PAIR = {"nodes1": ["a1", "a2"], "nodes2": ["b1", "b2"]}
MODES = {"even": {"z0": 60, "delay": "1.1 ns"}, "odd": {"z0": 40, "delay": "0.9 ns"}}
LOSSY = MODES["even"] | {"resistance": 5}
L, C = [[3e-7, 6e-8], [6e-8, 3e-7]], [[1.3e-10, -1.3e-11], [-1.3e-11, 1.3e-10]]
MATRICES = {"inductance": L, "capacitance": C, "length": 1}


def scene(line: dict, **parts) -> Scene:
    whole = {"medium": "electrical", "t_end": "9 ns", "lines": {"pair": PAIR | line}, "probes": {"p": {"at": "b2"}}}
    return Scene(**whole | parts)


def test_a_symmetric_pair_has_an_even_and_an_odd_mode():
    found = modes(L, C, 0.5)
    odd, even = (np.sqrt((3e-7 - sign * 6e-8) * (1.3e-10 + sign * 1.3e-11)) / 2 for sign in (1, -1))
    assert found.delay == pytest.approx(sorted([odd, even]), rel=1e-14)
    z = dict(zip(found.delay.tolist(), found.z0.tolist(), strict=True))
    assert z[min(z)] == pytest.approx(np.sqrt(2.4e-7 / 1.43e-10), rel=1e-14)
    assert z[max(z)] == pytest.approx(np.sqrt(3.6e-7 / 1.17e-10), rel=1e-14)
    assert np.abs(found.T) == pytest.approx(np.full((2, 2), np.sqrt(0.5)), rel=1e-14)


def test_modes_diagonalise_both_matrices():
    rng = np.random.default_rng(1)
    for k in range(2, 9):
        mutual, skew = np.triu(rng.uniform(0, 1, (k, k)), 1), rng.normal(size=(k, k))
        c = np.diag(1 + (mutual + mutual.T).sum(axis=1)) - mutual - mutual.T
        induct = skew @ skew.T + np.eye(k)
        found = modes(induct * 1e-7, c * 1e-10, 3.0)
        inverse = np.linalg.inv(found.T)
        assert inverse @ induct @ inverse.T * 1e-7 == pytest.approx(np.diag(found.z0 * found.delay / 3), abs=1e-18)
        assert found.T.T @ c @ found.T * 1e-10 == pytest.approx(np.diag(found.delay / found.z0 / 3), abs=1e-21)
        assert np.linalg.norm(found.T, axis=0) == pytest.approx(np.ones(k), rel=1e-14)
        # the characteristic admittance Y of all conductors: Y L Y = C
        Y = found.admittance
        assert Y @ induct @ Y * 1e-7 == pytest.approx(c * 1e-10, abs=1e-21)


def test_the_pair_by_its_modes_is_the_pair_by_its_matrices():
    even, odd = (np.sqrt((3e-7 + sign * 6e-8) / (1.3e-10 - sign * 1.3e-11)) for sign in (1, -1))
    slow, fast = (np.sqrt((3e-7 + sign * 6e-8) * (1.3e-10 - sign * 1.3e-11)) for sign in (1, -1))
    assert even_and_odd((even, slow), (odd, fast)).admittance == pytest.approx(modes(L, C, 1).admittance, rel=1e-13)


def test_losses_of_a_pair_by_its_matrices_and_by_its_modes():
    R, G = [[12, 2], [2, 12]], [[3e-3, -1e-3], [-1e-3, 3e-3]]
    found = modes(L, C, 1, {"R": R}, {"G": G})  # odd is faster
    assert found.losses["R"] == pytest.approx([10, 14], rel=1e-13)
    assert found.losses["G"] == pytest.approx([4e-3, 2e-3], rel=1e-13)


def test_a_mode_without_loss_is_lossless():
    shared = scene(MATRICES | {"resistance": [[5, 5], [5, 5]]})  # all of it in a common return
    assert [line.losses is None for line in shared.single_lines.values()] == [True, False]


def test_skin_effect_by_a_matrix_is_that_of_each_mode():
    """L, C and the resistances as of a symmetric pair: even 40 + 5, odd 40 - 5."""
    skin = {"resistance": [[40, 5], [5, 40]], "frequency": "10 GHz"}
    odd, even = scene(MATRICES | {"skin": skin}).single_lines.values()
    assert isinstance(odd, Cable)
    assert isinstance(even, Cable)
    assert [float(line.skin.resistance) for line in (odd, even)] == pytest.approx([35, 45], rel=1e-13)
    assert [line.parameters.length for line in (odd, even)] == [1, 1]


def test_in_an_insulation_all_alike_modes_are_those_of_any_resistances():
    rng = np.random.default_rng(2)
    for k in range(2, 9):
        mutual, skew = np.triu(rng.uniform(0, 1, (k, k)), 1), rng.normal(size=(k, k))
        c = np.diag(1 + (mutual + mutual.T).sum(axis=1)) - mutual - mutual.T
        induct, R = np.linalg.inv(c), skew @ skew.T
        found = modes(induct * 1e-7, c * 1e-10, 3.0, {"R": R}, {"G": c * 1e-3})
        inverse = np.linalg.inv(found.T)
        assert inverse @ induct @ inverse.T * 1e-7 == pytest.approx(np.diag(found.z0 * found.delay / 3), abs=1e-20)
        assert inverse @ R @ inverse.T == pytest.approx(np.diag(found.losses["R"]), abs=1e-12)
        assert found.T.T @ c @ found.T * 1e-3 == pytest.approx(np.diag(found.losses["G"]), abs=1e-15)


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ({}, "lines.pair: is not given once, expected inductance, capacitance and length, or even and odd, got none"),
        (MODES | {"length": 1}, "lines.pair.length: is given, and no loss needs it, got 1"),
        ({"inductance": L, "capacitance": C}, "lines.pair: is not given once"),
        (MODES | {"nodes2": ["b1", "b2", "b3"]}, "lines.pair.nodes2: another number of conductors, expected 2, got 3"),
        (MODES | {"nodes1": ["a1"]}, "lines.pair.nodes1: not a list of nodes"),
        (MODES | {"odd": {"z0": 40}}, "lines.pair.odd.delay: is missing"),
        (MODES | {"odd": {"z0": -40, "delay": 1}}, "lines.pair.odd.z0: z0 out of range"),
        ({"inductance": [[1, 2]], "capacitance": C, "length": 1}, "lines.pair.inductance: not a square matrix"),
        ({"inductance": [[1, 2], [3]], "capacitance": C, "length": 1}, "lines.pair.inductance: not a square matrix"),
        ({"inductance": [[1, 0.1], [0.2, 1]], "capacitance": C, "length": 1}, "lines.pair.inductance: not symmetric"),
        ({"inductance": [[1, 2], [2, 1]], "capacitance": C, "length": 1}, "lines.pair.inductance: not positive"),
        ({"inductance": L, "capacitance": [[2, 1], [1, 2]], "length": 1}, "lines.pair.capacitance: positive beside"),
        ({"inductance": L, "capacitance": np.eye(3).tolist(), "length": 1}, "lines.pair.capacitance: not of the size"),
        ({"inductance": np.eye(3).tolist(), "capacitance": np.eye(3).tolist(), "length": 1},
         "lines.pair.nodes1: another number of conductors, expected 3, got 2"),
        ({"inductance": [["1 nF/m", 0], [0, 1]], "capacitance": C, "length": 1}, "lines.pair.inductance[0][0]: "),
        (MODES | {"even": LOSSY}, "lines.pair.length: resistance needs its length, got none"),
        (MODES | {"resistance": L}, "lines.pair: is not given once, expected inductance"),
        (MATRICES | {"resistance": [[1, 2], [2, 1]]}, "lines.pair.resistance: creates power"),
        (MATRICES | {"conductance": [[2, 1], [1, 2]]}, "lines.pair.conductance: positive beside its diagonal"),
        (MATRICES | {"skin": {"resistance": [[1]], "frequency": 1}},
         "lines.pair.skin.resistance: not of the size of the other matrix, expected 2 rows, got 1"),
        (MATRICES | {"capacitance": [[1.3e-12, -1e-13], [-1e-13, 1.3e-12]], "conductance": [[1, 0], [0, 1]]},
         "lines.pair: of mode 1: the wave would be faster than light, expected a wave speed up to 299792 km/s, got"),
        (MATRICES | {"length": "1 km", "inductance": [[3e-9, 6e-10], [6e-10, 3e-9]], "resistance": [[1, 0], [0, 1]]},
         "lines.pair: of mode 1: the wave would be faster than light"),
        ({"even": LOSSY, "odd": MODES["odd"], "length": "1 m"}, "lines.pair: of mode 1: the wave would be faster than"),
        (MODES | {"inductanse": 1}, "lines.pair.inductanse: unknown key, expected 'inductance'"),
    ],
)  # fmt: skip
def test_a_mistake_in_a_pair_is_one_sentence(line, sentence):
    with pytest.raises(SceneError) as found:
        scene(line)
    assert str(found.value).startswith(sentence)
    assert "\n" not in str(found.value)


@pytest.mark.parametrize(
    ("parts", "sentence"),
    [
        ({"loads": {"x": {"at": "a1", "kind": "matched"}}}, "loads.x: a matched load at node 'a1' of coupled"),
        ({"probes": {"p": {"line": "pair", "position": "50 %"}}}, "probes.p.position: nothing is recorded"),
        ({"probes": {"p": {"at": "x"}}}, "probes.p.at: no line ends at this node"),
        ({"solver": {"slab": "1 ns"}}, "solver.slab: longer than the shortest delay, expected at most that of"),
        ({"lines": {"pair": PAIR | MODES, "pair, mode 2": {"nodes": ["b1", "c"], "z0": 1, "delay": 1}}},
         "lines: a name that a mode of coupled conductors has"),
    ],
)  # fmt: skip
def test_what_coupled_conductors_exclude_is_named(parts, sentence):
    with pytest.raises(SceneError) as found:
        scene(MODES, **parts)
    assert str(found.value).startswith(sentence)


@pytest.mark.parametrize(
    "ask", [spice_text, route, only_line, lambda made: Characteristic(describe(made)), ReferenceNetwork]
)
def test_what_does_not_know_them_says_so(ask):
    with pytest.raises(InputError, match="coupled conductors"):
        ask(scene(MODES))


def test_lossless_modes_faster_than_light_are_a_note():
    fast = scene(MATRICES | {"capacitance": [[1.3e-12, -1e-13], [-1e-13, 1.3e-12]]})
    assert plausibility_notes(fast) == ["lines.pair: L and C are too small: a mode is faster than light"]
    assert plausibility_notes(scene(MATRICES)) == []


def test_pipes_are_not_coupled():
    with pytest.raises(SceneError, match=r"lines\.pair\.nodes1: unknown key"):
        scene(MODES, medium="hydraulic")


@pytest.mark.parametrize("resistance", ["1 Tohm", "9223372036854775807 ohm", 1e30])
def test_a_resistor_that_hardly_conducts_is_an_open_end_of_a_conductor(resistance):
    tables = {
        "medium": "electrical", "t_end": "3 ns", "probes": {"p": {"at": "c"}},
        "lines": {"pair": {"nodes1": ["a", "b"], "nodes2": ["c", "d"], "even": {"z0": 60, "delay": "1.1 ns"},
                           "odd": {"z0": 40, "delay": "0.9 ns"}}},
        "sources": {"s": {"at": "a", "kind": "voltage", "value": 1, "resistance": 30}},
    }  # fmt: skip
    loads = {"end": {"at": "c", "kind": "resistor", "resistance": resistance}}
    end, free = (simulate(Scene(**tables | more)).probes["p"].u for more in ({"loads": loads}, {}))
    assert np.abs(end - free).max() <= 1e-10 * np.abs(free).max()  # 50 ohm beside 1 Tohm
