"""Netlists read against nodal equations written down here, numpy, and matrix exponentials of coupled conductors."""

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from tline.frequency.response import respond
from tline.interchange.spice import read_spice
from tline.solver.simulate import simulate

GMIN = 1e9  # S, of a voltage source in the nodal equations


def nodal(cards: list[str], s: complex) -> dict[str, complex]:
    """Voltages of all nodes by the admittance matrix; a line is its exact two-port, V an admittance of GMIN."""
    parsed = [card.split() for card in cards if card[0] in "RLCTVI"]
    names = sorted(
        {node for card in parsed for node in ((card[1], card[3]) if card[0][0] == "T" else card[1:3])} - {"0"}
    )
    Y, flow = np.zeros((len(names), len(names)), complex), np.zeros(len(names), complex)

    def attach(first: str, second: str, matrix: np.ndarray) -> None:
        here = [(k, names.index(node)) for k, node in enumerate((first, second)) if node != "0"]
        for k, i in here:
            for m, j in here:
                Y[i, j] += matrix[k, m]

    for name, *words in parsed:
        if name[0] == "T":
            z0, delay = (float(word.partition("=")[2]) for word in words[4:])
            x = np.exp(-s * delay)
            y = np.array([[1 + x**2, -2 * x], [-2 * x, 1 + x**2]]) / (1 - x**2) / z0
            attach(words[0], words[2], y)
        elif name[0] in "RLCV":
            value = float(words[2])
            y = {"R": 1 / value, "L": 1 / (s * value), "C": s * value, "V": GMIN}[name[0]]
            attach(words[0], words[1], y * np.array([[1, -1], [-1, 1]]))
        for node, sign in ((words[0], -1.0), (words[1], 1.0)):
            if name[0] in "VI" and node != "0":
                flow[names.index(node)] += float(words[2]) * (sign if name[0] == "I" else -GMIN * sign)
    return dict(zip(names, np.linalg.solve(Y, flow), strict=True))


NETS = {
    "behind a resistor": ["V1 s 0 1", "R1 s a 25", "T1 a 0 b 0 Z0=50 TD=1e-9", "R2 b 0 100", "C2 b 0 4e-12"],
    "series and rungs": [
        "V1 s 0 1", "R1 s m 10", "R9 m a 15", "T1 a 0 b 0 Z0=50 TD=1e-9", "R2 b x 100", "L2 x y 5e-9", "C2 y 0 4e-12",
        "C3 x 0 1e-12", "R4 b 0 200", "T2 b 0 c 0 Z0=75 TD=0.4e-9", "L5 c 0 3e-8",
    ],
    "a current, upside down": [
        "I1 b 0 1", "T1 a 0 b 0 Z0=50 TD=1e-9", "R1 0 a 70", "L1 0 b 4e-9", "R2 b z 5", "C1 0 z 1e-12",
    ],
    "an ideal voltage, minus up": ["V1 0 a 1", "T1 a 0 b 0 Z0=50 TD=1e-9", "T2 b 0 a 0 Z0=30 TD=0.7e-9", "R2 b 0 100"],
    "one source for two lines": [
        "V1 s 0 1", "R1 s a 25", "R2 s b 75", "T1 a 0 c 0 Z0=50 TD=1e-9", "T2 b 0 c 0 Z0=60 TD=2e-9", "R3 c 0 33",
    ],
}  # fmt: skip


@pytest.mark.parametrize("name", NETS)
def test_a_netlist_read_obeys_its_nodal_equations(name, tmp_path):
    (tmp_path / "c.cir").write_text("\n".join([name, *NETS[name], ".tran 1p 9n"]), encoding="utf-8")
    scene = read_spice(tmp_path / "c.cir")[0]
    for s in (1e8 + 3e9j, 2e8 - 7e8j, 1e9 + 1e7j):
        exact = nodal(NETS[name], s)
        for probe in scene.probes:
            level = {source: float(scene.sources[source].value.level) for source in scene.sources}
            found = sum(u * respond(scene, s, source)[probe].u for source, u in level.items())
            assert abs(found - exact[probe]) < 1e-7 * abs(exact[probe])  # V has a resistance of 1/GMIN there


