"""Measured channels: a Touchstone file of lines or of pairs, its proved model, and the transmission of that.

S between single ports and differential modes is a part of M S M^T with orthogonal M, so it is passive where S is. The
model is d + sum of r/(s - a) behind delays: its answer to straight edges is a sum of exponentials, in closed form, and
nothing comes before the delays are over.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.presentation import Presentation, plain
from tline.signal.bits import FINE, above_zero, edge_within
from tline.signal.pulse import PulseResponse, until_settled
from tline.signal.tdr import Reflections
from tline.units import engineering, to_si
from tline.words.wording import shown

if TYPE_CHECKING:
    from passivity import DelayedModel, SampledResponse, SampleVerdict
    from tline.signal.all_patterns import StatisticalEye
    from tline.signal.margin import OperatingMargin

REPORTS = ".html", ".pdf"
FLOOR = 1e-6  # -120 dB, in place of zeros
PROFILE = 2000  # instants of an impedance profile
TURNS = 3.0  # length of a profile over the delay of the channel


@dataclass(frozen=True, eq=False, repr=False)
class Channel(Presentation):
    """S between single ports or pairs of a measured network, and its model.

    The first of them sends, the second receives, all others are neighbours that send as well.

    Attributes
    ----------
    measured : SampledResponse
        S of all ports, as it was given.
    names : tuple of str
        Of ports and pairs, as ``"1"`` or ``"1,3"``.
    modes : SampledResponse
        S between them, and behind these the common modes of all pairs.
    found : DelayedModel
        Of S between them, proved passive.
    title : str
        Name of the file.
    tol : float
        Largest distance of S from the samples that was asked for.
    """

    measured: "SampledResponse"
    names: tuple[str, ...]
    modes: "SampledResponse"
    found: "DelayedModel"
    title: str = ""
    tol: float = np.inf
    picture = "tline.pictures.signals:plot_channel"

    @cached_property
    def verdict(self) -> "SampleVerdict":
        """Verdict on the passivity of the samples themselves."""
        from passivity import check_samples

        return check_samples(self.measured)

    def decibels(self, to: int, of: int) -> NDArray:
        """20 log |S| of the samples, shape (n,); names, and behind these the common modes, count from 0 on."""
        return 20 * np.log10(np.maximum(np.abs(self.modes.values[:, to, of]), FLOOR))

    @property
    def curves(self) -> dict[str, dict[str, NDArray]]:
        """Losses, crosstalk into the receiver and conversion into common modes, dB, by kind and ports."""
        n, names = len(self.names), self.names
        one, two = names[:2]
        told = {"insertion": {f"{one} → {two}": self.decibels(1, 0)}}
        told["return"] = {name: self.decibels(k, k) for k, name in enumerate(names[:2])}
        told["crosstalk"] = {f"{names[k]} → {two}": self.decibels(1, k) for k in range(2, n)}
        common = [name for name in names if "," in name]
        told["conversion"] = {f"{one} → common of {name}": self.decibels(n + k, 0) for k, name in enumerate(common)}
        return {what: each for what, each in told.items() if each}

    @property
    def worst(self) -> list[tuple[str, str, float, float]]:
        """Kind and ports of each curve, its worst value, dB, and the frequency of that, Hz."""
        found = []
        for what, each in self.curves.items():
            for name, values in each.items():
                k = int(values.argmin() if what == "insertion" else values.argmax())
                found.append((what, name, float(values[k]), float(self.measured.f[k])))
        return found

    def text_lines(self) -> Iterator[str]:
        """Sender and receiver, verdict on the file, the model and its proof, losses."""
        yield f"{self.title or 'channel'}: {self.names[0]} sends, {self.names[1]} receives"
        yield from (line.strip() for line in self.verdict.text_lines())
        yield f"model: {self.found.summary}"
        if not self.found.meets(self.tol):
            yield f"the model is farther from the samples than the tolerance of {self.tol:g}"
        for what, name, value, f in self.worst:
            word = "down to" if what == "insertion" else "up to"
            yield f"{what} {name} {word} {value:.3g} dB at {engineering(f, 'Hz')}"

    def to_dict(self) -> dict[str, Any]:
        """Frequencies in Hz, curves in dB, and properties of the model."""
        found = self.found
        told = {"order": found.order, "delay": found.delay, "error": found.error, "cost": found.cost}
        told |= {"status": found.verdict.status.value, "why": found.verdict.why}
        samples = {"status": self.verdict.status.value, "worst": self.verdict.worst_value}
        return plain({"names": self.names, "f": self.measured.f, **self.curves, "model": told, "samples": samples})

    def pulse(
        self,
        period: float | str,
        rise: float | str,
        *,
        source: int = 0,
        low: float | str = 0.0,
        high: float | str = 1.0,
    ) -> PulseResponse:
        """Response of the receiver to one bit, exact for the model, all ports matched to their references.

        Above the samples' frequencies the model is unconstrained. The effect of that is estimated from the spectrum of
        straight edges, 1/(pi^2 f^2 rise), with S as large as at the last sample.

        Parameters
        ----------
        period : float or str
            Time of a bit, s.
        rise : float or str
            Time of a change from level to level, straight, which begins with the bit, s.
        source : int
            Which of the names sends, from 0 on: 0 the sender, 2 and more its neighbours.
        low, high : float or str
            Levels of a zero and a one, V, as the sender has them at its port without reflections.

        Raises
        ------
        InputError
            A time out of range.
        """
        T = above_zero(period, "period")
        edge = edge_within(rise, T)
        zero, one = (to_si(level, "V", name) for level, name in ((low, "low"), (high, "high")))
        z0 = self.found.samples.z0
        unit = float(np.sqrt(z0[1] / z0[source]))

        def seen(n: int) -> NDArray:
            t = np.arange(-FINE, n * FINE) * T / FINE  # one bit in front, for the value a bit ago
            corners = self.ramp(1, source, t) - self.ramp(1, source, t - edge)
            return ((corners[FINE:] - corners[:-FINE]) * unit * (one - zero) / edge).reshape(n, FINE)

        gain = float(self.found.model.at(np.zeros(1))[0, 1, source].real) * unit
        u, missing = until_settled(seen, gain * (one - zero))
        last = float(np.abs(self.modes.values[-1, 1, source])) * unit * abs(one - zero)
        unmeasured = last / (np.pi**2 * edge * self.modes.f[-1])
        return PulseResponse(T, u, gain * zero, missing, self.names[1], title=self.title, unmeasured=unmeasured)

    def ramp(self, to: int, of: int, t: NDArray) -> NDArray:
        """The model's wave out of one port at instants, where the wave into another is t from 0 on; s."""
        model, late = self.found.model.entry(to, of), self.found.delay[to] + self.found.delay[of]
        x = np.maximum(t - late, 0.0)
        total = model.constant * x
        for a, r in zip(model.poles, model.residues, strict=True):
            part = r / a * (np.expm1(a * x) / a - x)
            total += (1 + (a.imag > 0)) * part.real
        return total

    def reflections(self, rise: float | str, port: int = 0, t_end: float | str | None = None) -> Reflections:
        """Reflections of a step at a port, as by a reflectometer, with the profile of impedance.

        Parameters
        ----------
        rise : float or str
            Time that the step takes, a straight ramp, s, above zero.
        port : int
            Which of the names, from 0 on.
        t_end : float or str, optional
            How long to look, s; three times as long as the channel if not given.
        """
        edge = above_zero(rise, "rise")
        longest = TURNS * self.delay + 10 * edge if t_end is None else above_zero(t_end, "t_end")
        t = np.linspace(0, longest, PROFILE)
        back = (self.ramp(port, port, t) - self.ramp(port, port, t - edge)) / edge
        z0 = float(self.found.samples.z0[port])
        return Reflections(t, np.clip(t / edge, 0, 1), back, z0, self.names[port], title=self.title)

    @property
    def delay(self) -> float:
        """Delay from the sender to the receiver, s."""
        return max(mean_delay(self.modes.f, self.modes.values[:, 1, 0]), 0.0)

    def save(
        self,
        path: str | Path,
        seen: "StatisticalEye | None" = None,
        margin: "OperatingMargin | None" = None,
        rise: float | str | None = None,
        inputs: Mapping[str, str] | None = None,
    ) -> None:
        """Write a report, ``.html``, one self-contained page, or ``.pdf``.

        Parameters
        ----------
        path : str or Path
        seen : StatisticalEye, optional
            Eye at the receiver, beside the losses.
        margin : OperatingMargin, optional
            Of the channel.
        rise : float or str, optional
            Of the step whose reflections give the impedances, s; half a period of the highest frequency if not given.
        inputs : mapping of str to str, optional
            Inputs of the request, for the end of the page.

        Raises
        ------
        InputError
            Another suffix, or the file cannot be written.
        """
        from importlib import import_module

        from tline.atomic import suffix_of

        suffix_of(path, REPORTS)
        profile = self.reflections(0.5 / self.measured.f[-1] if rise is None else rise)
        pages, parts = import_module("tline.pictures.page"), import_module("tline.pictures.signals").report
        whole = pages.page(f"Channel {self.title}".rstrip(), parts(self, profile, seen, margin, inputs or {}))
        pages.save_page(whole, path)


