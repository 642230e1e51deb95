"""Touchstone files, as read and as loads, against matrices of networks that are known."""

import numpy as np
import pytest
from touchstone_files import ANTENNA, SHIPPED, behind_cable, frequencies, write, write_antenna

from passivity import RationalFunction, Status, check_samples, read_touchstone
from tline import Scene, simulate
from tline.frequency import DelaySystem, resonances, respond

F = np.array([1e6, 2e6, 5e6])
S = 2j * np.pi * F
# impedances of a tee: 30 ohm, 20 ohm + 2 uH, and 5 nF between
Z = np.stack([[30 + 1 / (5e-9 * s) * np.array([1, 1]), 1 / (5e-9 * s) * np.array([1, 1])] for s in S])
Z[:, 0, 0], Z[:, 1, 1] = 30 + 1 / (5e-9 * S), 20 + 2e-6 * S + 1 / (5e-9 * S)
Z[:, 0, 1] = Z[:, 1, 0] = 1 / (5e-9 * S)


def of_power(z0):
    """Of power waves (Kurokawa 1965) with references z0, shape (2,) or (n, 2)."""
    z0 = np.broadcast_to(z0, (len(F), 2)).astype(complex)
    root = np.sqrt(z0.real)
    Z0 = z0[:, :, None] * np.eye(2)
    return (Z - Z0.conj()) @ np.linalg.inv(Z + Z0) * root[:, None, :] / root[:, :, None]


def text(matrix, digits=12):
    return [" ".join(f"{x.real:.{digits}g} {x.imag:.{digits}g}" for x in row) for row in matrix]


def lines(values, order=((0, 0), (1, 0), (0, 1), (1, 1))):
    return [f"{f:g} " + " ".join(text([[s[i, k] for i, k in order]])) for f, s in zip(F, values, strict=True)]


def read(tmp_path, name, *rows):
    (tmp_path / name).write_text("\n".join(rows) + "\n")
    return read_touchstone(tmp_path / name)


def test_version_2_is_read_like_version_1(tmp_path):
    values = of_power(50)
    one = read(tmp_path, "a.s2p", "# Hz S RI R 50", *lines(values))
    head = "[Version] 2.0", "# Hz S RI R 50", "[Number of Ports] 2"
    plain = read(
        tmp_path,
        "a.ts",
        *head,
        "[Two-Port Data Order] 12_21",
        "[Network Data]",
        *lines(values, ((0, 0), (0, 1), (1, 0), (1, 1))),
        "[End]",
    )
    lower = read(
        tmp_path,
        "b.ts",
        *head,
        "[Two-Port Data Order] 12_21",
        "[Matrix Format] Lower",
        "[Network Data]",
        *lines(values, ((0, 0), (1, 0), (1, 1))),
        "[End]",
    )
    upper = read(
        tmp_path,
        "c.ts",
        *head,
        "[Two-Port Data Order] 12_21",
        "[Matrix Format] Upper",
        "[Network Data]",
        *lines(values, ((0, 0), (0, 1), (1, 1))),
        "[End]",
    )
    for found in (one, plain, lower, upper):
        assert found.z0.tolist() == [50, 50]
        np.testing.assert_allclose(found.values, values, atol=1e-11)
        np.testing.assert_allclose(found.rounding.along, one.rounding.along, rtol=1e-9)


def test_references_of_version_2_are_each_port_s(tmp_path):
    values = of_power([50, 75])
    found = read(
        tmp_path,
        "a.ts",
        "[Version] 2.0",
        "# Hz S RI R 50",
        "[Number of Ports] 2",
        "[Two-Port Data Order] 21_12",
        "[Reference] 50 75",
        "[Network Data]",
        *lines(values),
        "[End]",
    )
    assert found.z0.tolist() == [50, 75]
    np.testing.assert_allclose(found.values, values, atol=1e-11)


def test_impedances_of_version_2_are_in_ohm(tmp_path):
    found = read(
        tmp_path,
        "a.ts",
        "[Version] 2.0",
        "# Hz Z RI R 50",
        "[Number of Ports] 2",
        "[Two-Port Data Order] 21_12",
        "[Reference] 50 75",
        "[Network Data]",
        *lines(Z),
        "[End]",
    )
    np.testing.assert_allclose(found.values, of_power([50, 75]), atol=1e-9)