@pytest.mark.parametrize("said", ["Zo=50 Td=1n", "z=50 delay=1n", "ZO = 50 FREQ=250Meg NL=0.25", "Z0=50 f=250meg"])
def test_every_dialect_says_the_same_line(said, tmp_path):
    (tmp_path / "t.cir").write_text(f"t\nV1 s 0 1\nR1 s a 50\nT1 a 0 b 0 {said}\nR2 b 0 100\n.tran 1p 9n", "utf-8")
    line = read_spice(tmp_path / "t.cir")[0].lines["T1"].parameters
    assert (line.z0, line.delay) == pytest.approx((50.0, 1e-9), rel=1e-15)


def test_a_lossy_line_by_a_model_of_pspice(tmp_path):
    """As by the same numbers on its own card."""
    numbers = "LEN=0.5 R=8 L=300n C=120p G=1m"
    (tmp_path / "a.cir").write_text(f"a\nV1 s 0 1\nR1 s a 50\nT1 a 0 b 0 {numbers}\nR2 b 0 100\n.tran 1p 9n", "utf-8")
    text = f"b\nV1 s 0 1\nR1 s a 50\nT1 a 0 b 0 m\n.model m TRN {numbers}\nR2 b 0 100\n.tran 1p 9n"
    (tmp_path / "b.cir").write_text(text, "utf-8")
    own, modelled = (read_spice(tmp_path / name)[0].lines["T1"] for name in ("a.cir", "b.cir"))
    assert own == modelled


def test_many_sections_are_the_uniform_line(tmp_path):
    text = "y\nV1 s 0 1\nR1 s a 50\nYTRANSLINE c a b m LEN=12 LUMPS=1440\nR2 b 0 50\n"
    (tmp_path / "y.cir").write_text(f"{text}.model m transline r=1m l=0.5u c=60p\n.tran 1n 1u", "utf-8")
    scene, notes = read_spice(tmp_path / "y.cir")
    line = scene.lines["Yc"].parameters
    assert (line.z0, line.delay) == pytest.approx((np.sqrt(0.5e-6 / 60e-12), 12 * np.sqrt(0.5e-6 * 60e-12)), rel=1e-12)
    assert any("in place of its 1440 sections" in note for note in notes)


def test_the_sections_of_xyces_lumped_line(tmp_path):
    """Each is R + sL in series and then sC across: the ratio of voltages by a product of chain matrices."""
    cards = ["V1 s 0 1", "R1 s a 25", "YTRANSLINE cable a b m LEN=0.5 LUMPS=7", "R2 b 0 100", ".tran 1p 9n uic"]
    cards += [".model m TRANSLINE R=8 L=300n C=120p", "T1 b 0 c 0 Z0=50 TD=1n", "R3 c 0 50"]
    (tmp_path / "y.cir").write_text("\n".join(["y", *cards]), encoding="utf-8")
    scene = read_spice(tmp_path / "y.cir")[0]
    for s in (1e8 + 3e9j, 2e8 - 7e8j, 1e9 + 1e7j):
        z, y = (8 + s * 300e-9) * 0.5 / 7, s * 120e-12 * 0.5 / 7
        section = np.array([[1, z], [0, 1]]) @ np.array([[1, 0], [y, 1]])
        chain = np.array([[1, 25], [0, 1]]) @ np.linalg.matrix_power(section, 7)
        exact = 1 / (chain @ [1, 1 / 100 + 1 / 50])[0]  # a matched line at the end
        assert abs(respond(scene, s, "V1")["b"].u - exact) < 1e-9 * abs(exact)


