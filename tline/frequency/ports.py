"""S-parameters and impedances at nodes of a scene."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.atomic import replacing
from tline.errors import InputError, as_numbers, check_kind
from tline.frequency.response import Curves, frequencies
from tline.scene.coupled import Coupled
from tline.scene.file import as_scene
from tline.scene.line import SceneLine
from tline.scene.medium import MEDIA
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.stability.scattering import Scattering, answers
from tline.units import to_si
from tline.words.wording import nearest, shown


@dataclass(frozen=True, eq=False, repr=False)
class ScatteringParameters(Curves):
    """S-parameters between nodes of a scene: an array of shape (n, p, p) for NumPy, with Bode plot and Touchstone file.

    Attributes
    ----------
    ports : tuple of str
        Nodes, p of them.
    z0 : tuple of float
        Reference resistance of each, ohm or Pa s/m³.
    values : ndarray of complex, shape (n, p, p)
        [:, i, j]: the power wave out of port i per power wave into port j.
    """

    ports: tuple[str, ...]
    z0: tuple[float, ...]
    values: NDArray

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray:
        return np.array(self.values, dtype, copy=bool(copy))

    def __getitem__(self, at: Any) -> Any:
        return self.values[at]

    def __len__(self) -> int:
        return len(self.values)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape (n, p, p)."""
        return self.values.shape

    def _told(self) -> dict[str, Any]:
        return {"ports": self.ports, "z0": self.z0 if len({*self.z0}) > 1 else self.z0[0]}

    def mixed(self) -> "ScatteringParameters":
        """Differential and common modes of ports in pairs: first with second, third with fourth, and so on.

        Returns
        -------
        ScatteringParameters
            Of ports ``a-b`` of all pairs (a, b), whose reference is 2 z0, and behind them ``a+b``, of z0/2.

        Raises
        ------
        InputError
            The number of ports is odd, or the references of a pair differ.

        References
        ----------
        D. E. Bockelman, W. R. Eisenstadt, "Combined differential and common-mode scattering parameters", IEEE Trans.
        Microwave Theory and Techniques 43 (1995) 1530-1539, doi:10.1109/22.392911.
        """
        first, second, z0 = self.ports[::2], self.ports[1::2], self.z0[::2]
        if len(first) != len(second):
            raise InputError("ports", "do not form pairs", "an even number of them", f"{len(self.ports)}")
        if z0 != self.z0[1::2]:
            raise InputError("z0", "differs within a pair", "one resistance for both ports", shown(self.z0))
        one, other = (np.eye(len(self.ports))[k::2] for k in (0, 1))
        modes = np.concatenate([one - other, one + other]) / np.sqrt(2)
        ports = [f"{a}{sign}{b}" for sign in "-+" for a, b in zip(first, second, strict=True)]
        return _between(
            self.scene, self.s, ports, [k * each for k in (2, 0.5) for each in z0], modes @ self.values @ modes.T
        )

    def save(self, path: str | Path) -> None:
        """Write the S-parameters as Touchstone 1 (``.sNp``), or as CSV: frequency in Hz, then real and imaginary parts.

        Raises
        ------
        InputError
            The suffix does not fit the number of ports, their references differ, or the file cannot be written.
        """
        suffix, count = Path(path).suffix.lower(), len(self.ports)
        if suffix == ".csv":
            return super().save(path)
        if suffix != f".s{count}p":
            raise InputError(str(path), "does not fit the number of ports", f".s{count}p or .csv", suffix)
        from passivity import SampledResponse

        text = SampledResponse(self.f, self.values, "S", self.z0).touchstone()
        with replacing(path) as temporary:
            temporary.write_text(f"! ports: {', '.join(self.ports)}\n{text}", encoding="utf-8")


