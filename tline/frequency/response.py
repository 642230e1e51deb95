"""Responses over frequency; transfer functions from a source to all probes of a scene, at any complex s."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.atomic import write_columns
from tline.errors import InputError, as_numbers
from tline.frequency.oscillations import Resonance, resonances
from tline.presentation import Presentation, plain
from tline.scene.file import as_scene
from tline.scene.medium import MEDIA
from tline.scene.scene import Scene
from tline.solver.description.description import Description, describe
from tline.solver.description.lines import ProbePlace, probes_of
from tline.solver.stability.growth import growth_sentence
from tline.solver.stability.scattering import Scattering, answers, inside
from tline.units import to_si
from tline.words.wording import aligned, nearest, place

MOST_POINTS = 1_000_000
PARTS = {"re": np.real, "im": np.imag}
MOST_MODES = 12  # oscillations shown, of the growing ones and of the others


@dataclass(frozen=True, eq=False, repr=False)
class Curves(Presentation):
    """Complex functions of s, with the natural oscillations of their scene."""

    scene: Scene
    s: NDArray  # Laplace variable, 1/s; any shape
    curves: dict[str, NDArray]  # by name, of the shape of s
    what: str  # they are, such as "voltage / source"
    unit: str
    picture = "tline.pictures.bode:plot_curves"

    @property
    def f(self) -> NDArray:
        """Frequencies, Hz. Raises InputError: they do not rise, or s is not on the imaginary axis."""
        f = np.imag(np.atleast_1d(self.s)) / (2 * np.pi)
        if f.ndim > 1 or np.any(np.real(self.s)) or f[0] < 0 or np.any(np.diff(f) <= 0):
            raise InputError("s", "no frequencies in rising order", "2j*pi*f")
        return f

    @cached_property
    def _modes(self) -> tuple[list[Resonance], list[str]]:
        """Natural oscillations in the range, and growing ones below it; or the reason why none are found."""
        try:
            f = self.f
            found = resonances(self.scene, float(f[-1]))
        except InputError as error:
            return [], [f"no natural oscillations are listed: {error.problem}"]
        return [mode for mode in found if mode.frequency >= f[0] or mode.decay_time < 0], []

    @property
    def oscillations(self) -> list[Resonance]:
        """Natural oscillations between the frequencies, and growing ones below them, slowest first."""
        return self._modes[0]

    @property
    def notes(self) -> list[str]:
        """Reason why no oscillations are listed, or growth rate of waves."""
        description = describe(self.scene)
        return self._modes[1] + ([growth_sentence(description)] if description.active else [])

    def text_lines(self) -> Iterator[str]:
        """Lowest and highest magnitudes, and natural oscillations."""
        if self.curves:
            rows = [(self.what, *(f"{end} magnitude [{self.unit}]" for end in ("lowest", "highest")))]
            at = [f"{s.imag / (2 * np.pi):.6g} Hz" if s.real == 0 else f"s = {s:.6g}" for s in self.s.ravel()]
            for name, values in self.curves.items():
                size = np.abs(values.ravel())
                ends = int(np.nanargmin(size)), int(np.nanargmax(size))
                rows.append((name, *(f"{size[k]:.4g} at {at[k]}" for k in ends)))
            yield from aligned(rows, 1)
        else:
            yield "no source: natural oscillations only"
        for title, growing in (("waves that grow:", True), ("natural oscillations:", False)):
            found = [mode for mode in self.oscillations if (mode.decay_time < 0) == growing]
            more = [f"  and {len(found) - MOST_MODES} more"] * (len(found) > MOST_MODES)
            yield from ["", title, *(f"  {mode}" for mode in found[:MOST_MODES]), *more] if found else []

    def to_dict(self) -> dict[str, Any]:
        """Curves by frequency, Hz, or by s, and oscillations."""
        s = self.s.ravel()
        along = {"s": s} if np.any(np.real(s)) else {"frequency": np.imag(s) / (2 * np.pi)}
        modes = [
            {key: getattr(mode, key) for key in ("frequency", "quality", "decay_time")} for mode in self.oscillations
        ]
        values = {name: {"re": np.real(c), "im": np.imag(c)} for name, c in self.curves.items()}
        return plain(self._told() | {"natural_oscillations": modes} | along | {"values": values})

    def _told(self) -> dict[str, Any]:
        return {"source": None}

    def save(self, path: str | Path) -> None:
        """Write frequency in Hz, then real and imaginary part of each curve, as CSV.

        Raises InputError: the file cannot be written.
        """
        columns = {
            f"{part} {name} [{self.unit}]": of(c) for name, c in self.curves.items() for part, of in PARTS.items()
        }
        write_columns(path, {"frequency [Hz]": self.f} | columns)


@dataclass(frozen=True, eq=False)
class ProbeResponse:
    """Effort, flow and waves at one probe per unit of the source, each of the shape of s."""

    u: NDArray
    y: NDArray
    a: NDArray
    b: NDArray


@dataclass(frozen=True, eq=False, repr=False)
class Response(Curves, Mapping[str, ProbeResponse]):
    """Responses of all probes of a scene per unit of one source: by name as in a dict, and as Bode plot and table.

    Attributes
    ----------
    source : str
        Name of the source.
    probes : dict of str to ProbeResponse
        By probe; units: of the probe's quantity over that of the source.
    s : ndarray of complex
        Laplace variable, 1/s.
    """

    source: str
    probes: dict[str, ProbeResponse]

    def __getitem__(self, probe: str) -> ProbeResponse:
        return self.probes[probe]

    def __iter__(self) -> Iterator[str]:
        return iter(self.probes)

    def __len__(self) -> int:
        return len(self.probes)

    def _told(self) -> dict[str, Any]:
        return {"source": self.source, "unit": self.unit}

    def save(self, path: str | Path) -> None:
        """Write frequency in Hz, then real and imaginary part of effort and flow at each probe, as CSV.

        Raises
        ------
        InputError
            The file cannot be written.
        """
        columns = {"frequency [Hz]": self.f}
        for name, seen in self.items():
            for quantity in "uy":
                values, unit = np.atleast_1d(getattr(seen, quantity)), unit_over(self.scene, self.source, quantity)
                columns |= {f"{name} {part} {quantity} [{unit}]": of(values) for part, of in PARTS.items()}
        write_columns(path, columns)


def unit_over(scene: Scene, source: str, quantity: str) -> str:
    """Unit of u, y, a or b per unit of a source."""
    units = MEDIA[scene.medium].units
    unit = units["effort" if scene.sources[source].is_effort else "flow"]
    return units["flow" if quantity == "y" else "effort"] + (f"/({unit})" if "/" in unit else f"/{unit}")


def frequencies(scene: Scene, low: str | None = None, high: str | None = None, points: int = 1001) -> NDArray:
    """Frequencies, Hz, evenly spaced on a logarithmic scale; by default around those that follow from the delays."""
    if not 2 <= points <= MOST_POINTS:
        raise InputError("points", "not a number of frequencies", f"2 to {MOST_POINTS}", f"{points}")
    delays = [line.delay for line in describe(scene).lines.values()]
    top = to_si(high, "Hz", "high") if high else 2.0 / min(delays)
    bottom = to_si(low, "Hz", "low") if low else min(0.01 / sum(delays), top / 100)
    if not 0 < bottom < math.inf:
        raise InputError("low", "not a positive frequency", "such as '1 MHz'", f"'{low}'")
    if not bottom < top < math.inf:
        raise InputError("high", "not above the lowest frequency", f"more than {bottom:.6g} Hz", f"{top:.6g} Hz")
    return np.geomspace(bottom, top, points)


def respond(scene: Scene | str | Path, s: ArrayLike | None = None, source: str | None = None) -> Response:
    """Compute transfer functions from one source of a scene to its probes.

    All other sources are silent: only their resistances count. Switches are in their final state.

    Parameters
    ----------
    scene : Scene, or the path of a file
        Linear lines between linear nodes.
    s : array_like of complex, optional
        Laplace variable, 1/s; ``2j*pi*f`` for a frequency f in Hz. Any shape. By default 1001 frequencies around those
        of the lines.
    source : str, optional
        Name of the source; not needed if there is one only.

    Returns
    -------
    Response
        By probe, with `plot()`, `save()` and natural oscillations.

    Raises
    ------
    InputError
        The source is not named and there are several or none, or s is not finite.

    References
    ----------
    D. M. Pozar, Microwave Engineering, 4th ed., Wiley 2012, chapters 2 and 4.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end=1, probes={"far": {"at": "far"}},
    ...     lines={"line": {"nodes": ["near", "far"], "z0": 50, "delay": "1 ns"}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 50}},
    ... )
    >>> bool(abs(respond(scene, 2j * np.pi * 0.25e9)["far"].u + 1j) < 1e-12)  # open end, a quarter wave: delayed by it
    True
    """
    scene = as_scene(scene)
    s = as_numbers("s", 2j * np.pi * frequencies(scene) if s is None else s, complex)
    if not np.isfinite(s).all():
        raise InputError("s", "not finite", "finite complex numbers", f"{s.ravel()[~np.isfinite(s.ravel())][0]}")
    name = source_named(scene, source)
    given, network = scene.sources[name], Scattering(describe(scene))
    held, flows = np.zeros(len(network.names)), np.zeros(len(network.names))
    if given.is_effort and given.nodes is not None:
        held[network.names.index(place("sources", name))] = 1.0  # behind which its branch lies
    elif np.isinf(given.conductance):
        held[network.names.index(given.terminals[0])] = 1.0
    else:
        for node, sign in zip(given.terminals, (1.0, -1.0), strict=True):
            if node is not None:
                flows[network.names.index(node)] = sign * (given.conductance if given.is_effort else 1.0)
    arriving, efforts = answers(network, s.ravel() * network.second, held, flows)
    description = describe(scene)
    seen = {
        probe: ProbeResponse(*(part.reshape(s.shape) for part in _seen(description, network, at, arriving, efforts, s)))
        for probe, at in probes_of(scene, description.coupled, inside=True).items()
    }
    what, unit = f"{MEDIA[scene.medium].effort} / source", unit_over(scene, name, "u")
    return Response(scene, s, {probe: each.u for probe, each in seen.items()}, what, unit, name, seen)


def _seen(
    description: Description, network: Scattering, probe: ProbePlace, arriving: NDArray, efforts: NDArray, s: NDArray
) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Effort, flow and waves at a probe; at conductors from those of their modes."""
    if probe.node:
        u = efforts[:, network.names.index(probe.node)]
        return u, 0 * u, u, u
    numbers = {name: k for k, name in enumerate(description.lines)}
    lines = [numbers[name] for name in probe.lines]
    u, y = np.swapaxes([_on_line(description, network, k, probe.share, arriving, efforts, s) for k in lines], 0, 1)
    if probe.conductor is None:
        (u,), (y,), z0 = u, y, network.z0[lines[0]]
    else:
        voltage, current, z0 = probe.conductor.parts
        u, y = voltage @ u, current @ y
    return u, y, u + z0 * y, u - z0 * y