@pytest.mark.parametrize(
    ("source", "asked"),
    [
        (["V1 a 0 AC 1", "R1 a b 50"], [".ac dec 10 1meg 1g"]),
        (["V1 b 0 dc 0 ac 1 portnum 1 z0 50 pwr 0.001"], [".sp lin 10 1meg 1g"]),
        (["P1 b 0 port=1 z0=50 AC=1"], [".ac dec 10 1meg 1g", ".lin"]),
        (["V1 a 0 AC 1", "R1 a b 50"], [".ac 0 1gig 1meg"]),
        (["V1 a 0 AC 1", "R1 a b 50"], [".control", "ac oct 3 1meg 1g", "plot v(c)", ".endc"]),
    ],
)
def test_a_deck_that_asks_for_frequencies_alone(source, asked, tmp_path):
    cards = [*source, "T1 b 0 c 0 Z0=50 TD=1n", "R2 c 0 100", *asked]
    (tmp_path / "ac.cir").write_text("\n".join(["ac", *cards]), encoding="utf-8")
    scene, notes = read_spice(tmp_path / "ac.cir")
    assert any('--from "1 MHz" --to "1 GHz" shows it' in note for note in notes)
    s = 2j * np.pi * 3e8
    passed = np.exp(-s * 1e-9)
    assert (
        abs(respond(scene, s, next(iter(scene.sources)))["c"].u - 2 / 3 * passed) < 1e-12
    )  # matched at the source: 1/2 times 1 + 1/3


LENGTH, LO, CO, RO, GO, RS = 0.2, 3e-7, 1.2e-10, 8.0, 2e-3, 1.5e-3
W_NET = [
    "a W element", "V1 s 0 1", "R1 s a 25", "W1 N=1 a 0 b 0 RLGCMODEL=trace L=0.2", "R2 b 0 100",
    ".model trace W MODELTYPE=RLGC, N=1", "+ Lo = 3e-7 Co=120p Ro=8", "+ Go=2m Rs=", "+ 1.5m Gd=0", ".tran 1p 9n uic",
]  # fmt: skip


def test_a_w_element_is_the_line_of_the_manual(tmp_path):
    """Z = Ro + √f (1+j) Rs + 2πj f Lo, Y = Go + 2πj f Co, and the textbook's chain matrix."""
    (tmp_path / "w.cir").write_text("\n".join(W_NET), encoding="utf-8")
    scene = read_spice(tmp_path / "w.cir")[0]
    for f in (1e3, 1e7, 3e8, 1e10):
        Z, Y = RO + np.sqrt(f) * (1 + 1j) * RS + 2j * np.pi * f * LO, GO + 2j * np.pi * f * CO
        gamma, z0 = np.sqrt(Z * Y) * LENGTH, np.sqrt(Z / Y)
        over, current = np.cosh(gamma) + z0 * np.sinh(gamma) / 100, np.sinh(gamma) / z0 + np.cosh(gamma) / 100
        exact = 1 / (over + 25 * current)
        found = respond(scene, 2j * np.pi * f, "V1")
        assert abs(found["b"].u - exact) < 1e-12 * abs(exact)
        assert abs(found["a"].u - exact * over) < 1e-12 * abs(exact * over)


def test_conductors_of_a_w_element_driven_alike_are_one_w_element(tmp_path):
    """Symmetry: both at one voltage, each sees L11 + L12, C11 + C12, R11 + R12 and so on."""
    ends = ["V1 s 0 SIN(1 -1 0.3G 0 0 90)", "R1 s a 25", "R2 b 0 100", "R3 s c 25", "R4 d 0 100", ".tran 1p 5n uic"]
    pair = ["W1 a c 0 b d 0 N=2 L=0.2 RLGCMODEL=m", ".model m W MODELTYPE=RLGC N=2 Lo=3e-7 1e-7 3e-7"]
    pair += ["+ Co=93.75p -31.25p 93.75p Ro=8 1 8 Go=1.2m -0.4m 1.2m"]
    alone = ["W1 a 0 b 0 N=1 L=0.2 RLGCMODEL=m", "W2 c 0 d 0 N=1 L=0.2 RLGCMODEL=m"]
    alone += [".model m W MODELTYPE=RLGC N=1 Lo=4e-7 Co=62.5p Ro=9 Go=0.8m"]
    found = []
    for cards in (pair, alone):
        (tmp_path / "w.cir").write_text("\n".join(["w", *cards, *ends]), encoding="utf-8")
        scene = read_spice(tmp_path / "w.cir")[0].with_changes(solver={"order": 6, "slab": "0.25 ns"})
        found.append(simulate(scene, active=True).probes["d"].u)
    assert np.abs(found[0] - found[1]).max() < 1e-12


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