def measured_channel(
    file: Any,
    ports: str = "1 2",
    *,
    tol: float | str = 1e-3,
    progress: Callable[[int, float], object] | None = None,
) -> Channel:
    """A measured channel: S between ports and pairs of a Touchstone file, and the nearest passive model of it.

    Parameters
    ----------
    file : str, Path, SampledResponse, or network of scikit-rf
        The measurement; all ports that are not named are matched.
    ports : str
        Which send and receive: ports with blanks between, pairs with a comma, as ``"1,3 2,4 5,7"``. The first sends,
        the second receives, others are neighbours that send too.
    tol : float or str
        Largest distance of the model's S from the samples', above 0. Where no model is that near, the text says so.
    progress : callable, optional
        Called with order and misfit of each model that is tried.

    Raises
    ------
    InputError
        The file cannot be read, is not of S, or has no such ports.

    Examples
    --------
    >>> from passivity import SampledResponse
    >>> f = np.linspace(0, 1e10, 200)
    >>> S21 = 0.8 * np.exp(-2j * np.pi * f * 1e-9) / (1 + 1j * f / 5e9)
    >>> cable = measured_channel(SampledResponse(f, [[[0, x], [x, 0]] for x in S21], "S"))
    >>> cable.found.order, round(cable.delay * 1e9, 1), round(float(cable.pulse("1 ns", "0.1 ns").u[1, 63]), 4)
    (1, 1.0, 0.8)
    """
    from passivity import SampledResponse, fit_scattering
    from tline.scene.quantity import FIT_TOLERANCE

    title, response = read_samples(file)
    names, modes = modes_of(response, ports)
    n = len(names)
    between = SampledResponse(modes.f, modes.values[:, :n, :n], "S", modes.z0[:n])
    near = float(FIT_TOLERANCE.parse(tol, ""))
    return Channel(response, names, modes, fit_scattering(between, near, nearest=True, progress=progress), title, near)


