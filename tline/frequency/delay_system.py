"""Transfer function of a scene as an object with exact delays."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError
from tline.frequency.oscillations import Resonance, resonances
from tline.frequency.response import Curves, frequencies, respond, source_named, unit_over
from tline.presentation import Presentation
from tline.scene.file import as_scene
from tline.scene.load import Reservoir
from tline.scene.medium import MEDIA
from tline.scene.scene import Scene
from tline.scene.switch import Switch
from tline.solver.description.description import describe
from tline.solver.stability.growth import growth
from tline.words.wording import nearest

if TYPE_CHECKING:
    from control import StateSpace
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LONGEST = 1e6  # shortest delays in a step response


@dataclass(frozen=True, repr=False)
class DelaySystem(Presentation):
    """Response at one probe to one source, as a transfer function with exact delays.

    All other sources are silent, and switches are in their final state.

    Parameters
    ----------
    scene : Scene, or the path of a file
        Linear lines between linear nodes.
    probe : str
        Name of the probe.
    source : str, optional
        Name of the source; not needed if there is one only.
    quantity : {"u", "y", "a", "b"}
        Effort, flow, or one of the waves at the probe.

    Raises
    ------
    InputError
        There is no such probe, source or quantity, or several sources and none is named.

    References
    ----------
    K. Gu, V. L. Kharitonov, J. Chen: Stability of Time-Delay Systems, Birkhäuser 2003.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end=1, probes={"far": {"at": "far"}},
    ...     lines={"line": {"nodes": ["near", "far"], "z0": 50, "delay": "1 ns"}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 25}},
    ...     loads={"c": {"at": "far", "kind": "parallel", "resistance": 100, "capacitance": "4 pF"}},
    ... )
    >>> H = DelaySystem(scene, "far")
    >>> bool(abs(H(0) - 0.8) < 1e-12), H.is_stable()
    (True, True)
    >>> H.step([0.9e-9, 1e-6]).round(9).tolist()  # nothing arrives before the delay
    [0.0, 0.8]
    >>> bool(abs(H.to_control(6)(2e9j) - H(2e9j)) < 1e-6)
    True
    """

    scene: Scene
    probe: str
    source: str | None = None
    quantity: Literal["u", "y", "a", "b"] = "u"

    def __post_init__(self) -> None:
        object.__setattr__(self, "scene", as_scene(self.scene))
        if not isinstance(self.probe, str) or self.probe not in self.scene.probes:
            raise InputError("probe", "no such probe", nearest(self.probe, list(self.scene.probes)), f"'{self.probe}'")
        if self.quantity not in ("u", "y", "a", "b"):
            raise InputError("quantity", "unknown", "'u', 'y', 'a' or 'b'", f"'{self.quantity}'")
        object.__setattr__(self, "source", source_named(self.scene, self.source))

    def __call__(self, s: ArrayLike) -> Any:
        """Value at any complex s, 1/s, of its shape."""
        value = getattr(respond(self.scene, s, self.source)[self.probe], self.quantity)
        return value if value.ndim else complex(value)

    def _curves(self) -> Curves:
        s, medium, source = 2j * np.pi * frequencies(self.scene), MEDIA[self.scene.medium], str(self.source)
        what = f"{medium.flow if self.quantity == 'y' else medium.effort} / {source}"
        return Curves(self.scene, s, {self.probe: self(s)}, what, unit_over(self.scene, source, self.quantity))

    def text_lines(self) -> Iterable[str]:
        """Lowest and highest magnitude over frequencies around those of the lines, and natural oscillations."""
        return self._curves().text_lines()

    def plot(self, ax: "Axes | None" = None) -> "Figure | Axes":
        """Draw a Bode plot, over frequencies around those of the lines."""
        return self._curves().plot(ax)

    def to_dict(self) -> dict[str, Any]:
        """Curve of the plot, and natural oscillations."""
        return self._curves().to_dict() | {"source": self.source}

    def bode(self, f: ArrayLike) -> tuple[NDArray, NDArray]:
        """Magnitude, and phase in rad without jumps, at frequencies f, Hz, in rising order.

        The phase is right only if neighbouring frequencies are close enough to turn it by less than pi.
        """
        value = self(2j * np.pi * np.atleast_1d(np.asarray(f, float)))
        return np.abs(value), np.unwrap(np.angle(value))

    def step(self, t: ArrayLike, tol: float = 1e-8) -> NDArray:
        """Response to a unit step of the source at t = 0, from rest, at instants t, s; 0 before.

        Parameters
        ----------
        t : array_like
        tol : float
            Tolerance of the run that computes it.

        Raises
        ------
        InputError
            An instant is not finite, or beyond 1e6 shortest delays.
        ActiveError
            A load is active.
        """
        from tline.solver.simulate import simulate

        t = np.asarray(t, float)
        shortest = min(line.parameters.delay or 0.0 for line in self.scene.lines.values())
        last = max(float(t.max(initial=0.0)), shortest)
        if not last <= LONGEST * shortest:
            raise InputError(
                "t", "an instant beyond the longest run", f"at most {LONGEST * shortest:.3g} s", f"{last:.3g} s"
            )
        stepped = self._with_a_step().with_changes(t_end=last, start="rest", solver={})
        seen = simulate(stepped, tol=tol).probes[self.probe].at(np.maximum(t, 0.0).ravel())
        return np.where(t > 0, getattr(seen, self.quantity).reshape(t.shape), 0.0)

    def is_stable(self) -> bool:
        """Whether no natural oscillation grows; those that neither grow nor decay count as stable.

        The count uses the argument principle on samples of the boundary: reliable, not certified.

        Raises
        ------
        InputError
            The scene is too large to be searched.
        """
        found = growth(describe(self.scene))
        if found is None:
            raise InputError("scene", "too large to be searched for growing waves", "fewer lines, or shorter ones")
        return found.s is None

    def oscillations(self, highest: float) -> list[Resonance]:
        """Natural oscillations up to a frequency, Hz: poles of the transfer function, if observable at the probe."""
        return resonances(self.scene, highest)

    def to_control(self, order: int) -> "StateSpace":
        """Convert to a state space of python-control (extra `tline[control]`) with a Padé approximation of every delay.

        Parameters
        ----------
        order : int, 1 to 12
            Degree n of the denominators; numerators have degree n - 1, so that every approximation is bounded real and
            a passive scene stays stable.

        Raises
        ------
        InputError
            The order is out of range.

        References
        ----------
        E. Hairer, G. Wanner: Solving Ordinary Differential Equations II (1996), theorem IV.4.12: these
        approximations do not exceed 1 on the imaginary axis.
        """
        from tline.frequency.pade import pade_state_space

        return pade_state_space(self._with_a_step(), self.probe, self.quantity, order)

    def _with_a_step(self) -> Scene:
        """Return the scene without heights, with a unit step in the source, others at zero, and switches moved."""
        table = self.scene.table()
        silent = {
            name: source | {"value": {"shape": "constant", "level": 0}} for name, source in table["sources"].items()
        }
        silent[self.source]["value"] = {"shape": "step", "to": 1}
        changed: dict[str, dict[str, Any]] = {"loads": {}, "links": {}}
        for (part, name), element in self.scene.placed:
            still = {"time": -1} if isinstance(element, Switch) else {}
            still |= {"pressure": 0} if isinstance(element, Reservoir) else {}
            changed[part][name] = table[part][name] | still
        return self.scene.with_changes(sources=silent, nodes={}, **changed)
