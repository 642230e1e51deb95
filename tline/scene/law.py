"""What an element of a scene tells the solver: the kind of its law, its constants, and what scales it over time."""

from collections.abc import Callable
from math import inf
from typing import Any, ClassVar, NamedTuple

from numpy.typing import NDArray

from tline.scene.element import Element, OneMedium
from tline.scene.kind import KINDS, LawKind
from tline.scene.shape import Shape


class Governor(NamedTuple):
    """What moves the opening x of an element, from 0 to 1, in a run: by itself, or by the inertia of a disc.

    With u and w the efforts at its nodes and i its flow, the drive d is a (u - u0) + b (w - w0) + c (i - i0) - k x.
    Then x' = d within the slowest and the fastest rate, or with an inertia M and a damping D, M x'' = d - D x'.
    """

    # here, there, through: (a, u0), (b, w0) and (c, i0); a value that is not a number is the one at the start
    here: tuple[float, float] = (0.0, 0.0)
    there: tuple[float, float] = (0.0, 0.0)
    through: tuple[float, float] = (0.0, 0.0)
    own: float = 0.0  # k
    rates: tuple[float, float] = (-inf, inf)  # slowest and fastest, 1/s
    inertia: float = 0.0
    damping: float = 0.0
    shares: tuple[tuple[float, float], ...] = ()  # openings and shares of the capacity; none where both are equal
    start: float | None = None  # opening at the start; the one that the steady state asks for if None
    area: float = 0.0  # of a disc, m²

    def flat(self) -> tuple[float, ...]:
        """Constants, as the kernel has them."""
        openings, shares = zip(*self.shares, strict=True) if self.shares else ((), ())
        sums = *self.here, *self.there, *self.through, self.own, *self.rates
        return (*sums, self.inertia, self.damping, float(len(self.shares)), *openings, *shares)


class Shown(NamedTuple):
    """A quantity that an element shows over time, beside efforts and flows at its nodes."""

    word: str
    unit: str  # SI
    of: Callable[[Any, NDArray, NDArray], NDArray]  # from the element, its state and the flow into it


OPENING = Shown("opening", "", lambda element, state, flow: state)


class ElementLaw(NamedTuple):
    """Flow as a function of the effort across an element."""

    kind: str
    constants: tuple[float, ...]
    factor: Shape | None = None  # opening or speed over time, 1 without it
    reverse: bool = False  # whether it looks from the second node, or the reference, to the first
    governor: Governor | None = None  # of its opening, in place of a factor

    @property
    def of_kind(self) -> LawKind:
        """What there is to know of its kind."""
        return KINDS[self.kind]


class NonLinear(Element):
    """An element with such a law, and what it shows."""

    shows: ClassVar[tuple[Shown, ...]] = ()

    def law(self) -> ElementLaw:
        """What the solver needs to know of it."""
        raise NotImplementedError


class OfCables(OneMedium, NonLinear):
    """One that only cables have."""

    medium, instead = "electrical", "such as 'orifice' or 'table'"


class OfLiquids(OneMedium, NonLinear):
    """One that only pipes have."""

    medium, instead = "hydraulic", "such as 'resistor', 'diode' or 'table'"
