"""What an element tells the solver of its law: its kind, one record each, its constants, and what moves it."""

from collections.abc import Callable, Iterator, Sequence
from math import inf
from typing import Any, ClassVar, NamedTuple

from numpy.typing import NDArray

from tline.scene.element import Element, OneMedium
from tline.scene.shape import Shape

Constants = Sequence[float] | NDArray
ANY_DROP = -inf, inf


class Bend(NamedTuple):
    """A wave at which a law kinks: a part that stays, and one in proportion to a power of the control signal.

    Of a store it is the effort that drives its flow.
    """

    constant: float
    varying: float = 0.0
    power: int = 1


class Volume(NamedTuple):
    """A vessel or tank behind an orifice: what it holds as a function of the effort inside, and the orifice."""

    held: Callable[[NDArray], NDArray]
    capacity: float


class LawKind:
    """What there is to know of a kind of law; a subclass says what differs from a smooth, passive law without a state.

    Its methods get the constants of an element, the first of which is the effort beyond it.
    """

    name: ClassVar[str]
    unit: ClassVar[str]  # module in the kernel and name of the compiled unit that tells its flow
    control: ClassVar[str] = "opening"  # key of the control signal that scales it over time
    states: ClassVar[int] = 0  # number of states
    # supplies, returns: whether it is a source of energy, or may give back what it took
    supplies: ClassVar[bool] = False
    returns: ClassVar[bool] = False
    fills: ClassVar[bool] = False  # whether no steady flow passes it
    steep: ClassVar[bool] = False  # whether its flow may change behind a front faster than slabs resolve
    breaks: ClassVar[bool] = False  # whether it sends fronts at instants of its own, which are not followed
    steady: ClassVar[str] = ""  # LawKind of law that it has in the steady state; its own name without one
    number: ClassVar[int]  # place in `KINDS`

    def __init_subclass__(cls) -> None:
        cls.number = len(KINDS)
        KINDS[cls.name] = cls()

    def at_rest(self, c: Constants, effort: float, control: float) -> tuple[float, ...]:
        """State in equilibrium with an effort at its node, and a control signal."""
        return ()

    def begun(self, c: Constants, drop: float, flow: float) -> Constants:
        """The constants, with those that follow from the drop and the flow before the run."""
        return c

    def capacity(self, c: Constants, effort: float) -> float:
        """What flows in for a small rise of the effort, over that rise; zero of what holds nothing."""
        return 0.0

    def bends(self, c: Constants, rho: float) -> Iterator[Bend]:
        """Waves e + ρ i at which it kinks."""
        yield from ()

    def holds(self, c: Constants, control: float) -> tuple[float, float]:
        """Least and largest drop at which nothing passes; both zero of what nothing but balance stops."""
        return 0.0, 0.0

    def tightness(self, c: Constants, control: float, largest: float) -> float:
        """Drop over flow of a root so tight that it is nearly a jump, at the largest effort; else zero."""
        return 0.0

    def source(self, c: Constants) -> str:
        """What there is to say if it is not passive."""
        return ""

    def flow(self, c: Constants) -> Callable[[NDArray], NDArray] | None:
        """Flow as a textbook writes it, over the drop beyond c[0], fully open; None if the witness is not to ask."""
        return None

    def volume(self, c: Constants) -> Volume | None:
        """What a store holds, as a textbook writes it; None if the witness is not to ask."""
        return None


KINDS: dict[str, LawKind] = {}


def kinds_numbered(numbers: Sequence[int]) -> list[LawKind]:
    """The kinds at these places."""
    known = list(KINDS.values())
    return [known[number] for number in numbers]


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
    # from the element, a state of it and the flow into it; None where that element has no such thing
    of: Callable[[Any, NDArray, NDArray], NDArray | None]
    last: bool = False  # whether that is its last state, and not its first


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
