"""Reference receiver of a channel operating margin: responses of all that send to it, and its best equalisers.

Pulse responses come of an inverse FFT. Behind the sender's taps their energies at each phase of sampling are quadratic
in these, so that a search has all settings of taps at once.

References
----------
IEEE Std 802.3-2022, annex 93A; equation numbers are those.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len
from scipy.interpolate import CubicSpline
from scipy.linalg import toeplitz

from tline.errors import InputError
from tline.signal.channel import mean_delay
from tline.signal.clauses import Clause
from tline.signal.density import power
from tline.signal.pulse import ctle, low_pass


class Way(NamedTuple):
    """From a sender, mode 0, to the receiver, mode 1; kind is "tx", "fext" or "next"."""

    kind: str
    f: NDArray
    S: NDArray  # (n, 2, 2)
    z0: NDArray
    title: str = ""  # of its file


class Equalised(NamedTuple):
    """Responses behind the best equalisers, the receiver's noise there, V, and the figure of merit."""

    merit: float  # power of signal over disturbance; (93A-36)
    gains: tuple[float, float]  # dB
    taps: NDArray
    at: int  # sample of the main cursor
    noise: float
    pulses: list[NDArray]  # (n, M) for each way, V


def transfer(given: Clause, way: Way, lengths: tuple[float, float]) -> NDArray:
    """Voltage at the receiver's die over half of the sender's, shape (n,); (93A-18), and (93A-46) of its edges.

    A sender is a source behind its package. Packages are reciprocal: a current into the receiver's makes at the die
    what a source there makes at the pads.
    """
    f, R, near = way.f, 2 * float(given.R_d), way.kind == "next"

    def device(end: str, length: float) -> tuple[NDArray, NDArray]:
        v, z = _beside(f, float(given.package.C_d), np.ones(len(f), complex), np.full(len(f), R, complex))
        v, z = _beside(f, float(given.package.C_p), *given.package.behind(f, length, v, z))
        return (v, z) if given.board is None else given.board.behind(f, float(getattr(given.board, f"z_{end}")), v, z)

    (v, z), (v_rx, z_rx) = device(way.kind, float(lengths[near])), device("rx", float(lengths[0]))
    (S11, S12), (S21, S22) = np.moveaxis(way.S, 0, 2)
    one, two = (z - way.z0[0]) / (z + way.z0[0]), (z_rx - way.z0[1]) / (z_rx + way.z0[1])
    around = (1 - S11 * one) * (1 - S22 * two) - S12 * S21 * one * two
    at_pads = v * (1 - one) * S21 * np.sqrt(way.z0[1] / way.z0[0]) * (1 + two) / around
    return at_pads * R * v_rx / z_rx * np.exp(-2 * (np.pi * f * float(given.T_r) / 1.6832) ** 2)


def _beside(f: NDArray, C: float, v: NDArray, z: NDArray) -> tuple[NDArray, NDArray]:
    """Open voltage and impedance of a source with a capacitor from each of its conductors to ground."""
    divided = 1 + 1j * np.pi * f * C * z
    return v / divided, z / divided