def scattering_parameters(
    scene: Scene | str | Path,
    ports: str | Sequence[str],
    s: ArrayLike | None = None,
    z0: float | str | Sequence[float | str] | None = None,
) -> ScatteringParameters:
    """S-parameters of a scene between nodes and the reference.

    Sources at the ports are taken away with their resistances; all others are silent.

    Parameters
    ----------
    scene : Scene, or the path of a file
    ports : str or sequence of str
        Nodes, p of them; a text may name several, with commas.
    s : array_like of complex, shape (n,), optional
        Laplace variable, 1/s; by default 1001 frequencies around those of the lines.
    z0 : float or str, or one for each port, optional
        Reference resistance, above zero, ohm or Pa s/m³; by default that of the first line at the first port.

    Returns
    -------
    ScatteringParameters
        S[:, i, j]: the power wave out of port i per power wave into port j.

    Raises
    ------
    InputError
        A port is not a node, is named twice, or its effort is held by a load; or a bad z0.

    References
    ----------
    K. Kurokawa, "Power waves and the scattering matrix", IEEE Trans. Microwave Theory and Techniques 13 (1965) 194-202,
    doi:10.1109/TMTT.1965.1125964.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end=1, probes={"p": {"at": "a"}},
    ...     lines={"line": {"nodes": ["a", "b"], "z0": 50, "delay": "1 ns"}},
    ... )
    >>> abs(scattering_parameters(scene, ["a", "b"], [2j * np.pi * 1e8])[0]).round(9)
    array([[0., 1.],
           [1., 0.]])
    """
    scene = as_scene(scene)
    check_kind("ports", ports, str, list, tuple)
    ports = [name.strip() for name in ports.split(",")] if isinstance(ports, str) else ports
    R = _references(scene, ports, z0)
    s = np.atleast_1d(as_numbers("s", 2j * np.pi * frequencies(scene) if s is None else s, complex))
    bare = _without_sources(scene, ports)
    network = Scattering(describe(bare), dict(zip(ports, 1 / R, strict=True)))
    at = _indices(network, ports)
    points = s * network.second
    S = np.empty((len(points), len(ports), len(ports)), complex)
    for j, node in enumerate(at):
        flows = np.zeros(len(network.names))
        flows[node] = 2 / np.sqrt(R[j])  # a unit power wave: 2 sqrt(R) behind R
        _, efforts = answers(network, points, np.zeros(len(network.names)), flows)
        S[:, :, j] = efforts[:, at] / np.sqrt(R) - np.eye(len(ports))[j]
    return _between(scene, s, ports, R.tolist(), S)


def _between(scene: Scene, s: NDArray, ports: Sequence[str], z0: list[float], S: NDArray) -> ScatteringParameters:
    curves = {f"S({i},{j})": S[:, m, n] for m, i in enumerate(ports) for n, j in enumerate(ports)}
    return ScatteringParameters(scene, s, curves, "S", "1", tuple(ports), tuple(z0), S)


def impedance(scene: Scene | str | Path, node: str, s: ArrayLike) -> NDArray:
    """Impedance between a node and the reference, of all elements connected there except sources; shape of s.

    Raises
    ------
    InputError
        As `scattering_parameters`.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end=1, probes={"p": {"at": "a"}},
    ...     lines={"line": {"nodes": ["a", "b"], "z0": 50, "delay": "1 ns"}},
    ...     loads={"end": {"at": "b", "kind": "resistor", "resistance": 100}},
    ... )
    >>> impedance(scene, "a", [2j * np.pi * 0.25e9])[0].real.round(9)  # a quarter wave inverts: 50²/100
    np.float64(25.0)
    """
    s = np.asarray(s, complex)
    found = scattering_parameters(scene, [node], s.ravel())
    h, reference = found[:, 0, 0], found.z0[0]
    with np.errstate(divide="ignore", invalid="ignore"):
        z = reference * (1 + h) / (1 - h)
    return np.where(h == 1, np.inf, z).reshape(s.shape)


def _references(scene: Scene, ports: Sequence[str], z0: float | str | Sequence[float | str] | None) -> NDArray:
    if z0 is None:
        z0 = next((_seen_alone(line, ports[0]) for line in scene.lines.values() if {*ports[:1]} & {*line.nodes}), 1.0)
    each = [z0] * len(ports) if isinstance(z0, str | float | int) else list(z0)
    if len(each) != len(ports):
        raise InputError("z0", "not one for each port", str(len(ports)), str(len(each)))
    R = np.array([to_si(given, MEDIA[scene.medium].units["resistance"], "z0") for given in each], float)
    for value, given in zip(R, each, strict=True):
        if not 0 < value < np.inf:
            raise InputError("z0", "not positive", "more than 0", shown(given))
    return R


def _seen_alone(line: SceneLine | Coupled, port: str) -> float:
    """z0 of a line, or of one of several conductors with the others at zero."""
    if not isinstance(line, Coupled):
        return line.parameters.z0
    conductor = line.nodes.index(port) % len(line.nodes1)
    return 1 / float(line.modes.admittance[conductor, conductor])


def _without_sources(scene: Scene, ports: Sequence[str]) -> Scene:
    kept = {name: source for name, source in scene.table().get("sources", {}).items() if source.get("at") not in ports}
    return scene.with_changes(sources=kept)


def _indices(network: Scattering, ports: Sequence[str]) -> list[int]:
    if not ports:
        raise InputError("ports", "none is named", "nodes of the scene")
    for k, port in enumerate(ports):
        if port not in network.names:
            raise InputError("ports", "no such node", nearest(port, network.names), f"'{port}'")
        if port in ports[:k]:
            raise InputError("ports", "named twice", "each node once", f"'{port}'")
        if network.held[network.names.index(port)]:
            raise InputError("ports", "a load or switch holds the effort there", "another node", f"'{port}'")
    return [network.names.index(port) for port in ports]