@pytest.mark.parametrize("z0", [[50 - 5j, 50 - 5j], [[40 + 3j, 60], [41 + 2j, 61], [42, 62 - 9j]]])
def test_complex_and_changing_references_become_one_resistance(tmp_path, z0):
    z0 = np.broadcast_to(z0, (3, 2)).astype(complex)
    ports = [" ".join(f"{z.real:g} {z.imag:g}" for z in row) for row in z0]
    rows = [x for s, port in zip(lines(of_power(z0)), ports, strict=True) for x in (s, f"! Port Impedance {port}")]
    found = read(tmp_path, "a.s2p", "! S-parameter uses the power definition", "# Hz S RI R 50", *rows)
    assert found.z0.tolist() == [50, 50]
    np.testing.assert_allclose(found.values, of_power(50), atol=1e-10)


@pytest.mark.parametrize("digits", [2, 3, 5])
def test_rounded_digits_of_a_lossless_network_refute_nothing(tmp_path, digits):
    rng, z0 = np.random.default_rng(digits), np.array([35 + 20j, 90 - 10j])
    x = rng.normal(size=(40, 2, 2)) * 50
    z, root = 1j * (x + x.swapaxes(1, 2)), np.sqrt(z0.real)
    s = (z - np.diag(z0.conj())) @ np.linalg.inv(z + np.diag(z0)) * root[None, None, :] / root[None, :, None]
    order = ((0, 0), (1, 0), (0, 1), (1, 1))
    rows = [
        x
        for k, m in enumerate(s)
        for x in (f"{k + 1} " + text([[m[i, j] for i, j in order]], digits)[0], "! Port Impedance 35 20 90 -10")
    ]
    found = read(tmp_path, "a.s2p", "! S-parameter uses the power definition", "# Hz S RI R 50", *rows)
    verdict = check_samples(found)
    assert verdict.status is Status.NO_VIOLATION
    # most bars are of the size of the digits, so what is truly active is still seen
    assert np.median(verdict.bars) < 4 * 10.0**-digits


MODES = "D1,2 D3,4 C1,2 C3,4", "C3,4 D2,1 S5 C1,2 D3,4"


@pytest.mark.parametrize("parameter", "SZY")
@pytest.mark.parametrize("modes", MODES)
def test_mixed_modes_are_turned_into_ports(tmp_path, modes, parameter):
    words = modes.split()
    p, rng = len(words), np.random.default_rng(7)
    Z = rng.normal(size=(p, p)) + 1j * rng.normal(size=(p, p)) + 5 * np.eye(p)
    u, i = np.zeros((2, p, p))  # modes' voltages u1 - u2, (u1 + u2)/2 and currents (i1 - i2)/2, i1 + i2
    for k, word in enumerate(words):
        ports = [int(x) - 1 for x in word[1:].split(",")]
        signs = {"S": [1], "C": [1, 1], "D": [1, -1]}[word[0]]
        u[k, ports] = np.array(signs) / (2 if word[0] == "C" else 1)
        i[k, ports] = np.array(signs) / (2 if word[0] == "D" else 1)
    z0 = np.array([50.0, 50, 30, 30, 75])[:p]
    references = np.array([{"S": 1, "C": 0.5, "D": 2}[word[0]] * z0[int(word[1]) - 1] for word in words])
    mixed, root = u @ Z @ np.linalg.inv(i), np.sqrt(references)
    S = (mixed - np.diag(references)) @ np.linalg.inv(mixed + np.diag(references)) * root / root[:, None]
    head = "[Version] 2.0", f"# Hz {parameter} RI R 50", f"[Number of Ports] {p}", "[Reference] 50"
    rest = *(f"{z:g}" for z in z0[1:]), f"[Mixed-Mode Order] {modes}", "[Network Data]", "1e6"
    found = read(tmp_path, "a.ts", *head, *rest, *text({"S": S, "Z": mixed, "Y": np.linalg.inv(mixed)}[parameter]))
    root = np.sqrt(z0)
    expected = (Z - np.diag(z0)) @ np.linalg.inv(Z + np.diag(z0)) * root / root[:, None]
    np.testing.assert_allclose(found.values[0], expected, atol=1e-10)
    np.testing.assert_allclose(found.z0, z0)


