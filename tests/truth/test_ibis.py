"""Drivers of IBIS files against the equations of the fictional part that its file was made from."""

import shutil

import ibis_files as part
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tline import Scene, simulate
from tline.scene.ibis.buffer import read_buffer
from tline.shipped import FOLDER
from tline.signal.eye_diagram import eye
from tline.study.programs import ngspice

NS = 1e-9
DRIVER = {"at": "pad", "kind": "ibis", "file": "memory.ibs", "model": "DQ", "package": False, "bit": "2 ns"}


def test_the_shipped_file_is_the_part_s():
    assert (FOLDER / "memory.ibs").read_text(encoding="utf-8") == part.file_text()


def driven(bits: str, corner: str, resistance: float, toward: float, **changed) -> Scene:
    """The driver into a resistance toward a voltage, behind a line without reflections."""
    return Scene(
        FOLDER,
        medium="electrical", t_end=4 * NS, start="steady", solver={"order": 4, "slab": "5 ps"},
        lines={"line": {"nodes": ["pad", "end"], "z0": resistance, "delay": "0.2 ns"}},
        sources={"fixture": {"at": "end", "kind": "voltage", "value": toward, "resistance": resistance}},
        loads={"driver": DRIVER | {"bits": bits, "corner": corner} | changed},
        probes={"pad": {"at": "pad"}},
    )  # fmt: skip


@pytest.mark.parametrize("corner", part.CORNERS)
@pytest.mark.parametrize("bits", ["01", "10"])
@pytest.mark.parametrize("high", [False, True])
def test_it_gives_back_the_waveforms_of_its_file(corner, bits, high):
    toward = part.SUPPLY[corner] if high else 0.0
    t, u = part.fixture(bits == "01", corner, 50.0, toward)
    seen = simulate(driven(bits, corner, 50.0, toward)).probes["pad"].at(2 * NS + t).u
    assert np.abs(seen - u).max() < 5e-3 * part.SUPPLY[corner]  # shares are drawn by cubics through few instants


@pytest.mark.parametrize("resistance", [25.0, 120.0])
def test_into_other_loads_it_does_what_its_transistors_do(resistance):
    t, u = part.fixture(True, "typ", resistance, 0.6)
    seen = simulate(driven("01", "typ", resistance, 0.6)).probes["pad"].at(2 * NS + t).u
    assert np.abs(seen - u).max() < 5e-3 * part.SUPPLY["typ"]


def test_ramps_alone_take_their_time(tmp_path):
    ramps_only = (FOLDER / "memory.ibs").read_text(encoding="utf-8").partition("[Rising Waveform]")[0]
    (tmp_path / "ramps.ibs").write_text(ramps_only + "[End]\n", encoding="utf-8")
    scene = driven("01", "typ", 50.0, 0.0, file=str(tmp_path / "ramps.ibs"))
    seen = simulate(scene).probes["pad"]
    t = np.linspace(2 * NS, 3 * NS, 2001)
    u = seen.at(t).u
    low, high = (u[0] + share * (u[-1] - u[0]) for share in (0.2, 0.8))
    t_true, u_true = part.fixture(True, "typ", 50.0, 0.0)
    between = np.subtract(*np.interp([u_true[0] + s * np.ptp(u_true) for s in (0.8, 0.2)], u_true, t_true))
    assert np.subtract(*np.interp([high, low], u, t)) == pytest.approx(
        between, rel=0.15
    )  # the die's own RC comes on top


def truth_of_the_net(bits: str, bit: float, t_end: float) -> tuple[np.ndarray, np.ndarray]:
    """Voltage of the receiver's die in scenes/ddr_ibis.toml by the part's equations, by the method of steps."""
    T, z0, (R1, L1, C1), (R2, L2, C2) = 0.4 * NS, 50.0, (0.13, 1e-9, 0.38e-12), (0.12, 0.9e-9, 0.35e-12)
    edges = [(k * bit, bits[k] == "1") for k in range(1, len(bits)) if bits[k] != bits[k - 1]]

    def up_down(t):
        at, rises = max((e for e in edges if e[0] <= t), default=(-1.0, bits[0] == "1"))
        return part.shares(t - at, rises, "typ")

    def rate(t, x, a, b):  # a toward the receiver, b toward the controller, as they arrive
        die, i, ball, far, j, end = x
        return [
            (-i - part.current(die, *up_down(t), "typ")) / part.CAPACITANCE["typ"],
            (die - ball - R1 * i) / L1,
            (i - (ball - b(t)) / z0) / C1,
            ((a(t) - far) / z0 - j) / C2,
            (far - end - R2 * j) / L2,
            (j - part.current(end, 0.0, 0.0, "typ")) / part.CAPACITANCE["typ"],
        ]

    x, done, ends = np.zeros(6), [], []
    a = b = lambda _: 0.0
    for k in range(round(t_end / T)):
        run = solve_ivp(
            rate, (k * T, (k + 1) * T), x, args=(a, b), dense_output=True, rtol=1e-8, atol=1e-10, max_step=T / 40
        )
        x, sol, last_a, last_b = run.y[:, -1], run.sol, a, b
        a = lambda t, s=sol, p=last_b: 2 * s(t - T)[2] - p(t - T)  # noqa: E731
        b = lambda t, s=sol, p=last_a: 2 * s(t - T)[3] - p(t - T)  # noqa: E731
        if k % 6 == 5:  # no recursion through all that was
            a, b = _sampled(a, (k + 1) * T, T), _sampled(b, (k + 1) * T, T)
        t = np.linspace(k * T, (k + 1) * T, 40, endpoint=False)
        done.append(t)
        ends.append(sol(t)[5])
    return np.concatenate(done), np.concatenate(ends)


