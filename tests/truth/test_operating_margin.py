"""Channel operating margins: blocks against chain matrices, normal tails and draws, wholes against another program."""

import itertools

import mpmath as mp
import numpy as np
import pytest
from scipy.stats import norm

from passivity import SampledResponse
from tline import InputError
from tline.signal import clause, measured_channel, operating_margin
from tline.signal.margin import exceeded
from tline.signal.pulse import ctle, low_pass
from tline.signal.reference_receiver import Way, equalised, on_grid, sampled, transfer

KR4 = clause("100GBASE-KR4")
F = np.arange(1, 4001) * 1e7


def a_cable(f=F, length=0.4, swapped=False, crosstalk=0.0):
    """Two pairs, 1,3 to 2,4, of lossy lines of 95 ohm that do not couple, and what one hears of the other pair."""
    gamma = (2e-5 * (1 + 1j) * np.sqrt(f) + 2e-11 * f + 2j * np.pi * f * 6e-9) * length
    rho, e = -5 / 195, np.exp(-gamma)
    back, through = rho * (1 - e**2) / (1 - rho**2 * e**2), (1 - rho**2) * e / (1 - rho**2 * e**2)
    heard = crosstalk * 2j * np.pi * f * 2e-12 * through
    S = np.zeros((len(f), 4, 4), complex)
    for a, b in ((0, 1), (2, 3)):
        S[:, a, a] = S[:, b, b] = back
        S[:, a, b] = S[:, b, a] = heard if crosstalk else through
    order = [0, 2, 1, 3] if swapped else [0, 1, 2, 3]
    return SampledResponse(f, S[:, order][:, :, order], "S")


def given(**more):
    """KR4 with one package and one setting of equalisers, and changes of it."""
    one = {
        "package": KR4.table()["package"] | {"z_p": [["12 mm", "12 mm"]]},
        "g_DC": [-6, -6, 1],
        "ffe": {},
    }
    return clause({"base": "100GBASE-KR4"} | one | more)


def abcd_transfer(by, S, z0, f, lengths, boards=None):
    """2 V_2/E of packages, boards and a two-port between differential terminations, all chain matrices."""
    w, x, R = 2j * mp.pi * f, mp.mpf(f) / 10**9, 2 * mp.mpf(float(by.R_d))
    shunt = lambda C: mp.matrix([[1, 0], [w * mp.mpf(C) / 2, 1]])  # noqa: E731

    def line(of, length):
        slow = mp.mpf(of.a_2) * 10**6 * (1 - 2j / mp.pi * mp.log(x)) + 2j * mp.pi * mp.mpf(of.tau) * 10**6
        g = (mp.mpf(of.gamma_0) + mp.mpf(of.a_1) * (1 + 1j) * mp.sqrt(x) + slow * x) * mp.mpf(length) * 1000
        return mp.matrix([[mp.cosh(g), of.Z_c * mp.sinh(g)], [mp.sinh(g) / of.Z_c, mp.cosh(g)]])

    p = by.package
    sender = shunt(p.C_d) * line(p, lengths[0]) * shunt(p.C_p)
    receiver = shunt(p.C_p) * line(p, lengths[1]) * shunt(p.C_d)
    if boards:
        sender, receiver = sender * line(by.board, boards[0]), line(by.board, boards[1]) * receiver
    (a, b), (c, d) = [[mp.mpc(complex(v)) for v in row] for row in S]
    middle = mp.matrix([[(1 + a) * (1 - d) + b * c, z0 * ((1 + a) * (1 + d) - b * c)],
                        [((1 - a) * (1 - d) - b * c) / z0, (1 - a) * (1 + d) + b * c]]) / (2 * c)  # fmt: skip
    M = sender * middle * receiver
    return complex(2 / (M[0, 0] + M[0, 1] / R + R * M[1, 0] + M[1, 1]))


@pytest.mark.parametrize("name", ["100GBASE-KR4", "100GBASE-CR4", "200GAUI-4"])
@pytest.mark.parametrize("kind", ["tx", "next"])
def test_voltages_at_the_die_are_those_of_chain_matrices(name, kind):
    by, rng = clause(name), np.random.default_rng(4)
    f, S = np.array([1e8, 5e9, 14e9, 33e9]), rng.normal(size=(4, 2, 2, 2)) @ [0.3, 0.3j]
    S[:, 0, 1] = S[:, 1, 0]
    found = transfer(by, Way(kind, f, S, np.array([100.0, 100.0])), by.package.z_p[1])
    lengths = (0.012 if kind == "next" else 0.030, 0.030)
    boards = None if by.board is None else (0.072 if kind == "next" else 0.151, 0.151)
    exact = [abcd_transfer(by, S[k], 100, f[k], lengths, boards) for k in range(4)]
    assert found == pytest.approx(np.array(exact), rel=1e-9)


