"""Delays that no slab divides, rounded or not: closed forms, and admittances of lossy lines by damped FFT."""

from math import pi

import numpy as np
import pytest

import tline as tl
from tline.scene.scene import Scene

PIPE = {"diameter": 0.3, "wave_speed": 1000, "density": 1000}
Z0 = 1000 * 1000 / (pi / 4 * 0.3**2)


def scene(lengths, *, takes: float = 0.3, friction: bool = False, **solver) -> tl.Scene:
    """A tee between two lakes: a tap at its third end shuts."""
    ends = {"a": "lake", "b": "tower", "c": "tap"}
    rough = {"friction": {"kind": "hazen-williams", "coefficient": 110}} if friction else {}
    lines = {
        name: {"nodes": [end, "tee"], "length": length, **PIPE, **rough}
        for (name, end), length in zip(ends.items(), lengths, strict=True)
    }
    shut = {"shape": "ramp", "from": 1, "to": 0, "at": 0.2, "duration": takes}
    tap = {"at": "tap", "kind": "orifice", "flow": 0.05, "pressure_drop": 6e5, "opening": shut}
    lakes = {end: {"at": end, "kind": "reservoir", "pressure": 6e5} for end in ("lake", "tower")}
    return tl.Scene(
        medium="hydraulic", t_end=4, start="steady", lines=lines, loads=lakes | {"tap": tap},
        probes={"tap": {"at": "tap"}}, solver={"rounded": True} | solver,
    )  # fmt: skip


def test_joukowskys_rise_on_whole_slabs():
    probe = tl.simulate(scene([200, 300, 400], takes=1e-6, tol=1e-2)).probes["tap"]
    assert probe.at(0.5).u == pytest.approx(probe.u[0] + Z0 * abs(probe.y[0]), rel=1e-9)


@pytest.mark.parametrize("friction", [False, True])
@pytest.mark.parametrize("seed", range(2))
def test_extremes_are_within_their_errors(seed, friction):
    """Of runs by polynomials in slabs, with delays as they are."""
    lengths = np.random.default_rng(seed).uniform(150, 700, 3).tolist()
    found = tl.simulate(scene(lengths, friction=friction, tol=3e-3), envelope=True)
    exact = tl.simulate(scene(lengths, friction=friction, rounded=False, tol=1e-5), envelope=True).envelope
    assert found.accuracy.met
    seen, weight = found.envelope, 3e-3 * found.envelope.highest.max()
    assert np.abs(seen.highest - exact.highest).max() < weight
    assert np.abs(seen.lowest - exact.lowest).max() < weight


def test_pipes_shorter_than_a_slab_are_one_slab_long():
    given = scene([200, 300, 1], slab=0.02)
    assert tl.simulate(given, record=["c"]).lines["c"].delay == pytest.approx(0.02)
    with pytest.raises(tl.SceneError, match=r"solver\.order: delays are rounded in the first order alone, expected 1"):
        scene([200, 300, 1], order=3)


def test_what_the_time_leaves_is_told():
    found = tl.simulate(scene([211, 307, 401], tol=1e-9), seconds=1e-3)
    assert not found.accuracy.met
    assert found.accuracy.limit == "a finer run would take the total beyond 0.001 s"
    assert 1e-9 < found.accuracy.worst < 0.1


NS, SAMPLES, TRANSFORMED = 1e-9, 1 << 20, 1e-5  # the last: error of transforms at corners
PULSE = (0.5 * NS, 0.3 * NS, 3 * NS)  # begin, rise and fall, width
T_END, SOURCE = 15 * NS, 50.0


def transforms() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Instants, s, and the trapezoid there; what the transform wraps around is exp(-25) of itself."""
    period, damping = 2 * T_END, 12.5 / T_END
    s = damping + 2j * np.pi * np.fft.rfftfreq(SAMPLES, period / SAMPLES)
    begin, rise, width = PULSE
    corners = np.exp(-s * begin) - np.exp(-s * (begin + rise))
    return np.arange(SAMPLES) * period / SAMPLES, s, corners * (1 - np.exp(-s * (rise + width))) / (s * s * rise)


def seen(transform: np.ndarray) -> np.ndarray:
    """A transform over time."""
    t = np.arange(SAMPLES) * 2 * T_END / SAMPLES
    return np.fft.irfft(transform, SAMPLES) * SAMPLES / (2 * T_END) * np.exp(12.5 / T_END * t)


def own_and_other(s: np.ndarray, z: np.ndarray, y: np.ndarray, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Admittances of a line with z and y per metre, seen from one end and from end to end."""
    through, yc = np.exp(-np.sqrt(z) * np.sqrt(y) * length), np.sqrt(y) / np.sqrt(z)
    return yc * (1 + through**2) / (1 - through**2), -2 * yc * through / (1 - through**2)


