"""Transfer functions from a source to all probes of a scene, at any complex s, and their files: CSV and Touchstone."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.result.atomic import replacing, write_columns
from tline.solver.stability.scattering import Scattering, answers, inside
from tline.words.wording import nearest, place


@dataclass(frozen=True, eq=False)
class Response:
    """Effort, flow and waves at one probe per unit of the source, each of the shape of s."""

    u: NDArray
    y: NDArray
    a: NDArray
    b: NDArray


def respond(scene: Scene, s: ArrayLike, source: str | None = None) -> dict[str, Response]:
    """Transfer functions from one source of a scene to its probes.

    All other sources are silent: only their resistances count. Switches stand as they do after they have moved.

    Parameters
    ----------
    scene : Scene
        Linear lines between linear nodes.
    s : array_like of complex
        Laplace variable, 1/s; ``2j*pi*f`` for a frequency f in Hz. Any shape.
    source : str, optional
        Name of the source; not needed if there is one only.

    Returns
    -------
    dict of str to Response
        By probe. Units: of the probe's quantity over that of the source.

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
    s = np.asarray(s, complex)
    if not np.isfinite(s).all():
        raise InputError("s", "not finite", "finite complex numbers", f"{s.ravel()[~np.isfinite(s.ravel())][0]}")
    name = source_named(scene, source)
    given, network = scene.sources[name], Scattering(describe(scene))
    held, flows = np.zeros(len(network.names)), np.zeros(len(network.names))
    if given.is_effort and given.nodes is not None:
        held[network.names.index(place("sources", name))] = 1.0  # behind which its branch stands
    elif np.isinf(given.conductance):
        held[network.names.index(given.terminals[0])] = 1.0
    else:
        for node, sign in zip(given.terminals, (1.0, -1.0), strict=True):
            if node is not None:
                flows[network.names.index(node)] = sign * (given.conductance if given.is_effort else 1.0)
    arriving, efforts = answers(network, s.ravel() * network.second, held, flows)
    return {probe: _seen(scene, network, probe, arriving, efforts, s) for probe in scene.probes}


def _seen(scene: Scene, network: Scattering, probe: str, arriving: NDArray, efforts: NDArray, s: NDArray) -> Response:
    """What a probe sees: the two waves on its line, each delayed by its way."""
    line = scene.probed_line(probe)
    if line is None:
        u = efforts[:, network.names.index(scene.probes[probe].at or "")].reshape(s.shape)
        return Response(u, 0 * u, u, u)
    k, share = list(scene.lines).index(line), scene.probes[probe].fraction(scene.lines[line])
    nodes = [network.names.index(node) for node in scene.lines[line].nodes]
    (b1, a2), (u1, u2) = arriving[:, 2 * k : 2 * k + 2].T, efforts[:, nodes].T
    if share in (0.0, 1.0):
        a, b = (2 * u1 - b1, b1) if share == 0.0 else (a2, 2 * u2 - a2)
    elif k in network.lossy:
        u, y = inside(network.lossy[k], s.ravel(), share, u1, u2)
        a, b = u + network.z0[k] * y, u - network.z0[k] * y
    else:
        way = s.ravel() * network.second * network.delays[k]
        a, b = (2 * u1 - b1) * np.exp(-way * share), (2 * u2 - a2) * np.exp(-way * (1 - share))
    parts = ((a + b) / 2, (a - b) / (2 * network.z0[k]), a, b)
    return Response(*(part.reshape(s.shape) for part in parts))


def source_named(scene: Scene, name: str | None) -> str:
    """The name, or that of the only source.

    Raises
    ------
    InputError
        There is no such source, or several and none is named.
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


TOUCHSTONE = "s{}p"
PARTS = {"re": np.real, "im": np.imag}


def save_response(f: NDArray, probes: Mapping[str, Response], units: tuple[str, str], path: str | Path) -> None:
    """Write transfer functions as CSV: frequency in Hz, then real and imaginary part of effort and flow at each probe.

    `units` are those of effort and flow per unit of the source, such as ("V/V", "A/V").

    Raises
    ------
    InputError
        The file cannot be written.
    """
    columns = {"frequency [Hz]": f}
    for name, seen in probes.items():
        for letter, values, unit in (("u", seen.u, units[0]), ("y", seen.y, units[1])):
            columns |= {
                f"{name} re {letter} [{unit}]": np.real(values),
                f"{name} im {letter} [{unit}]": np.imag(values),
            }
    write_columns(path, columns)


def save_parameters(f: NDArray, S: NDArray, ports: Sequence[str], z0: float, path: str | Path) -> None:
    """Write S-parameters, shape (n, p, p), as CSV, or as Touchstone 1 where the suffix is ``.sNp``.

    Raises
    ------
    InputError
        The suffix does not fit the number of ports, or the file cannot be written.
    """
    suffix, count = Path(path).suffix.lower(), len(ports)
    if suffix == ".csv":
        entries = {f"S({i},{j})": S[:, m, n] for m, i in enumerate(ports) for n, j in enumerate(ports)}
        parts = {f"{part} {name} [1]": of(values) for name, values in entries.items() for part, of in PARTS.items()}
        write_columns(path, {"frequency [Hz]": f} | parts)
        return
    if suffix != f".{TOUCHSTONE.format(count)}":
        raise InputError(str(path), "does not fit the number of ports", f".{TOUCHSTONE.format(count)} or .csv", suffix)
    order = S.swapaxes(1, 2) if count == 2 else S  # of two ports S21 comes before S12
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8") as file:
        file.write(f"! ports: {', '.join(ports)}\n# Hz S RI R {z0:.17g}\n")
        for frequency, matrix in zip(f, order, strict=True):
            rows = [_interleaved(row[None, :])[0] for row in ([matrix.ravel()] if count <= 2 else matrix)]
            for k, row in enumerate(rows):
                for start in range(0, len(row), 8):  # four pairs on a line
                    head = f"{frequency:.17g}" if k == start == 0 else ""
                    file.write(" ".join([head, *(f"{x:.17g}" for x in row[start : start + 8])]).strip() + "\n")


def _interleaved(values: NDArray) -> NDArray:
    """Real and imaginary parts beside each other, shape (n, 2 m)."""
    return np.stack([np.real(values), np.imag(values)], axis=2).reshape(len(values), -1)
