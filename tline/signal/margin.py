"""Channel operating margin: signal over all that disturbs it, behind the best equalisers of a clause's receiver."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.presentation import Presentation, plain
from tline.signal.channel import modes_of, read_samples
from tline.signal.clauses import Clause, clause
from tline.signal.density import LEVELS, TAILS, density, largest, power, without_small
from tline.signal.reference_receiver import Equalised, Way, equalised, feedback, signal, slopes
from tline.units import engineering
from tline.words.wording import shown


@dataclass(frozen=True, eq=False, repr=False)
class OperatingMargin(Presentation):
    """Channel operating margin of the worst of a clause's test cases.

    Attributes
    ----------
    clause : Clause
        The parameters.
    signal, disturbance : float
        A_s, and A_ni, which is exceeded with a probability of DER_0, V.
    sigmas : dict of str to float
        Standard deviations of the disturbance's parts, V.
    best : Equalised
        Equalisers, and the responses behind them.
    dfe : ndarray, shape (N_b,)
        Taps of the decision feedback, over the main cursor.
    cases : tuple of float
        Margins of all test cases, dB.
    lacking : tuple of str
        What the samples lack.
    title : str
        Name of the file.
    """

    clause: Clause
    signal: float
    disturbance: float
    sigmas: dict[str, float]
    best: Equalised
    dfe: NDArray
    cases: tuple[float, ...] = ()
    lacking: tuple[str, ...] = ()
    title: str = ""
    picture = "tline.pictures.signals:plot_margin"

    @property
    def margin(self) -> float:
        """20 log(A_s/A_ni), dB; (93A-1)."""
        return float(20 * np.log10(self.signal / self.disturbance)) if self.disturbance > 0 else np.inf

    @property
    def rows(self) -> list[list[str]]:
        """Each thing found, and its value."""
        gains = self.best.gains[: 1 if self.clause.f_LF is None else 2]
        lengths = [engineering(float(z), "m") for z, _ in self.clause.package.z_p]
        told = [["channel operating margin", f"{self.margin:.3g} dB, to pass {float(self.clause.least):g} dB"]]
        told += [[f"with packages of {z}", f"{x:.3g} dB"] for z, x in zip(lengths, self.cases, strict=True)]
        volts = {"signal A_s": self.signal, "disturbance A_ni": self.disturbance}
        volts |= {f"{name}, rms": value for name, value in self.sigmas.items()}
        told += [[name, engineering(value, "V")] for name, value in volts.items()]
        told += [["figure of merit", f"{10 * np.log10(self.best.merit):.3g} dB"]]
        told += [["sender's taps", ", ".join(f"{tap:.4g}" for tap in self.best.taps)]]
        told += [["receiver's gain at rest", " and ".join(f"{gain:g} dB" for gain in gains)]]
        told += [["feedback over the main cursor", ", ".join(f"{b:.3f}" for b in self.dfe) or "none"]]
        return [*told, *(["samples", lack] for lack in self.lacking)]

    def text_lines(self) -> Iterator[str]:
        """The parameters' title, and all rows."""
        yield f"{self.title}: {self.clause.title}".removeprefix(": ").removesuffix(": ")
        yield from map(" ".join, self.rows)

    def to_dict(self) -> dict[str, Any]:
        """All in SI units, with the parameters, which `clause` reads again."""
        names = "margin cases signal disturbance sigmas dfe lacking"
        told = {name: getattr(self, name) for name in names.split()}
        told |= {"merit": 10 * np.log10(self.best.merit), "gains": self.best.gains, "taps": self.best.taps}
        return plain(told | {"pulse": self.best.pulses[0], "at": self.best.at, "parameters": self.clause.table()})