def test_voltages_do_not_depend_on_the_references():
    """The same network against 100 and 80 ohm at its ports, by scikit-rf."""
    skrf = pytest.importorskip("skrf")
    net = skrf.Network(f=F[:5], f_unit="Hz", s=a_cable(F[:5]).between([[0, 2], [1, 3]]).values[:, :2, :2], z0=100)
    by, case = given(), given().package.z_p[0]
    one = transfer(by, Way("tx", F[:5], net.s.copy(), np.array([100.0, 100.0])), case)
    net.renormalize([100, 80], s_def="power")
    assert transfer(by, Way("tx", F[:5], net.s, np.array([100.0, 80.0])), case) == pytest.approx(one, rel=1e-9)


def test_edges_rise_from_20_to_80_percent_in_their_time():
    by = given(T_r="20 ps")
    way = Way("tx", F, np.tile(np.eye(2)[::-1], (len(F), 1, 1)), np.array([100.0, 100.0]))
    shape = transfer(by, way, by.package.z_p[0]) / transfer(given(), way, by.package.z_p[0])
    t = np.linspace(-20e-12, 20e-12, 401)
    step = 0.5 + (np.real(shape) / (np.pi * F) * np.sin(2 * np.pi * F * t[:, None])).sum(axis=1) * 1e7
    inner = (step > 0.2) & (step < 0.8)
    assert np.ptp(t[inner]) == pytest.approx(20e-12, rel=0.01)


def test_filters_are_their_formulas():
    x = F / 20e9
    assert low_pass(20e9).at(F) == pytest.approx(1 / (1 - 3.414214 * x**2 + x**4 + 2.613126j * (x - x**3)), rel=1e-6)
    exact = (10**-0.3 + 1j * F / 6e9) / (1 + 1j * F / 6e9) / (1 + 1j * F / 25e9)
    assert ctle(-6, 6e9, 6e9, 25e9).at(F) == pytest.approx(exact, rel=1e-12)


def test_responses_between_samples_are_those_of_the_line():
    exact = lambda f: np.exp(-2j * np.pi * f * 3e-9 - 3e-11 * f) / (1 + 0.2 * np.exp(-2j * np.pi * f * 2e-9))  # noqa: E731
    grid = np.arange(0, 4000) * 0.97e7
    assert on_grid(F, exact(F), grid)[1:] == pytest.approx(exact(grid)[1:], abs=1e-5)
    assert on_grid(F[4:], exact(F[4:]), grid) == pytest.approx(exact(grid), abs=2e-3)  # its loss has a cusp at rest


@pytest.mark.parametrize("symbols", [2, 4])
@pytest.mark.parametrize("rate", [1e-3, 1e-9])
def test_disturbance_is_that_of_all_patterns(symbols, rate):
    """Six symbols, with the normal tail of each pattern; 3,000 small ones beside them are noise."""
    rng = np.random.default_rng(7)
    h, small, noise = rng.uniform(0.02, 0.1, 6), rng.uniform(0, 1e-4, 3000), 0.02
    levels = np.linspace(-1, 1, symbols)
    sums = np.array([*itertools.product(levels, repeat=6)]) @ h
    spread = np.hypot(noise, np.linalg.norm(small) * np.std(levels))
    found = exceeded(np.concatenate([h, small]), noise, symbols, rate)
    assert np.mean(norm.sf((found - sums) / spread)) == pytest.approx(rate, rel=0.02)


def tail(x, h, noise, symbols):
    """P(sum > x) by J. Gil-Pelaez, 1/2 - 1/pi of the integral of sin(wx) phi(w)/w, phi the characteristic function."""
    levels, sd = np.linspace(-1, 1, symbols), np.hypot(noise, np.linalg.norm(h))
    w = (np.arange(int(90 * sd / noise)) + 0.5) * 0.1 / sd
    phi = np.exp(-((noise * w) ** 2) / 2)
    for each in h:
        phi *= np.cos(np.outer(levels, w * each)).mean(axis=0)
    return 0.5 - float((np.sin(w * x) * phi / w).sum()) * 0.1 / sd / np.pi


