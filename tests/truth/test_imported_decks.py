"""Decks of the structure of other programs' examples, imported, against ngspice and against rounding."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from tline.interchange.spice import read_spice
from tline.solver.simulate import simulate

DECKS = Path(__file__).parent.parent / "decks"
BOUNDS = {"transline": 1.4e-2, "five_lines": 1e-3, "urc": 6e-5, "ltra_square": 4e-4}  # twice what version 39.3 shows


@pytest.mark.parametrize("deck", sorted(DECKS.glob("*.cir")), ids=lambda path: path.stem)
def test_every_deck_is_imported(deck):
    scene, notes = read_spice(deck)
    assert scene.probes
    assert all(note.startswith(str(deck)) for note in notes)


@pytest.mark.skipif(shutil.which("ngspice") is None, reason="ngspice is not installed")
@pytest.mark.parametrize("name", BOUNDS)
def test_ngspice_agrees_within_its_own_error(name):
    from imported_decks import distance, in_ngspice

    scene, _ = read_spice(DECKS / f"{name}.cir")
    ours = simulate(scene.with_changes(solver={"tol": 1e-3 if name == "ltra_square" else 1e-5}))
    assert distance(ours, in_ngspice(DECKS / f"{name}.cir", ours, 8000)) < BOUNDS[name]


def test_a_ladder_without_inductance_is_the_line_of_thomson(tmp_path):
    """The step response of an open RC line is a sum of erfc (W. Thomson, 1855)."""
    from scipy.special import erfc

    cards = ["rc", "V1 a 0 PULSE(0 1 0 0 0 1)", "O1 a 0 b 0 m", ".model m LTRA(R=10 C=1n LEN=10)", ".tran 0 3u 0 uic"]
    (tmp_path / "rc.cir").write_text("\n".join(cards), encoding="utf-8")
    scene, _ = read_spice(tmp_path / "rc.cir")
    scene = scene.with_changes(probes={"b": {"at": "b"}}, solver={"tol": 1e-6})
    t = np.linspace(0.05e-6, 2.9e-6, 60)
    k = np.arange(40)[:, None]
    exact = 2 * np.sum((-1.0) ** k * erfc((2 * k + 1) * np.sqrt(100 * 10e-9 / t) / 2), axis=0)
    assert np.abs(simulate(scene).probes["b"].at(t).u - exact).max() < 4e-4


@pytest.mark.parametrize(("sensed", "voltage"), [("a 0", 2.0), ("0 a", -2.0)])
def test_a_current_counts_from_plus_to_minus_wherever_the_reference_is(tmp_path, sensed, voltage):
    """2 A, of the unit that most dialects have there, into 1 ohm by a gain of 1."""
    cards = ["sense", "I1 0 a PWL(0 0 1u 2A)", f"V1 {sensed} 0", "H1 b 0 V1 1", "R1 b 0 1k", ".tran 0 2u 0 uic"]
    (tmp_path / "sense.cir").write_text("\n".join(cards), encoding="utf-8")
    scene, _ = read_spice(tmp_path / "sense.cir")
    seen = simulate(scene.with_changes(probes={"b": {"at": "b"}}), active=True).probes["b"]
    assert seen.at(np.array([2e-6])).u == pytest.approx(voltage, rel=1e-9)


def test_a_source_beside_loads_alone_is_read(tmp_path):
    """A current into a capacitor and a resistor: i R (1 - exp(-t/RC)); a voltage alone is what it says."""
    cards = ["alone", "I1 0 a 2m", "C1 a 0 1n", "R1 0 a 1k", "V2 $G_b 0 5", "E3 c 0 VALUE {2*v($G_b)}", "R3 c 0 1"]
    (tmp_path / "alone.cir").write_text("\n".join([*cards, ".tran 0 3u 0 uic", ".print tran v(a) v(c)"]))
    scene, _ = read_spice(tmp_path / "alone.cir")
    seen = simulate(scene.with_changes(solver={"tol": 1e-8}), active=True).probes
    t = np.linspace(0.1e-6, 3e-6, 9)
    assert seen["a"].at(t).u == pytest.approx(2 * (1 - np.exp(-t / 1e-6)), abs=1e-7)
    assert seen["c"].at(t).u == pytest.approx(10)