def on_grid(f: NDArray, H: NDArray, grid: NDArray) -> NDArray:
    """A response at other frequencies: a spline of what its delay leaves of it, conjugate at negative frequencies.

    Beyond its end its loss goes on.
    """
    late = mean_delay(f, H)
    left = H * np.exp(2j * np.pi * f * late)
    upper, within, mirrored = slice(len(f) // 2, None), np.minimum(grid, f[-1]), slice(int(f[0] == 0), None)
    slope = min(np.polyfit(f[upper], np.log(np.maximum(np.abs(left[upper]), 1e-12)), 1)[0], 0.0)
    both = CubicSpline(np.append(-f[mirrored][::-1], f), np.append(left[mirrored][::-1].conj(), left))
    return both(within) * np.exp(slope * (grid - within) - 2j * np.pi * grid * late)


def equalised(given: Clause, ways: list[Way], lengths: tuple[float, float]) -> Equalised:
    """Search all equalisers of a clause for the largest figure of merit, the sender's way being the first."""
    f_b, M = float(given.f_b), given.M
    n = next_fast_len(max(round(f_b / float(given.delta_f)), 4 * (given.N_b + 20)))
    grid, (taps, lead) = np.arange(n * M // 2 + 1) * f_b / n, given.taps
    amplitudes = {"tx": float(given.A_v), "fext": float(given.A_fe), "next": float(given.A_ne)}
    filtering = low_pass(float(given.f_r) * f_b).at(grid)
    sent = M * np.sinc(grid / f_b) * filtering  # (93A-23), (93A-24)
    spectra = [amplitudes[way.kind] * sent * on_grid(way.f, transfer(given, way, lengths), grid) for way in ways]
    best = Equalised(0.0, (0.0, 0.0), taps[0], 0, 0.0, [])
    for gains in given.gains:
        H = ctle(gains[0], *(f_b * float(f) for f in (given.f_z, *given.f_p))).at(grid)  # (93A-22)
        H = H if given.f_LF is None else H * ctle(gains[1], *[f_b * float(given.f_LF)] * 2).at(grid)
        noise = float(given.eta_0) * f_b / n * float((np.abs(filtering * H) ** 2).sum())  # (93A-35)
        pulses = [irfft(each * H, n * M).reshape(n, M) for each in spectra]
        merit, k, at = _best_taps(given, taps, lead, [*zip((way.kind for way in ways), pulses, strict=True)], noise)
        if merit > best.merit:
            best = Equalised(merit, gains, taps[k], at, noise**0.5, pulses)
    if not best.pulses or -best.pulses[0].min() > best.pulses[0].max():
        problem = "the sender arrives inverted" if best.pulses else "nothing of the sender arrives"
        raise InputError("ports", problem, "sender and receiver, and pairs alike in both")
    for k, way in enumerate(ways):
        if way.kind != "next":
            parts = [c * np.roll(best.pulses[k], shift - lead, axis=0) for shift, c in enumerate(best.taps)]
            best.pulses[k] = np.sum(parts, axis=0)
    return best


def _best_taps(
    given: Clause, taps: NDArray, lead: int, heard: list[tuple[str, NDArray]], noise: float
) -> tuple[float, int, int]:
    """Largest figure of merit behind one setting of the receiver's equaliser, its taps, and the sampled instant."""
    victim, M, m = heard[0][1], given.M, taps.shape[1]
    flat = victim.ravel()
    first = (int(flat.argmax()) // M - m - 2) * M
    around = np.arange(first, first + (2 * m + given.N_b + 6) * M)  # samples that are looked at
    h = taps @ np.array([flat[(around - (k - lead) * M) % len(flat)] for k in range(m)])
    at = sampled(given, h, (2 * m + 4) * M)
    row, phase = np.arange(len(taps)), around[at] % M
    main, post = h[row, at], h[row[:, None], at[:, None] + M * np.arange(1, given.N_b + 1)]
    left = post - feedback(given, post, main[:, None]) * main[:, None]
    others = _energies(victim, taps)[row, phase] - main**2 - (post**2).sum(axis=1)
    isi = np.maximum(others, 0.0) + (left**2).sum(axis=1)
    crosstalk = sum(
        (each**2).sum(axis=0).max() if kind == "next" else _energies(each, taps).max(axis=1) for kind, each in heard[1:]
    )  # (93A-33)
    shaken = (float(given.A_DD) ** 2 + float(given.sigma_RJ) ** 2) * _energies(slopes(victim), taps)[row, phase]
    unlike = main**2 * 10 ** (-float(given.SNR_TX) / 10)  # (93A-30)
    merits = signal(given, main) ** 2 / (power(given.L) * (isi + crosstalk + shaken) + unlike + noise)
    k = int(np.where(main > 0, merits, -1.0).argmax())
    return float(merits[k]) if main[k] > 0 else 0.0, k, int(around[at[k]] % len(flat))


def sampled(given: Clause, h: NDArray, end: int) -> NDArray:
    """Index of the main cursor in each response, shape (k, n), around its maximum before an end; (93A-25).

    The cursor before the main one is what feedback leaves of the one behind it. Of several such instants it is the last
    before the maximum; where there is none, the nearest to that within a symbol of the maximum.
    """
    M, row = given.M, np.arange(len(h))
    top = M + h[:, M : end - M].argmax(axis=1)
    near = np.clip(top[:, None] + np.arange(-M, M + 1), M, end - M - 1)
    main, after = h[row[:, None], near], h[row[:, None], near + M]
    fed = feedback(given, after[..., None], main[..., None])[..., 0] * main if given.N_b else 0.0
    wrong = np.where(main > 0, h[row[:, None], near - M] - after + fed, np.inf)
    turns = (wrong[:, :M] > 0) != (wrong[:, 1 : M + 1] > 0)
    turns &= np.isfinite(wrong[:, :M])
    last = M - 1 - turns[:, ::-1].argmax(axis=1)
    last += np.abs(wrong[row, last + 1]) < np.abs(wrong[row, last])
    return near[row, np.where(turns.any(axis=1), last, np.abs(wrong).argmin(axis=1))]


def feedback(given: Clause, post: NDArray, main: NDArray) -> NDArray:
    """Taps of the decision feedback for cursors behind the main one, over that, within their bounds; (93A-26)."""
    most = np.array([float(b) for b in [*given.b_max, *given.b_max[-1:] * given.N_b][: post.shape[-1]]])
    return np.clip(post / np.where(main > 0, main, np.inf), -most, most)


def _energies(pulse: NDArray, taps: NDArray) -> NDArray:
    """Sum of squares of a pulse, shape (n, M), behind each setting of taps, at each phase, shape (len(taps), M)."""
    by_shift = [(pulse * np.roll(pulse, k, axis=0)).sum(axis=0) for k in range(taps.shape[1])]
    return np.einsum("ci,ijm,cj->cm", taps, np.array(by_shift)[toeplitz(np.arange(taps.shape[1]))], taps, optimize=True)


def slopes(pulse: NDArray) -> NDArray:
    """Change of a pulse, shape (n, M), in a symbol's time, at each sample; (93A-28)."""
    flat = pulse.ravel()
    return ((np.roll(flat, -1) - np.roll(flat, 1)) * pulse.shape[1] / 2).reshape(pulse.shape)


def signal(given: Clause, main: NDArray) -> NDArray:
    """Half of the distance of two symbols at the main cursor."""
    return float(given.R_LM) * main / (given.L - 1)