MANY = np.abs(np.random.default_rng(3).normal(size=4000)) * 1e-3


@pytest.mark.parametrize("symbols", [2, 4])
@pytest.mark.parametrize("rate", [1e-5, 1e-9])
@pytest.mark.parametrize(
    ("h", "noise"),
    [(np.full(5000, 1.001e-4), 0.01), (np.full(3000, 1.5e-4), 0.01), (MANY, 0.02), (np.append(MANY, 0.2), 0.01)],
)
def test_many_cursors_smaller_than_a_level_disturb_as_their_law(h, noise, rate, symbols):
    assert tail(exceeded(h, noise, symbols, rate), h, noise, symbols) == pytest.approx(rate, rel=0.02)


def test_nothing_disturbs_by_nothing():
    assert exceeded(np.zeros(3), 0.0, 2, 1e-5) == 0


def test_a_base_has_the_rest_of_packages_and_boards(tmp_path):
    by = clause({"base": "100GBASE-CR4", "package": {"Z_c": "85 ohm"}, "board": {"z_tx": "0.1 m"}})
    assert by.board is not None
    assert (by.package.Z_c, by.package.C_d, by.board.z_tx, by.board.Z_c) == (85, 250e-15, 0.1, 109.8)
    file = tmp_path / "pairs.json"
    file.write_text("[[1, 2]]")
    with pytest.raises(InputError, match="is no table in JSON"):
        clause(file)


def test_noise_alone_is_normal():
    for rate in (1e-3, 1e-12):
        assert exceeded(np.zeros(3), 0.7, 2, rate) == pytest.approx(0.7 * norm.isf(rate), rel=1e-3)


def test_a_million_draws_exceed_it_as_often():
    rng, h = np.random.default_rng(9), np.array([0.3, 0.11, 0.07, 0.02, 0.013])
    sums = rng.choice([-1, -1 / 3, 1 / 3, 1], size=(1_000_000, 5)) @ h + 0.05 * rng.normal(size=1_000_000)
    assert (sums > exceeded(h, 0.05, 4, 1e-2)).mean() == pytest.approx(1e-2, abs=4e-4)


def test_without_echoes_it_is_the_tail_of_noise():
    """As much feedback as there are echoes, no jitter: 20 log(A_s/(sigma Q^-1(DER)))."""
    by = given(N_b=60, sigma_RJ=0, A_DD=0, DER_0=1e-5, eta_0="1e-6 V^2/GHz", SNR_TX=20)
    seen = operating_margin(a_cable(length=0.05), by, "1,3 2,4")
    rest = seen.sigmas["intersymbol interference"]
    noise = np.hypot(seen.sigmas["sender's noise"], seen.sigmas["receiver's noise"])
    assert rest < 0.05 * noise
    assert seen.sigmas["sender's noise"] == pytest.approx(seen.signal / 10, rel=1e-12)
    exact = 20 * np.log10(seen.signal / (np.hypot(noise, rest) * norm.isf(1e-5)))
    assert seen.margin == pytest.approx(exact, abs=0.02)


def test_sampling_balances_the_cursors_around():
    """(1 - cos)/2 over two symbols is symmetric: without feedback at its middle; with much, where nothing is before."""
    t = np.arange(-6, 8, 1 / 32)
    pulse = np.where(np.abs(t) < 1, (1 + np.cos(np.pi * t)) / 2, 0.0)[None]
    assert t[sampled(given(N_b=0), pulse, 320)[0]] == pytest.approx(0, abs=1 / 32)
    half = t[sampled(given(N_b=1, b_max=[0.25]), pulse, 320)[0]]
    before, at, after = np.interp(half + np.array([-1.0, 0.0, 1.0]), t, pulse[0])
    assert before == pytest.approx(after - 0.25 * at, abs=0.06)