def test_mixed_modes_are_those_of_scikit_rf(tmp_path):
    skrf = pytest.importorskip("skrf")
    rng = np.random.default_rng(3)
    s = 0.3 * (rng.normal(size=(1, 4, 4)) + 1j * rng.normal(size=(1, 4, 4)))
    network = skrf.Network(f=[1], f_unit="Hz", s=s, z0=50)
    network.se2gmm(p=2)
    head = "[Version] 2.0", "# Hz S RI R 50", "[Number of Ports] 4", f"[Mixed-Mode Order] {MODES[0]}"
    found = read(tmp_path, "a.ts", *head, "[Network Data]", "1", *text(network.s[0]))
    np.testing.assert_allclose(found.values, s, atol=1e-10)


@pytest.mark.parametrize("waves", ["power", "pseudo", "traveling"])
def test_complex_references_of_all_waves_are_renormalised_as_by_scikit_rf(tmp_path, waves):
    network = pytest.importorskip("skrf.network")
    z0 = np.array([[40 + 30j, 60 - 20j]])
    s = np.array([[[0.2 + 0.1j, 0.5], [-0.4j, 0.3]]])
    full = "40 30 1 2\n! 3 4 60 -20"  # all the matrix, in two lines
    comments = f"! S-parameter uses the {waves} definition", "# Hz S RI R 75"
    rows = " ".join(text([s[0].T.ravel()])), f"! Port Impedance {full}"
    found = read(tmp_path, "a.s2p", *comments, "1 " + rows[0], "! Gamma 1 2 3", "! 4 5 6", rows[1])
    expected = network.renormalize_s(s, z0, 75, s_def="power", s_def_old=waves)
    np.testing.assert_allclose(found.values, expected, atol=1e-10)
    # the digits of one entry: what is left open grows by the slope of the closed form
    step = 1e-7
    for k in np.ndindex(2, 2):
        moved = s.copy()
        moved[0][k] += step
        slope = (network.renormalize_s(moved, z0, 75, s_def="power", s_def_old=waves) - expected)[0] / step
        own = np.outer(found.rounding.left[0][:, k[0]], found.rounding.right[0][k[1]])
        np.testing.assert_allclose(own, slope, atol=1e-6)


def test_free_layout_and_noise(tmp_path):
    values = of_power(50)
    rows = "\r\n".join(line.replace(" ", "\t", 1) + " ! 1 2 3" for line in lines(values))
    for noise in ("1e6 2 0.3 10 0.5", "4e6 2 0.3 10 0.5\r\n6e6 2 0.3 10 0.5"):
        found = read(tmp_path, "a.s2p", "! é", "#\tr 50 ri\ts hZ ! here", rows, "! noise", noise)
        np.testing.assert_allclose(found.values, values, atol=1e-11)
    order = "[two-port  data order] 21_12", "[Begin Information]", "[Reference] ?", "[End Information]"
    body = [x for f, numbers in (line.split(" ", 1) for line in lines(values)) for x in (f, numbers)]
    start = "[Version]\t2.1 ! c", "# Hz S RI", "[Number of Ports]  2 ! c", *order, "[NETWORK DATA]"
    found = read(tmp_path, "a.ts", *start, *body, "[Noise Data]", "1e6 2 0.3 10 0.5", "[End]")
    np.testing.assert_allclose(found.values, values, atol=1e-11)


R1, R2, C, T, TF = 20.0, 200.0, 4e-12, 1e-9, 0.31e-9


def scene(load, source=50, **tables):
    return Scene(
        str(tables.pop("folder", ".")),
        medium="electrical",
        t_end="12 ns",
        lines={"cable": {"nodes": ["near", "far"], "z0": 50, "delay": T}, **tables},
        sources={"s": {"at": "near", "kind": "voltage", "value": {"shape": "step", "to": 1}, "resistance": source}},
        loads={"one": load},
        probes={"far": {"at": "far", "line": "cable"}},
    )


