"""A baseline method: what it is called, of which order it is, what it can do."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from numpy.typing import NDArray

from tline.errors import InputError
from tline.loss.losses import Losses
from tline.scene.cavities import with_cavities
from tline.scene.scene import Scene
from tline.words.wording import place


class BaselineRun(NamedTuple):
    """Instants, effort of each probe at these, and the seconds that time stepping took."""

    t: NDArray
    u: dict[str, NDArray]
    seconds: float


@dataclass(frozen=True)
class Baseline:
    """A method beside which the production method stands.

    Attributes
    ----------
    label : str
        For charts.
    order : int
        Of the error in 1/n, for smooth waves between resistances.
    load_order : int
        The same for dynamic loads; the lower of both holds.
    solve : callable
        From a scene and n to a trace.
    unfit : callable
        From a scene to why this method cannot do it, or None.
    knows : str
        What lines may lose by: "nothing", "resistance", or "friction", then also from a steady start.

    Examples
    --------
    >>> from tline.study.baseline import BASELINES
    >>> scene = Scene(
    ...     medium="electrical", t_end=3, probes={"far": {"at": "far"}},
    ...     lines={"line": {"nodes": ["near", "far"], "z0": 1, "delay": 1}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "resistance": 1, "value": {"shape": "ramp", "to": 1,
    ...         "duration": 1}}},
    ... )
    >>> BASELINES["moc_trapezoid"].run(scene, 2).u["far"].tolist()
    [0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0]
    """

    label: str
    order: int
    load_order: int
    solve: Callable[[Scene, float], BaselineRun]
    unfit: Callable[[Scene], str | None] = lambda scene: None
    knows: str = "nothing"

    def incompatibility(self, scene: Scene) -> str | None:
        """Why this method cannot do a scene; None if it can."""
        for part, name in scene.laws:
            return f"{place(part, name)}: baseline methods know linear elements only"
        for name in with_cavities(scene.lines):
            return f"{place('lines', name, 'cavities')}: baseline methods know linear elements only"
        for where, _ in scene.between:
            return f"{where}: baseline methods know nothing between nodes"
        for name, load in scene.loads.items():
            if load.kind in ("switch", "valve"):
                return f"{place('loads', name)}: baseline methods have no switches"
        for name, probe in scene.probes.items():
            if probe.at is None:
                return f"{place('probes', name)}: baseline methods see nodes only"
        for name, line in scene.lines.items():
            if line.losses and not _takes(line.losses, self.knows):
                return f"{place('lines', name)}: loses what this method does not know"
        if scene.start != "rest" and self.knows != "friction":
            return "start: baseline methods start at rest only"
        return self.unfit(scene)

    def run(self, scene: Scene, n: float) -> BaselineRun:
        """Run a scene with n steps per shortest delay.

        Raises
        ------
        InputError
            The method cannot do the scene (`incompatibility` says why), or n is too small or too large for it.
        """
        if why := self.incompatibility(scene):
            raise InputError("", f"{self.label}: {why}")
        if not n >= 2:
            raise InputError("n", "too few steps per shortest delay", "at least 2", f"{n}")
        return self.solve(scene, n)


def _takes(losses: Losses, known: str) -> bool:
    """Whether a method that knows that much can do a line."""
    if known == "friction":
        return losses.only_quadratic
    return known == "resistance" and losses.constant is not None and not losses.constant[1]
