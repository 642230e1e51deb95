"""Kinds of laws: one record for each, made in the file of the element that has it, and read by all of the solver."""

from collections.abc import Callable, Iterator, Sequence
from math import inf
from typing import ClassVar, NamedTuple

from numpy.typing import NDArray

Constants = Sequence[float] | NDArray


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


ANY_DROP = -inf, inf
