"""Steady starts with multiports and coupled conductors: by hand, in ngspice, and kept by a run that nothing moves."""

import shutil
import subprocess

import numpy as np
import pytest

from tline import InputError, Scene, simulate
from tline.interchange.spice import read_spice
from tline.solver.description.description import describe
from tline.solver.steady.steady_state import steady_state

SOURCE = {"s": {"at": "in", "kind": "voltage", "value": 2.0, "resistance": 50}}
LINES = {
    "a": {"nodes": ["in", "p"], "z0": 50, "delay": "1 ns"},
    "b": {"nodes": ["q", "out"], "z0": 75, "delay": "1.3 ns"},
}
EVEN, ODD = {"z0": 60, "delay": "1.1 ns"}, {"z0": 40, "delay": "0.9 ns"}
PAIR = {"nodes1": ["in", "q"], "nodes2": ["p", "out"]}
L, C = [[3e-7, 6e-8], [6e-8, 3.5e-7]], [[1e-10, -1e-11], [-1e-11, 1.2e-10]]
MIXING = PAIR | {"length": 1, "inductance": L, "capacitance": C, "resistance": [[5, 1], [1, 8]]}
END = {"end": {"at": "out", "kind": "resistor", "resistance": 20}}
LOAD = {"load": {"at": "p", "kind": "resistor", "resistance": 100}}
COILS = {"kind": "coupled inductors", "inductance": ["1 uH", "4 uH"], "coupling": 0.9}
CHARGE = (0.9 / 40 - 1.1 / 60) / (0.9 / 40 + 1.1 / 60)  # of conductors whose even and odd C are delay/z0

# efforts at in, p, q and out, by hand
BY_HAND = {
    "transformer": (LINES, {"x": {"kind": "transformer", "nodes": ["p", "q"], "ratio": 2}}, END,
                    (16 / 13, 16 / 13, 8 / 13, 8 / 13)),  # 20 ohm are seen as 80
    "gyrator": (LINES, {"x": {"kind": "gyrator", "nodes": ["p", "q"], "resistance": 30}}, END,
                (18 / 19, 18 / 19, 12 / 19, 12 / 19)),  # as 45
    "amplifier": (LINES, {"x": {"kind": "controlled source", "nodes": ["p", "q"], "gain": 3, "resistance": 10}},
                  LOAD | END, (4 / 3, 4 / 3, 8 / 3, 8 / 3)),
    "windings": (LINES, {"x": COILS | {"nodes": ["p", "q"]}}, END, (0, 0, 0, 0)),
    "winding in series": (LINES, {"x": COILS | {"nodes": ["p", "m", "q", "m"]},
                                  "r": {"kind": "resistor", "nodes": ["m", "out"], "resistance": 30}}, END,
                          4 * (4 / 7,)),
    "conductors": ({"pair": PAIR | {"even": EVEN, "odd": ODD}}, {}, LOAD | END, (4 / 3, 4 / 3, 0, 0)),
    "conductor that capacitance ties": ({"pair": PAIR | {"even": EVEN, "odd": ODD}}, {}, LOAD,
                                        (4 / 3, 4 / 3, *2 * [4 / 3 * CHARGE])),
    "losses that mix modes": ({"pair": MIXING}, {}, LOAD | END,
                              (2 - 100 / 155, 200 / 155, 2 / 155, 0)),  # 5, 1 and 8 ohm in all
}  # fmt: skip


def scene(lines: dict, links: dict, loads: dict, **parts) -> Scene:
    whole = {
        "medium": "electrical", "t_end": "100 ns", "start": "steady", "lines": lines, "links": links, "loads": loads,
        "sources": SOURCE, "probes": {at: {"at": at} for at in ("in", "p", "q", "out")},
    }  # fmt: skip
    return Scene(**whole | parts)


@pytest.mark.parametrize("name", BY_HAND)
def test_the_steady_start_is_that_by_hand_and_stays(name):
    *parts, expected = BY_HAND[name]
    result = simulate(scene(*parts), active=name == "amplifier")
    for probe, effort in zip(result.probes.values(), expected, strict=True):
        assert np.abs(probe.u - effort).max() < 1e-12  # rounding of some hundred unknowns and 40 round trips