DECKS, SAMPLES = Path(__file__).parent.parent / "decks", 1 << 12
NS = 1e-9


def near(diagonal: float, beside: float, size: int) -> np.ndarray:
    """A matrix of equal conductors, each coupled with its neighbours."""
    return diagonal * np.eye(size) + beside * (np.eye(size, k=1) + np.eye(size, k=-1))


def exact(R, L, C, length, near_end, far_end, corners, t_end) -> tuple[np.ndarray, np.ndarray]:
    """Instants and voltages at both ends, the first conductor driven; what wraps around is exp(-12) of itself."""
    size, period, damping = len(L), 2 * t_end, 6 / t_end
    s = damping + 2j * np.pi * np.fft.rfftfreq(SAMPLES, period / SAMPLES)
    slopes = np.diff([0, *(np.diff([u for _, u in corners]) / np.diff([t for t, _ in corners])), 0])
    source = sum(k * np.exp(-s * t) for k, (t, _) in zip(slopes, corners, strict=True)) / s**2
    zero = np.zeros((len(s), size, size))
    matrix = np.concatenate([np.concatenate([zero, -(R + s[:, None, None] * L)], 2),
                             np.concatenate([-s[:, None, None] * C, zero], 2)], 1)  # fmt: skip
    chain = expm(matrix * length)  # of the near end's voltages and currents to the far end's
    G0, G1 = np.diag(1 / near_end), np.diag(1 / far_end)
    driven = G0[:, :1]  # current into the near end: G0 (e - u)
    A, B, D, E = chain[:, :size, :size], chain[:, :size, size:], chain[:, size:, :size], chain[:, size:, size:]
    u = np.linalg.solve(D - E @ G0 - G1 @ (A - B @ G0), (G1 @ B - E) @ driven)
    u = np.concatenate([u, (A - B @ G0) @ u + B @ driven], 1)[:, :, 0] * source[:, None]
    t = np.arange(SAMPLES) * period / SAMPLES
    taper = np.cos(np.linspace(0, np.pi / 2, len(s)))[:, None] ** 2
    return t, np.fft.irfft(u * taper, axis=0) * SAMPLES / period * np.exp(damping * t)[:, None]


def test_the_reference_is_a_matched_line_where_there_is_one():
    t, u = exact(0 * np.eye(1), 2.5e-7 * np.eye(1), 1e-10 * np.eye(1), 0.4, np.array([50.0]), np.array([50.0]),
                 [(0, 0), (1 * NS, 1)], 10 * NS)  # fmt: skip
    assert np.abs(u - 0.5 * np.clip(t[:, None] / NS - [0, 2], 0, 1))[t < 9 * NS].max() < 2e-3


PULSE = [(0, 0), (1.5 * NS, 1), (6 * NS, 1), (7.5 * NS, 0)]
STEPS = [(3 * NS, 0), (3.5 * NS, 4), (12 * NS, 4), (12.5 * NS, 0)]


@pytest.mark.parametrize(
    ("deck", "line", "ends", "corners"),
    [
        ("cpl_pair", (near(0.5, 0, 2), near(250e-9, 30e-9, 2), near(32e-12, -2.5e-12, 2), 0.3),
         ([50.0, 10.0], [100.0, 100.0]), PULSE),
        ("cpl_four", (near(0.3, 0, 4), near(9e-9, 5e-9, 4), near(3.5e-13, -3e-14, 4), 6),
         ([1e3] * 4, [1e6] * 4), STEPS),
    ],
)  # fmt: skip
def test_a_deck_of_coupled_conductors(deck, line, ends, corners):
    scene, _ = read_spice(DECKS / f"{deck}.cir")
    size = len(ends[0])
    nodes = ("a1", "a2", "b1", "b2") if size == 2 else tuple("2345") + tuple("6789")
    seen = simulate(scene.with_changes(probes={at: {"at": at} for at in nodes}), tol=1e-3)
    t, u = exact(*line, *map(np.array, ends), corners, float(scene.t_end))
    inside = t < 0.9 * float(scene.t_end)
    ours = np.array([seen.probes[at].at(t[inside]).u for at in nodes]).T
    assert np.abs(ours - u[inside]).max() < 2e-3 * max(level for _, level in corners)
