"""Transfer function of a scene as an object with exact delays, or as a state space with Padé approximations."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError, import_extra
from tline.frequency.oscillations import Resonance, resonances
from tline.frequency.response import Curves, frequencies, respond, source_named, unit_over
from tline.presentation import Presentation
from tline.scene.file import as_scene
from tline.scene.load import Reservoir, Switch
from tline.scene.medium import MEDIA
from tline.scene.refuse import refuse_losses
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.description.nodes import node_of_end, weights_of
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


HIGHEST = 12  # order; the coefficients of higher ones are too far apart for floats


def pade_state_space(scene: Scene, probe: str, quantity: str, order: int) -> "StateSpace":
    """State space from a source of final level 1, all others being silent, to u, y, a or b at a probe.

    Raises InputError: the order is out of range, or the scene has no state space with Padé delays.
    """
    control = import_extra("control", "python-control", "control", "state space")
    from scipy.linalg import block_diag

    if type(order) is not int or not 1 <= order <= HIGHEST:
        raise InputError("order", "not an order", f"a whole number from 1 to {HIGHEST}", f"{order}")
    refuse_losses(scene, "no state space with Padé delays")
    description = describe(scene)
    description.check_linear("a state space")
    description.refuse_coupled("a state space")
    groups, named = description.grouped()
    lines, nodes = list(scene.lines.values()), list(named.values())
    delays = np.array([line.parameters.delay or 0.0 for line in lines])
    z0, second = np.array([line.parameters.z0 for line in lines]), float(delays.min())
    name = scene.probed_line(probe)
    k, share = (
        (0, 0.0) if name is None else (list(scene.lines).index(name), scene.probes[probe].fraction(scene.lines[name]))
    )

    # each end's sent wave is delayed by its line; those of the probe's line also on their way to a probe inside
    fed_by = [*range(2 * len(lines)), 2 * k, 2 * k + 1]
    chains = [_delay(t, order) for t in [*np.repeat(delays / second, 2), share * delays[k] / second]]
    chains.append(_delay((1 - share) * delays[k] / second, order))
    A, b, c, d = (np.array(block_diag(*parts)) for parts in zip(*chains, strict=True))
    n = len(A)

    # rows over the states of delays, those of loads, and the source
    systems = [group.circuit(np.inf).system for group in groups]
    own, into, out, through = (
        np.array(block_diag(*parts))
        for parts in zip(*((s.A * second, s.b * second, s.c, s.d) for s in systems), strict=True)
    )
    m = len(own)
    arriving = np.zeros((2 * len(lines), n + m + 1))
    arriving[:, :n] = c[[e ^ 1 for e in range(2 * len(lines))]]
    thevenin = np.array([weights_of([node], z0) @ arriving[node.ends] for node in nodes])
    thevenin[:, -1] = [
        sum(f * float(w.value(np.array(1.0), np.array(1.0))) for w, f in node.excitations) for node in nodes
    ]
    states = np.eye(n + m + 1)[n : n + m]
    efforts = through @ thevenin + out @ states
    sent = 2 * efforts[node_of_end(nodes)] - arriving

    rates = np.vstack([b @ sent[fed_by], own @ states + into @ thevenin])
    rates[:n, :n] += A
    wave_a, wave_b = c[-2:] @ np.eye(n, n + m + 1) + d[-2:] @ sent[fed_by]
    if name is None:
        wave_a = wave_b = efforts[list(named).index(scene.probes[probe].at or "")]
    row = {"a": wave_a, "b": wave_b, "u": (wave_a + wave_b) / 2, "y": (wave_a - wave_b) / (2 * z0[k])}[quantity][None]
    return control.StateSpace(rates[:, :-1] / second, rates[:, -1:] / second, row[:, :-1], row[:, -1:])


def _delay(t: float, order: int) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Matrices A, b, c, d of the Padé approximation of exp(-ts), numerator of one degree less; no states for t = 0."""
    control = import_extra("control", "python-control", "control", "state space")

    if t == 0:
        return np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), np.ones((1, 1))
    up, down = control.pade(1.0, order, order - 1)
    A = np.diag(np.ones(order - 1), 1)
    A[-1] = -np.array(down[:0:-1]) / down[0]
    c = np.array(up[::-1]) / down[0]
    b = np.zeros((order, 1))
    b[-1] = 1.0
    return A / t, b / t, c[None], np.zeros((1, 1))