@pytest.mark.parametrize("feed", [0.0, TF])
def test_a_step_into_a_measured_rc(tmp_path, feed):
    """R1 + (R2 beside C) from a matched source: one exponential, in closed form, behind twice the feed's delay."""
    f = frequencies()
    write(tmp_path / "rc.s1p", f, behind_cable(f"{R1} + 1/(1/{R2} + s*{C!r})", f, feed))
    load = {"at": "far", "kind": "touchstone", "file": "rc.s1p", "tolerance": 1e-9}
    made = scene(load, folder=tmp_path)
    found = made.loads["one"].model
    assert found.order == 1
    assert found.delay == pytest.approx(feed, rel=1e-9)
    seen = simulate(made, tol=1e-10).probes["far"]
    t = seen.t  # slab ends, where a run is as exact as asked
    tau = C * R2 * (50 + R1) / (50 + R1 + R2)
    late = t - T - 2 * feed
    i = 1 / (50 + R1 + R2) + (1 / (50 + R1) - 1 / (50 + R1 + R2)) * np.exp(-np.maximum(late, 0) / tau)
    exact = np.where(late > 0, 1 - 50 * i, np.where(t > T, 0.5, 0.0))
    away = (np.abs(late) > 1e-15) & (np.abs(t - T) > 1e-15)
    # |ΔS| <= 1e-9, and a matched source sends nothing back
    assert np.abs(seen.u - exact)[away].max() < 1e-9


@pytest.mark.parametrize("feed", [0.0, TF])
def test_a_measured_network_does_what_the_network_does(tmp_path, feed):
    f = frequencies()
    write(tmp_path / "antenna.s1p", f, behind_cable(ANTENNA, f, feed))
    file = {"at": "far", "kind": "touchstone", "file": "antenna.s1p", "tolerance": 1e-9}
    measured = scene(file, source=10, folder=tmp_path)
    lines = {"feed": {"nodes": ["far", "end"], "z0": 50, "delay": feed}} if feed else {}
    known = scene({"at": "end" if feed else "far", "kind": "impedance", "expression": ANTENNA}, source=10, **lines)
    t = np.linspace(0, 11.9e-9, 997)
    ours, theirs = (simulate(each, tol=1e-10).probes["far"].at(t) for each in (measured, known))
    assert np.abs(ours.u - theirs.u).max() < 1e-8
    assert np.abs(ours.y - theirs.y).max() < 1e-10
    late = [DelaySystem(each, "far").step([9e-9])[0] for each in (measured, known)]
    assert late[0] == pytest.approx(late[1], abs=1e-7)
    ours, theirs = ([mode.s for mode in resonances(each, 2e9)] for each in (measured, known))
    assert ours == pytest.approx(theirs, rel=1e-8)
    s = 2j * np.pi * f
    assert np.abs(respond(measured, s)["far"].u - respond(known, s)["far"].u).max() < 1e-8


def test_over_frequency_a_measured_load_reflects_as_its_file_says(tmp_path):
    f = frequencies()
    S = behind_cable(ANTENNA, f, TF)
    write(tmp_path / "antenna.s1p", f, S)
    load = {"at": "far", "kind": "touchstone", "file": "antenna.s1p", "tolerance": 1e-9}
    seen = respond(scene(load, folder=tmp_path), 2j * np.pi * f)["far"]
    assert np.abs(seen.b / seen.a - S).max() < 1e-9


def test_the_shipped_antenna_is_what_it_is_said_to_be(tmp_path):
    write_antenna(tmp_path / "again.s1p")
    assert (tmp_path / "again.s1p").read_text() == SHIPPED.read_text()
    load = {"at": "far", "kind": "touchstone", "file": str(SHIPPED)}
    found = scene(load).loads["one"].model
    assert (found.order, round(found.delay * 1e9, 4)) == (4, 0.7)
    Z, f = RationalFunction.from_expression(ANTENNA), frequencies(4e9, 50)
    exact = np.array([(Z(2j * np.pi * x) - 50) / (Z(2j * np.pi * x) + 50) for x in f])
    assert np.abs(found.model.at(2 * np.pi * f) - exact).max() < 2e-5  # five decimals