def _on_line(
    description: Description, network: Scattering, k: int, share: float, arriving: NDArray, efforts: NDArray, s: NDArray
) -> tuple[NDArray, NDArray]:
    """Effort and flow on a line from the two waves there, each delayed by its way."""
    nodes = [network.names.index(node) for node in list(description.lines.values())[k].nodes]
    (b1, a2), (u1, u2), z0 = arriving[:, 2 * k : 2 * k + 2].T, efforts[:, nodes].T, network.z0[k]
    if share in (0.0, 1.0):
        return (u1, (u1 - b1) / z0) if share == 0.0 else (u2, (a2 - u2) / z0)
    if k in network.lossy:
        return inside(network.lossy[k], s.ravel(), share, u1, u2)
    way = s.ravel() * network.second * network.delays[k]
    a, b = (2 * u1 - b1) * np.exp(-way * share), (2 * u2 - a2) * np.exp(-way * (1 - share))
    return (a + b) / 2, (a - b) / (2 * z0)


def source_named(scene: Scene, name: str | None) -> str:
    """Return the name, or that of the only source.

    Raises InputError: there is no such source, or several and none is named.
    """
    sources = {key: each for key, each in scene.sources.items() if ("sources", key) not in scene.parts}
    if name is None:
        if len(sources) != 1:
            problem = "there is no source" if not sources else "there are several, and none is named"
            raise InputError("source", problem, nearest("", list(sources)) if sources else "a source in the scene")
        return next(iter(sources))
    if name not in sources:
        raise InputError("source", "no such source", nearest(name, list(sources)), f"'{name}'")
    return name
