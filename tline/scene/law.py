"""Laws of elements as the solver needs them: one record per kind, constants, and the motion of the opening."""

from collections.abc import Callable, Iterator, Sequence
from math import inf
from typing import Any, ClassVar, NamedTuple

from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.element import Element, OneMedium
from tline.scene.shape import Shape

Constants = Sequence[float] | NDArray
ANY_DROP = -inf, inf


class Bend(NamedTuple):
    """Wave at which a law kinks: a constant part, and one proportional to a power of the control signal.

    Of a store it is the effort that drives its flow. Beside it the law turns sharply within a layer of waves, whose
    width is as the square of the control signal; 0 if it does not.
    """

    constant: float
    varying: float = 0.0
    power: int = 1
    layer: float = 0.0


class Volume(NamedTuple):
    """Vessel or tank behind an orifice: its content as a function of the effort inside, and the orifice."""

    held: Callable[[NDArray], NDArray]
    capacity: float


class LawKind:
    """Properties of a kind of law; a subclass states its differences from a smooth, passive law without a state.

    Methods take the constants of an element, beginning with the effort beyond it.
    """

    name: ClassVar[str]
    unit: ClassVar[str]  # module in the kernel and name of the compiled unit that computes its flow
    control: ClassVar[str] = "opening"  # key of the control signal that scales it over time
    states: ClassVar[int] = 0  # number of states
    # supplies, returns: whether it is a source of energy, or may return energy that it took
    supplies: ClassVar[bool] = False
    returns: ClassVar[bool] = False
    steep: ClassVar[bool] = False  # whether its flow may change behind a front faster than slabs resolve
    breaks: ClassVar[bool] = False  # whether it sends fronts at instants of its own, which are not followed
    steady: ClassVar[str] = ""  # name of its law in the steady state; its own if empty
    number: ClassVar[int]  # index in `KINDS`

    def __init_subclass__(cls) -> None:
        if cls.name in KINDS:
            raise TypeError(f"{cls.__name__}: another law is called '{cls.name}'")
        if bool(cls.states) != (cls.at_rest is not LawKind.at_rest):
            raise TypeError(f"{cls.__name__}: a law with 'states' says in 'at_rest' how they begin, and no other does")
        cls.number = len(KINDS)
        KINDS[cls.name] = cls()

    @property
    def fills(self) -> bool:
        """Whether no steady flow passes it."""
        return self.states > 0 and not self.steady

    def at_rest(self, c: Constants, effort: float, control: float) -> tuple[float, ...]:
        """State in equilibrium with an effort at the node, and a control signal."""
        return ()

    def begun(self, c: Constants, drop: float, flow: float) -> Constants:
        """Constants of the element, with those that follow from drop and flow before the run."""
        return c

    def capacity(self, c: Constants, effort: float) -> float:
        """Inflow per small rise of the effort; zero for elements without storage."""
        return 0.0

    def bends(self, c: Constants, rho: float) -> Iterator[Bend]:
        """Waves e + ρ i at which the law kinks."""
        yield from ()

    def knees(self, c: Constants, rho: float) -> Iterator[Bend]:
        """Waves e + ρ i beside which the law turns within a layer, without a kink."""
        yield from ()

    def holds(self, c: Constants, control: float) -> tuple[float, float]:
        """Least and largest drop at which nothing passes; both zero if the flow stops only at balance."""
        return 0.0, 0.0

    def tightness(self, c: Constants, control: float, largest: float) -> float:
        """Drop over flow of a square-root law so steep that it is nearly a jump, at the largest effort; else zero."""
        return 0.0

    def source(self, c: Constants) -> str:
        """Explanation if the law is not passive."""
        return ""

    def flow(self, c: Constants) -> Callable[[NDArray], NDArray] | None:
        """Flow as in a textbook, over the drop beyond c[0], fully open; None if the independent check leaves it out."""
        return None

    def volume(self, c: Constants) -> Volume | None:
        """Content of a store as in a textbook; None if the independent check leaves it out."""
        return None


KINDS: dict[str, LawKind] = {}


def kinds_numbered(numbers: Sequence[int]) -> list[LawKind]:
    """Kinds of laws with these numbers."""
    known = list(KINDS.values())
    return [known[number] for number in numbers]


class Governor(NamedTuple):
    """Motion of the opening x of an element, from 0 to 1, in a run: by itself, or by the inertia of a disc.

    With u and w the efforts at its nodes and i its flow, the drive d is a (u - u0) + b (w - w0) + c (i - i0) - k x.
    Then x' = d within the slowest and the fastest rate, or with an inertia M and a damping D, M x'' = d - D x'.
    """

    # here, there, through: (a, u0), (b, w0) and (c, i0); nan stands for the value at the start
    here: tuple[float, float] = (0.0, 0.0)
    there: tuple[float, float] = (0.0, 0.0)
    through: tuple[float, float] = (0.0, 0.0)
    own: float = 0.0  # k
    rates: tuple[float, float] = (-inf, inf)  # slowest and fastest, 1/s
    inertia: float = 0.0
    damping: float = 0.0
    shares: tuple[tuple[float, float], ...] = ()  # openings and shares of the capacity; none where both are equal
    start: float | None = None  # opening at the start; None for that of the steady state
    area: float = 0.0  # of a disc, m²

    def flat(self) -> tuple[float, ...]:
        """Constants in the order of the kernel."""
        openings, shares = zip(*self.shares, strict=True) if self.shares else ((), ())
        sums = *self.here, *self.there, *self.through, self.own, *self.rates
        return (*sums, self.inertia, self.damping, float(len(self.shares)), *openings, *shares)


class Shown(NamedTuple):
    """Quantity that an element shows over time, in addition to efforts and flows at its nodes."""

    word: str
    unit: str  # SI
    # from the element, one of its states and the flow into it; None where the element has no such quantity
    of: Callable[[Any, NDArray, NDArray], NDArray | None]
    last: bool = False  # whether it uses the last state, not the first


GAS_VOLUME, AIR_VOLUME = "gas volume", "air volume"
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
        """Properties of the kind of law."""
        return KINDS[self.kind]


class NonLinear(Element):
    """Element with a non-linear law, and the quantities it shows."""

    shows: ClassVar[tuple[Shown, ...]] = ()

    @property
    def mistake_at_rest(self) -> InputError | None:
        """Mistake if the run starts at rest, not in a steady state."""
        return None

    def law(self) -> ElementLaw:
        """Law of the element for the solver."""
        raise NotImplementedError


class OfCables(OneMedium, NonLinear):
    """Non-linear element for cables only."""

    medium, instead = "electrical", "such as 'orifice' or 'table'"


class OfLiquids(OneMedium, NonLinear):
    """Non-linear element for pipes only."""

    medium, instead = "hydraulic", "such as 'resistor', 'diode' or 'table'"