def driver(at: str) -> dict:
    begin, rise, width = PULSE
    value = {"shape": "pulses", "high": 1, "at": begin, "rise": rise, "fall": rise, "width": width}
    return {"at": at, "kind": "voltage", "resistance": SOURCE, "value": value}


L, M, C, K, R, LENGTH = 3e-7, 6e-8, 1.1e-10, 2e-11, 20.0, 0.3  # of two conductors alike
PAIR = Scene(
    medium="electrical", t_end=T_END,
    lines={"pair": {
        "nodes1": ["a1", "a2"], "nodes2": ["b1", "b2"], "length": LENGTH, "inductance": [[L, M], [M, L]],
        "capacitance": [[C, -K], [-K, C]], "resistance": [[R, 0], [0, R]],
    }},
    sources={"s": driver("a1")},
    loads={at: {"at": at, "kind": "resistor", "resistance": SOURCE} for at in ("a2", "b1", "b2")},
    probes={at: {"at": at} for at in ("a2", "b1", "b2")},
)  # fmt: skip


def exact_pair() -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Half the sum and difference of what two lines do."""
    t, s, given = transforms()
    found = []
    for inductance, capacitance in ((L + M, C - K), (L - M, C + K)):
        own, other = own_and_other(s, R + s * inductance, s * capacitance, LENGTH)
        own = own + 1 / SOURCE
        near = given / SOURCE * own / (own**2 - other**2)
        found.append((near, -other / own * near))
    (even, even_far), (odd, odd_far) = found
    ends = {"a2": even - odd, "b1": even_far + odd_far, "b2": even_far - odd_far}
    return t, {name: seen(end / 2) for name, end in ends.items()}


LINES = ((2.9e-7, 1.0e-10, 12.0, 1e-3, 0.21), (1.7e-7, 1.4e-10, 60.0, 0.0, 0.37))  # per metre: L, C, R, G; length
KEYS = ("inductance", "capacitance", "resistance", "conductance", "length")
CHAIN = Scene(
    medium="electrical", t_end=T_END,
    lines={
        f"l{k}": {"nodes": [f"n{k}", f"n{k + 1}"]} | {key: x for key, x in zip(KEYS, line, strict=True) if x}
        for k, line in enumerate(LINES)
    },
    sources={"s": driver("n0")},
    loads={"joint": {"at": "n1", "kind": "resistor", "resistance": 200}},
    probes={f"n{k}": {"at": f"n{k}"} | ({"line": "l0"} if k == 1 else {}) for k in range(3)},
)  # fmt: skip


def exact_chain() -> tuple[np.ndarray, dict[str, np.ndarray]]:
    t, s, given = transforms()
    Y = np.zeros((len(s), 3, 3), complex)
    Y[:, 0, 0], Y[:, 1, 1] = 1 / SOURCE, 1 / 200
    for k, (inductance, capacitance, resistance, conductance, length) in enumerate(LINES):
        own, other = own_and_other(s, resistance + s * inductance, conductance + s * capacitance, length)
        Y[:, k, k] += own
        Y[:, k + 1, k + 1] += own
        Y[:, k, k + 1] += other
        Y[:, k + 1, k] += other
    driven = np.zeros((len(s), 3, 1), complex)
    driven[:, 0, 0] = given / SOURCE
    u = np.linalg.solve(Y, driven)[:, :, 0]
    return t, {f"n{k}": seen(u[:, k]) for k in range(3)}


@pytest.mark.parametrize(("scene", "exact", "tol"), [(PAIR, exact_pair, 1e-3), (CHAIN, exact_chain, 1e-4)])
def test_corners_that_come_at_any_instant_are_within_the_tolerance(scene, exact, tol):
    t, voltages = exact()
    result = tl.simulate(scene, tol=tol)
    assert result.accuracy.met
    chosen = np.random.default_rng(2).integers(1, SAMPLES // 2 - 1, 10_000)
    for name, u in voltages.items():
        error = np.abs(result.probes[name].at(t[chosen]).u - u[chosen]).max() / np.abs(u).max()
        assert error <= max(result.accuracy.inside[name].u, TRANSFORMED)
    assert sum(attempt.samples for attempt in result.accuracy.attempts) < 3e7