def test_the_search_is_as_good_as_each_setting_by_itself():
    """Every setting of taps and gains alone, its figure of merit from the standard deviations told."""
    by = given(
        g_DC=[-8, -4, 4], ffe={"c(-1)": [-0.1, 0, 0.05], "c(1)": [-0.2, 0, 0.2]}, delta_f="100 MHz", L=4, R_LM=0.95
    )
    far, near = a_cable(crosstalk=1.0), a_cable(crosstalk=2.0)
    best = operating_margin(a_cable(), by, "1,3 2,4", fext=[far], near=[near])
    merits = {}
    for gain, before, after in itertools.product((-8, -4), (-0.1, -0.05, 0), (-0.2, 0)):
        ranges = {"c(-1)": [before, before, 1], "c(1)": [after, after, 1]}
        if 1 + before + after < 0.62 - 1e-9:
            continue
        alone = by.table() | {"g_DC": [gain, gain, 1], "ffe": ranges}
        seen = operating_margin(a_cable(), alone, "1,3 2,4", fext=[far], near=[near])
        merits[gain, before, after] = seen.signal**2 / sum(x**2 for x in seen.sigmas.values())
    gain, before, after = max(merits, key=merits.__getitem__)
    assert best.best.merit == pytest.approx(merits[gain, before, after], rel=1e-6)
    assert (best.best.gains[0], *best.best.taps[[0, 2]]) == pytest.approx((gain, before, after))


KNOWN = {  # of PyChOpMarg 3.4.0 for these samples, with 30 mm of package, 12 mm at NEXT, its samples taken at (93A-25)
    "100GBASE-KR4": ((-6.0, 0.0), 7.4627, 74.4965e-3, 31.55e-3,
                     [2.55998e-3, 7.11275e-3, 0.691457e-3, 3.32763e-3, 0.759908e-3], [0.1085, 0.0194, 0.0310]),
    "200GAUI-4": ((-6.0, -2.0), 0.1429, 24.4795e-3, 24.08e-3,
                  [2.89824e-3, 5.67349e-3, 0.463559e-3, 2.17872e-3, 0.553477e-3], [0.0611, 0.0476, 0.0328]),
}  # fmt: skip


@pytest.mark.parametrize("name", [*KNOWN])
def test_whole_margins_are_those_of_another_program(name):
    """PyChOpMarg takes levels 10 µV apart, and leaves out cursors below a thousandth of the signal."""
    gains, margin, signal, disturbance, sigmas, dfe = KNOWN[name]
    f = np.arange(0, 5001) * 1e7
    package = clause(name).table()["package"] | {"z_p": [["30 mm", "12 mm"]]}
    one = {"ffe": {"c(-1)": [-0.1, -0.1, 1], "c(1)": [-0.1, -0.1, 1]}, "package": package, "base": name}
    one |= {key: [gain, gain, 1] for key, gain in zip(("g_DC", "g_DC2"), gains, strict=True)}
    far, near = a_cable(f, crosstalk=0.25), a_cable(f, crosstalk=0.5)
    seen = operating_margin(a_cable(f), one, "1,3 2,4", fext=[far], near=[near])
    assert seen.margin == pytest.approx(margin, abs=0.03)
    assert seen.signal == pytest.approx(signal, rel=1e-4)
    assert seen.disturbance == pytest.approx(disturbance, rel=4e-3)
    parts = "intersymbol interference", "crosstalk", "random jitter", "sender's noise", "receiver's noise"
    assert [seen.sigmas[part] for part in parts] == pytest.approx(sigmas, rel=4e-3)
    assert seen.dfe[:3] == pytest.approx(dfe, abs=1e-4)


def test_a_pulse_is_the_integral_over_its_spectrum():
    """Over a finer grid, by a sum, with the filters' own formulas."""
    by, f = given(), np.arange(1, 16001) * 2.5e6
    way = Way("tx", f, a_cable(f).between([[0, 2], [1, 3]]).values[:, :2, :2], np.array([100.0, 100.0]))
    pulse = equalised(by, [way], by.package.z_p[0]).pulses[0]
    rate, x = float(by.f_b), f / 0.75 / float(by.f_b)
    H = transfer(by, way, by.package.z_p[0]) / (1 - 3.414214 * x**2 + x**4 + 2.613126j * (x - x**3))
    H = H * (10**-0.3 + 4j * f / rate) / (1 + 4j * f / rate) / (1 + 1j * f / rate)
    t = np.arange(2200, 2500, 20) / 32 / rate
    turned = H * np.sinc(f / rate) * np.exp(2j * np.pi * f * t[:, None])
    exact = 2 * 0.4 / rate * 2.5e6 * (np.real(turned).sum(axis=1) + 0.5 * np.abs(H[0]))
    assert pulse.ravel()[2200:2500:20] == pytest.approx(exact, abs=3e-4 * np.abs(exact).max())


