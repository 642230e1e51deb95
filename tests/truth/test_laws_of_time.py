"""Behavioural sources of netlists whose laws have nothing but the time in them, against numpy."""

import numpy as np

from tline.interchange.spice import read_spice


def test_a_source_by_a_law_of_time_is_its_law(tmp_path):
    """A jump, a decay, a limited ramp and a sine, each against numpy; straight pieces take few points."""
    deck = tmp_path / "laws.cir"
    laws = {
        "B1": (
            "V={time < 1.23n ? 0 : 3*exp(-(time-1.23n)/0.5n)}",
            lambda t: 3 * np.exp(-(t - 1.23e-9) / 0.5e-9) * (t >= 1.23e-9),
        ),
        "B2": ("V=5*min(max((time-1n)/0.2n,0),1)", lambda t: 5 * np.clip((t - 1e-9) / 0.2e-9, 0, 1)),
        "B3": ("I={a*sin(2*pi*0.3g*time)}", lambda t: -0.02 * np.sin(2 * np.pi * 0.3e9 * t)),
    }
    cards = [f"{name} {name}s 0 {law}\nR{name} {name}s {name}e 50" for name, (law, _) in laws.items()]
    cards += [f"T{name} {name}e 0 {name}f 0 Zo=50 Td=1n\nR{name}f {name}f 0 50" for name in laws]
    deck.write_text("\n".join(["laws", ".param a=20m", *cards, ".tran 10p 9n"]), encoding="utf-8")
    scene, notes = read_spice(deck)
    assert all("its law of time is" in note for note in notes[:3])
    t = np.linspace(0, 8.99e-9, 3001)
    for name, (_, exact) in laws.items():
        waveform = scene.sources[name].value
        seen = np.array([float(waveform.value(x, x)) for x in t])
        assert np.abs(seen - exact(t)).max() < 1e-4 * np.abs(exact(t)).max()
    assert len(scene.table()["sources"]["B2"]["value"]["points"]) < 12