def _sampled(f, begin, T):
    t = np.linspace(begin, begin + T, 2001)
    u = np.array([f(each) for each in t])
    return lambda at: np.interp(at, t, u)


def test_the_shipped_net_does_what_the_parts_equations_do():
    t, die = truth_of_the_net("0100110101", 1.2 * NS, 12 * NS)
    scene = Scene(FOLDER, **tables_of("ddr_ibis"))
    assert np.abs(simulate(scene).probes["die"].at(t).u - die).max() < 6e-3  # 0.5 % of the supply


@pytest.mark.skipif(shutil.which("ngspice") is None, reason="ngspice is not installed")
def test_the_shipped_net_in_ngspice():
    """The part by behavioural sources, not by the tables of its file."""
    bits, bit = "0100110101", 1.2 * NS
    edges = [(k * bit, bits[k] == "1") for k in range(1, len(bits)) if bits[k] != bits[k - 1]]
    points = {"up": ["0 0"], "down": ["0 1"]}
    for at, rises in edges:
        for t in np.linspace(0.04 * NS, 0.38 * NS, 69):
            for word, share in zip(("up", "down"), part.shares(t, rises, "typ"), strict=True):
                points[word].append(f"{at + t:.6e} {share:.6e}")
    clamp = "0.0016*ln(1+exp(min({}/0.04,60)))"
    ends = [clamp.format(f"(v({n})-1.75)") + "-" + clamp.format(f"(-v({n})-0.55)") for n in ("die", "end")]
    deck = [
        "* ddr", *(f"V{word} {word} 0 PWL({' '.join(each)})" for word, each in points.items()),
        f"B1 die 0 i=0.03*(v(down)*tanh(v(die)/1.02)-v(up)*tanh((1.2-v(die))/1.02))+{ends[0]}", "C1 die 0 1.3p",
        "R1 die x 0.13", "L1 x ball 1n", "C2 ball 0 0.38p", "T1 ball 0 far 0 Z0=50 TD=0.4n",
        "C3 far 0 0.35p", "R2 far y 0.12", "L2 y end 0.9n", "C4 end 0 1.3p", f"B2 end 0 i={ends[1]}",
        ".options acct reltol=1e-5", ".save v(end) v(ball)", ".tran 2p 12n 0 2p uic", ".end", "",
    ]  # fmt: skip
    waves, _, _ = ngspice.transient("\n".join(deck))
    seen = simulate(Scene(FOLDER, **tables_of("ddr_ibis"))).probes
    for name, wave in (("die", "v(end)"), ("ball", "v(ball)")):
        t = waves["time"][1:-1]
        assert np.abs(seen[name].at(t).u - waves[wave][1:-1]).max() < 6e-3


def tables_of(name: str) -> dict:
    import tomllib

    return tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8"))


def test_an_eye_of_it():
    scene = Scene(FOLDER, **tables_of("ddr_ibis"))
    seen = eye(scene, "die", "1.5 ns", bits="0010111")
    assert 1.0 < seen.height < 1.6


def test_another_parser_reads_the_same():
    ibis = pytest.importorskip("ecdtools.ibis")
    theirs = ibis.load_file(str(FOLDER / "memory.ibs"))
    model = theirs.get_model_by_name("DQ")
    for k, corner in enumerate(part.CORNERS, 1):
        ours = read_buffer(FOLDER / "memory.ibs", "DQ", None, None, corner)
        pull = [(float(row[0]), float(row[k])) for row in model.pulldown]
        assert np.allclose(np.array(pull).T, [ours.tables["pulldown"].volts, ours.tables["pulldown"].amps])