def test_ports_in_any_order_and_neighbours_in_one_file():
    by = given(delta_f="40 MHz")
    one = operating_margin(a_cable(), by, "1,3 2,4").margin
    assert operating_margin(a_cable(swapped=True), by, "1,2 3,4").margin == pytest.approx(one, rel=1e-12)
    assert (
        operating_margin(a_cable(F[500:]), by, "1,3 2,4").lacking[0].startswith("are 5.01e+09 Hz apart, or from rest")
    )
    lacking = operating_margin(a_cable(F[:2000:4]), given(), "1,3 2,4").lacking
    assert [each.partition(",")[0] for each in lacking] == ["end at 1.997e+10 Hz", "are 4e+07 Hz apart"]
    f = F[::4]
    both = np.zeros((len(f), 6, 6), complex)
    both[:, :4, :4] = a_cable(f).values
    for victim, other in ((1, 4), (3, 5)):
        both[:, victim, other] = both[:, other, victim] = a_cable(f, crosstalk=1.0).values[:, 0, 1]
    apart = a_cable(f, crosstalk=1.0).values.copy()
    apart[:, [0, 2], [0, 2]] = 0.0
    apart = SampledResponse(f, apart, "S")
    for near in ((), ("5,6",)):
        files = {"near": [apart]} if near else {"fext": [apart]}
        seen = operating_margin(SampledResponse(f, both, "S"), by, "1,3 2,4 5,6", near=near)
        exact = operating_margin(a_cable(f), by, "1,3 2,4", **files)
        assert seen.margin == pytest.approx(exact.margin, abs=1e-9)
        assert seen.margin < one - 0.1


def test_what_is_refused():
    for more, said in (
        ({"L": 1, "f_zz": 0.5}, "Clause.L: .*\nClause.f_zz: unknown key"),
        ({"ffe": {"c(0)": [0, 0, 1]}}, "Clause.ffe: not a tap beside the main one"),
        ({"ffe": {"c(1)": [-0.9, -0.8, 0.1]}}, "Clause.c_0: larger than the main tap"),
        ({"g_DC": [0, -3, 1]}, "Clause.g_DC: not a range"),
        ({"f_p": [], "b_max": []}, "Clause.f_p: too few.*\nClause.b_max: too few"),
        ({"g_DC2": [-4, 0, 1]}, "Clause.f_LF: is missing"),
        ({"b_max": [0.5] * 15}, "Clause.b_max: longer than the feedback"),
        ({"R_LM": 0}, "Clause.R_LM: ratio of level mismatch out of range"),
        ({"package": {"gamma_0": 100}}, "Clause.package.gamma_0: attenuation out of range"),
        ({"package": {"a_2": "6.141e-3 s/m"}}, "Clause.package.a_2: time per length out of range"),
        ({"M": 128, "N_b": 200, "ffe": {f"c({k})": [-0.1, 0, 3e-3] for k in (-2, -1, 1)}}, "too many settings, .*3,6"),
        ({"g_DC": [-12, 0, 0.1], "g_DC2": [-4, 0, 0.02], "f_LF": 0.02}, "Clause.g_DC2: too many settings with"),
        ({"package": {"gamma_0": 1, "a_1": 1, "a_2": 1e-6, "tau": 1e-6}}, "ports: .*the sender arrives"),
        ({"delta_f": "1 kHz"}, "Clause.delta_f: frequency out of range"),
        ({"base": "KR4"}, "clause: not known, expected one of '100GBASE-KR4'"),
    ):
        with pytest.raises(InputError, match=said):
            operating_margin(a_cable(), given(**more) if "base" not in more else more, "1,3 2,4")
    with pytest.raises(InputError, match="too few samples for a margin, expected four and more, up to 1"):
        operating_margin(a_cable(F[:1000]), KR4, "1,3 2,4")
    with pytest.raises(InputError, match="ports: single ports beside pairs"):
        operating_margin(a_cable(), KR4, "1,3 2")
    with pytest.raises(InputError, match="fext: not single ports and pairs"):
        operating_margin(a_cable(), KR4, "1,3 2,4", fext=[a_cable().between([[0, 2]])])
    with pytest.raises(InputError, match="ports: nothing of the sender arrives"):
        operating_margin(SampledResponse(F, np.zeros((len(F), 4, 4)), "S"), given(), "1,3 2,4")
    with pytest.raises(InputError, match="ports: the sender arrives inverted"):
        operating_margin(a_cable(), KR4, "3,1 2,4")
    with pytest.raises(InputError, match="file: samples of Z, expected S"):
        measured_channel(SampledResponse(F, np.ones((len(F), 2, 2)), "Z"))