def read_samples(file: Any) -> "tuple[str, SampledResponse]":
    """Name and S of a Touchstone file, of samples or of a network of scikit-rf."""
    from passivity import SampledResponse, read_touchstone

    title = Path(file).name if isinstance(file, str | Path) else str(getattr(file, "name", "") or "")
    if isinstance(file, str | Path):
        file = read_touchstone(file)
    response = file if isinstance(file, SampledResponse) else SampledResponse.from_network(file)
    if response.parameter != "S":
        raise InputError(title or "file", f"samples of {response.parameter}", "S")
    return title, response


def modes_of(
    response: "SampledResponse", ports: str, where: str = "ports"
) -> "tuple[tuple[str, ...], SampledResponse]":
    """Names of ports and pairs, and S between them and the common modes of all pairs; `where` is named in errors."""
    if not re.fullmatch(r"\s*\d+(,\d+)?(\s+\d+(,\d+)?)+\s*", ports, re.ASCII):
        raise InputError(where, "not ports or pairs", "two or more, such as '1 2' or '1,3 2,4'", shown(ports))
    names = tuple(ports.split())
    return names, response.between([[int(port) - 1 for port in name.split(",")] for name in names], where)


def mean_delay(f: NDArray, H: NDArray) -> float:
    """Delay of a response by its phase over all frequencies by its size, s; 0 for none."""
    turned = H[1:] * H[:-1].conj()
    size = np.abs(turned)
    return -float((np.angle(turned) * size).sum() / (2 * np.pi * np.diff(f) @ size)) if size.any() else 0.0
