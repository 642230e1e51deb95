"""Time-domain reflectometry: a step with a real rise time sent into a node, and the reflected wave."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.atomic import write_columns
from tline.errors import InputError
from tline.presentation import Presentation, plain
from tline.scene.coupled import Coupled
from tline.scene.file import as_scene
from tline.scene.medium import ELECTRICAL, MEDIA, Medium
from tline.scene.scene import Scene
from tline.signal.bits import above_zero
from tline.solver.result.dense_output import curve
from tline.solver.simulate import simulate
from tline.words.wording import nearest, shown

TOL = 1e-6
MOST_REFLECTED = 1.01  # energy of the reflected wave over that of the step; the excess is rounding and tolerance


@dataclass(frozen=True, eq=False, repr=False)
class Reflections(Presentation):
    """Response of a time-domain reflectometer: reflected wave and impedance profile.

    Attributes
    ----------
    t : ndarray, shape (n,)
        Instants, s, from the begin of the step on; a place a delay T down the line answers after 2 T.
    incident, reflected : ndarray
        Waves at the node, parts of its effort, in units of the step.
    z0 : float
        Of the instrument, ohm or Pa s/m³.
    node : str
        Where the instrument is.
    medium : Medium
        Words and units.
    title : str
        Of the scene.
    """

    t: NDArray
    incident: NDArray
    reflected: NDArray
    z0: float
    node: str = ""
    medium: Medium = ELECTRICAL
    title: str = ""
    picture = "tline.pictures.signals:plot_reflections"

    def text_lines(self) -> Iterator[str]:
        """The lowest and the highest reflection, and the impedances there."""
        unit = self.medium.units["resistance"]
        yield f"step into '{self.node}' from {self.z0:.6g} {unit}, reflected wave per step:"
        for word, k in (("lowest", self.reflected.argmin()), ("highest", self.reflected.argmax())):
            z = self.impedance[k]
            size = f"{z:.6g} {unit}" if np.isfinite(z) else "open"
            yield f"  {word} {self.reflected[k]:.6g} at {self.t[k]:.6g} s: {size}"

    def to_dict(self) -> dict[str, Any]:
        """Waves and impedances, in SI; None where all is reflected."""
        names = ("z0", "t", "incident", "reflected", "impedance")
        return plain({name: getattr(self, name) for name in names})

    @property
    def impedance(self) -> NDArray:
        """Profile z0 (1 + ρ)/(1 - ρ), as if each reflection had come back on its first way; infinite where ρ is 1."""
        with np.errstate(divide="ignore"):
            return np.where(self.reflected < 1, self.z0 * (1 + self.reflected) / (1 - self.reflected), np.inf)

    def save(self, path: str | Path) -> None:
        """Write as CSV: time in s, incident and reflected wave per step, impedance in SI (inf where all comes back).

        Parameters
        ----------
        path : str or Path

        Raises
        ------
        InputError
            The file cannot be written.
        """
        waves = {"incident": self.incident, "reflected": self.reflected, "impedance": self.impedance}
        write_columns(path, {"time [s]": self.t} | waves)


def reflectometry(
    scene: Scene | str | Path,
    node: str,
    rise: float | str,
    z0: float | str | None = None,
    t_end: float | str | None = None,
    *,
    tol: float = TOL,
    progress: bool = False,
) -> Reflections:
    """Send a step into a node and record the reflection; sources there are taken away, all others are silent.

    Parameters
    ----------
    scene : Scene, or the path of a file
        At rest before the step.
    node : str
        Where the instrument is.
    rise : float or str
        Time that the step takes, a straight ramp, s, above zero.
    z0 : float or str, optional
        Resistance of the instrument, above zero; that of the first line at the node if not given.
    t_end : float or str, optional
        How long to look, s; until the scene's end if not given.
    tol : float, 1e-13 to 0.1
        Largest error of the waves, relative to the step.
    progress : bool
        Show a progress bar on stderr if the run takes more than two seconds.

    Raises
    ------
    InputError
        There is no such node, a number is out of range, or more comes back than was sent.

    References
    ----------
    D. M. Pozar, Microwave Engineering, 4th ed., Wiley 2012, section 2.3: z = z0 (1 + ρ)/(1 - ρ).

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end="9 ns", probes={"p": {"at": "far"}},
    ...     lines={"cable": {"nodes": ["near", "far"], "z0": 75, "delay": "2 ns"}},
    ...     loads={"end": {"at": "far", "kind": "resistor", "resistance": 30}},
    ... )
    >>> found = reflectometry(scene, "near", "0.1 ns", 50)
    >>> float(np.interp(2e-9, found.t, found.impedance).round(6))  # the cable itself
    75.0
    """
    scene = as_scene(scene)
    lines = [line for line in scene.lines.values() if node in line.nodes]
    if not lines:
        nodes = list(dict.fromkeys(at for line in scene.lines.values() for at in line.nodes))
        raise InputError("node", "no line ends at this node", nearest(node, nodes), shown(node))
    if z0 is None and isinstance(lines[0], Coupled):
        raise InputError("z0", "conductors that are coupled have none of their own", "that of the instrument")
    resistance = lines[0].parameters.z0 if z0 is None else above_zero(z0, "z0", None)
    duration, table = above_zero(rise, "rise"), scene.table()
    kept = {name: source for name, source in table.get("sources", {}).items() if source.get("at") != node}
    sources = {name: source | {"value": 0} for name, source in kept.items()}
    effort = "voltage" if scene.medium == "electrical" else "pressure"
    ramp = {"shape": "ramp", "to": 2, "duration": duration}
    sources["instrument"] = {"at": node, "kind": effort, "value": ramp, "resistance": resistance}
    line = next(name for name, line in scene.lines.items() if node in line.nodes)
    table |= {"sources": sources, "probes": {"node": {"at": node, "line": line}}, "measures": {}, "start": "rest"}
    table |= {} if t_end is None else {"t_end": above_zero(t_end, "t_end")}
    seen = curve(simulate(scene.with_changes(**table), tol=tol, progress=progress).probes["node"])
    incident = np.clip(seen.t / duration, 0.0, 1.0)
    reflected = seen.u - incident
    sent, back = (np.diff(seen.t) @ (wave[1:] ** 2 + wave[:-1] ** 2) for wave in (incident, reflected))
    if back > MOST_REFLECTED * sent:
        problem = "more energy comes back than the step brings, for something else drives the scene"
        raise InputError("node", problem, "a scene that is at rest where its sources are silent")
    return Reflections(seen.t, incident, reflected, resistance, node, MEDIA[scene.medium], scene.title)