def operating_margin(
    file: Any, by: Any, ports: str = "1 2", *, fext: Sequence[Any] = (), near: Sequence[Any] = ()
) -> OperatingMargin:
    """Channel operating margin of a measured channel, by IEEE Std 802.3, annex 93A.

    Parameters
    ----------
    file : str, Path, SampledResponse, or network of scikit-rf
        The channel.
    by : str, Path, dict or Clause
        Parameters, as of `clause`.
    ports : str
        Sender, receiver and neighbours, as of `measured_channel`; single ports are differential modes already.
    fext, near : sequence
        Files of ways from far-end and near-end aggressors to the receiver, at the ports of the first two. Neighbours in
        the same file are far-end aggressors but for those whose ports are in `near`.

    Raises
    ------
    InputError
        A file cannot be read, has no such ports or ends too early, or a parameter is out of range.

    Examples
    --------
    >>> from passivity import SampledResponse
    >>> f = np.arange(0, 40.005e9, 2e7)
    >>> S21 = np.exp(-2j * np.pi * f * 1e-9 - 1e-5 * np.sqrt(f))
    >>> cable = SampledResponse(f, [[[0, x], [x, 0]] for x in S21], "S", 100)
    >>> round(operating_margin(cable, "100GBASE-KR4").margin, 1)
    10.2
    """
    given = clause(by)
    title, response = read_samples(file)
    names, modes = modes_of(response, ports)
    if len({"," in name for name in names}) > 1:
        raise InputError("ports", "single ports beside pairs", "all pairs, or all single ports", shown(ports))
    inside = {each for each in near if isinstance(each, str)} & {*names[2:]}
    ways = [
        Way(kind, modes.f, modes.values[:, [[k], [1]], [k, 1]], modes.z0[[k, 1]], title)
        for k, kind in [(0, "tx"), *((k, "next" if names[k] in inside else "fext") for k in range(2, len(names)))]
    ]
    outside = [each for each in near if not (isinstance(each, str) and each in inside)]
    for kind, each in [*(("fext", each) for each in fext), *(("next", each) for each in outside)]:
        own, other = read_samples(each)
        _, modes = modes_of(other, " ".join(names[:2]), own or kind)
        ways.append(Way(kind, modes.f, modes.values[:, :2, :2], modes.z0[:2], own))
    f_b, lacking = float(given.f_b), []
    if short := [way for way in ways if way.f[-1] < f_b / 2 or len(way.f) < 4]:
        title, expected = short[0].title or "file", f"four and more, up to {f_b / 2:g} Hz"
        got = f"{len(short[0].f)}, up to {short[0].f[-1]:g} Hz"
        raise InputError(title, "too few samples for a margin", expected, got)
    ends, widest = min(way.f[-1] for way in ways), max(float(np.diff(way.f, prepend=0.0).max()) for way in ways)
    lacking += [f"end at {ends:g} Hz, below the signaling rate: their loss goes on"] * bool(ends < f_b)
    lacking += [f"are {widest:g} Hz apart, or from rest, more than delta_f"] * (widest > 1.01 * float(given.delta_f))
    lacking += [f"of single ports, taken as modes against {ways[0].z0[0]:g} ohm"] * ("," not in names[0])
    found = [_margin(given, equalised(given, ways, lengths)) for lengths in given.package.z_p]
    cases = tuple(each.margin for each in found)
    return replace(found[int(np.argmin(cases))], cases=cases, lacking=tuple(lacking), title=title)


def _margin(given: Clause, best: Equalised) -> OperatingMargin:
    """Margin behind given equalisers, (93A-37) to (93A-45)."""
    phase, k, victim = best.at % given.M, best.at // given.M, best.pulses[0]
    cursors, shaken, scale = victim[:, phase].copy(), slopes(victim)[:, phase], power(given.L) ** 0.5
    main, post = float(cursors[k]), (k + 1 + np.arange(given.N_b)) % len(cursors)
    dfe = feedback(given, cursors[post], np.array(main))
    cursors[post] -= dfe * main
    cursors[k] = 0.0
    heard = [each[:, (each**2).sum(axis=0).argmax()] for each in best.pulses[1:]]
    parts = {
        "intersymbol interference": cursors,
        "crosstalk": np.array(heard).ravel(),
        "dual-Dirac jitter": float(given.A_DD) * shaken,
    }
    gaussian = {"random jitter": scale * float(given.sigma_RJ) * float(np.linalg.norm(shaken)),
                "sender's noise": main * 10 ** (-float(given.SNR_TX) / 20), "receiver's noise": best.noise}  # fmt: skip
    sigmas = {name: scale * float(np.linalg.norm(each)) for name, each in parts.items()} | gaussian
    spread = float(np.linalg.norm([*gaussian.values()]))
    disturbance = exceeded(np.concatenate([*parts.values()]), spread, given.L, float(given.DER_0))
    return OperatingMargin(given, float(signal(given, np.array(main))), disturbance, sigmas, best, dfe)


def exceeded(cursors: NDArray, noise: float, symbols: int, rate: float) -> float:
    """Value that a sum of independent symbols, by their largest values, and of noise exceeds with a probability.

    Examples
    --------
    >>> round(exceeded(np.array([0.02]), 0.01, 2, 1e-5), 4)  # 0.02 and 0.01 Q^-1(2e-5)
    0.0611
    """
    cursors, noise = without_small(cursors, noise, symbols)
    if not cursors.any() and not noise:
        return 0.0
    step = (largest(cursors) + TAILS * noise) / LEVELS
    found = density(cursors, noise, step, symbols)
    below = np.maximum(np.cumsum(found) - found / 2, 1e-300)
    k = max(int(np.searchsorted(below, rate)), 1)
    return float((LEVELS - np.interp(np.log(rate), np.log(below[k - 1 : k + 1]), [k - 1, k])) * step)