def test_a_law_beside_an_amplifier_is_met():
    """A diode into the output of an amplifier of no resistance: i = Is (exp(u/nUt) - 1), by bisection."""
    from scipy.constants import e, k
    from scipy.optimize import brentq

    links = {"x": {"kind": "controlled source", "nodes": ["p", "q"], "gain": 3, "resistance": 0},
             "d": {"kind": "diode", "nodes": ["out", "m"], "saturation": "1 pA"},
             "r": {"kind": "resistor", "nodes": ["m", "far"], "resistance": 100}}  # fmt: skip
    far = {"far": {"at": "far", "kind": "resistor", "resistance": 0}}
    given = scene(LINES, links, LOAD | far)
    thermal = k * 300.15 / e
    effort, _ = steady_state(describe(given))
    u = brentq(lambda u: 1e-12 * np.expm1((4 - u) / thermal) - u / 100, 0, 4, xtol=1e-15)
    assert effort["m"] == pytest.approx(u, rel=1e-11)


@pytest.mark.parametrize(
    ("link", "sentence"),
    [
        (COILS | {"nodes": ["p", "q"]}, "links.x, lines.a, node 'in': no steady state: nothing takes the flow, or"),
        ({"kind": "controlled source", "nodes": ["in", "p"], "transconductance": 1},
         "lines.b, node 'q', node 'out': no steady state"),
    ],
)  # fmt: skip
def test_what_has_no_steady_state_is_named(link, sentence):
    held = {"s": {"at": "in", "kind": "voltage", "value": 2.0}, "i": {"at": "out", "kind": "current", "value": 1.0}}
    with pytest.raises(InputError) as found:
        steady_state(describe(scene(LINES, {"x": link}, {}, sources=held)))
    assert str(found.value).startswith(sentence)


DECKS = {
    "sources that voltages and currents command": [
        "V1 s 0 DC 1.5", "R1 s a 50", "T1 a 0 b 0 Z0=50 TD=1n", "R2 b 0 75", "E1 c 0 b 0 2.5", "R3 c d 30",
        "T2 d 0 e 0 Z0=75 TD=1n", "G1 0 e a b 0.01", "G2 e 0 b 0 0.003", "R4 e 0 120", "V2 e f DC 0", "R5 f 0 200",
        "F1 0 b V2 0.4", "H1 g 0 V2 60", "R6 g e 90",
    ],
    "windings, and a source with an offset": [
        "V1 s 0 SIN(0.7 1 100MEG)", "R1 s a 50", "T1 a 0 b 0 Z0=50 TD=1n", "L1 b c 1u", "L2 d 0 4u", "K1 L1 L2 0.8",
        "R2 c 0 60", "T2 d 0 e 0 Z0=75 TD=1n", "R3 e a 40", "R4 e 0 70",
    ],
    "a behavioural source": [
        "V1 s 0 DC 1", "R1 s a 50", "T1 a 0 b 0 Z0=50 TD=1n", "R2 b 0 50", "B1 c 0 V=0.5+2*V(b)", "R3 c d 20",
        "T2 d 0 e 0 Z0=60 TD=1n", "R4 e 0 80",
    ],
}  # fmt: skip


@pytest.mark.skipif(shutil.which("ngspice") is None, reason="ngspice is not installed")
@pytest.mark.parametrize("name", DECKS)
def test_ngspice_finds_the_same_operating_point(name, tmp_path):
    cards = ["a deck", *DECKS[name]]
    (tmp_path / "deck.cir").write_text("\n".join([*cards, ".tran 1n 20n", ".end"]), encoding="utf-8")
    effort, _ = steady_state(describe(read_spice(tmp_path / "deck.cir")[0]))
    asked = [".control", "set numdgt=12", "op", "print a b d e", ".endc", ".end", ""]
    (tmp_path / "op.cir").write_text("\n".join([*cards, ".options reltol=1e-9 gmin=1e-20", *asked]), encoding="utf-8")
    told = subprocess.run(["ngspice", "-b", "op.cir"], cwd=tmp_path, capture_output=True, text=True, check=False).stdout
    found = dict(line.split(" = ") for line in told.splitlines() if line[1:4] == " = ")
    assert {*found} == {*"abde"}
    for node, u in found.items():
        assert effort[node] == pytest.approx(float(u), rel=1e-9, abs=1e-9)
