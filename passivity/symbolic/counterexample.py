"""Values of the parameters for which a function is refuted, by the exact test of functions with numbers.

The search is the same each time: first round numbers, each parameter in turn far from the others, then random ones over
few and over many decades. That nothing is found means nothing.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice
from random import Random

from passivity.budget import UndecidedError
from passivity.exact.verdict import Verdict, Witness
from passivity.symbolic.assumption import Range

MAX_TRIALS = 600
MAX_WORK = 400_000  # of all trials together: characters read and squares of degrees
_AT_AN_END = 0.1  # how often
_SPREADS = (1, 2, 6)  # decades
_STEPS = [Fraction(x) for x in ("2", "1/2", "10", "1/10", "9/10", "11/10", "100", "1/100", "1000", "1/1000")]


@dataclass(frozen=True)
class Counterexample:
    """Values of the parameters, and the refutation there.

    Parameters
    ----------
    values : dict of str to Fraction
        For all names in the expression.
    verdict : Verdict
        Of the function with these values; for Z or H with a delay, of the rational reflection H2 in
        H = exp(-delay s) H2, Z = (1 + H)/(1 - H).
    witness : Witness
        The point s and the value there of the function in `verdict`. With a delay |exp(-delay s) H2(s)| > 1, shown
        in ball arithmetic, and so Re Z(s) < 0.
    delay : Fraction
        0 without one.
    """

    values: dict[str, Fraction]
    verdict: Verdict
    witness: Witness
    delay: Fraction

    @property
    def why(self) -> str:
        """The reason in words."""
        if self.delay < 0:
            return "exp(-delay*s) with a negative delay grows without bound"
        return f"of the reflection H behind the delay, {self.verdict.why}" if self.delay else self.verdict.why


def search(
    ranges: tuple[Range, ...], test: Callable[[dict[str, Fraction]], tuple[Counterexample | None, int]]
) -> Counterexample | None:
    """The first counterexample in many trials; a test also tells what part of MAX_WORK it took."""
    work = 0
    for values in islice(_trials(ranges), MAX_TRIALS):
        try:
            found, cost = test(values)
        except UndecidedError:
            return None
        work += cost
        if found or work > MAX_WORK:
            return found
    return None


def _trials(ranges: tuple[Range, ...]) -> Iterator[dict[str, Fraction]]:
    middle = {r.name: _at(r, Fraction(1)) for r in ranges}
    yield middle
    for r in ranges:
        yield from (middle | {r.name: x} for x in _choices(r))
    yield from islice(random_values(ranges), 1, None)


def random_values(ranges: Sequence[Range]) -> Iterator[dict[str, Fraction]]:
    """Values in the middle of the ranges, then random ones without end; without ranges none but {}."""
    yield {r.name: _at(r, Fraction(1)) for r in ranges}
    random = Random(0)
    while ranges:
        for decades in _SPREADS:
            yield {r.name: _any(r, random, decades) for r in ranges}


def _choices(r: Range) -> list[Fraction]:
    """Values that are tried first."""
    two = r.low is None and r.high is None
    steps = [Fraction(1), *_STEPS]
    return _ends(r) + [_at(r, u) for u in _STEPS] + ([-u for u in steps] if two else [])


def _any(r: Range, random: Random, decades: int) -> Fraction:
    ends = _ends(r)
    if ends and random.random() < _AT_AN_END:
        return random.choice(ends)
    u = random.randint(1, 99) * Fraction(10) ** random.randint(-decades, decades) / 10
    x = _at(r, u)
    return -x if r.low is None and r.high is None and random.random() < 0.5 else x


def _ends(r: Range) -> list[Fraction]:
    """The ends that belong to a range; 0 for all real numbers."""
    if r.low is None and r.high is None:
        return [Fraction(0)]
    return [end for end, shut in ((r.low, not r.open_low), (r.high, not r.open_high)) if end is not None and shut]


def _at(r: Range, u: Fraction) -> Fraction:
    """The point of a range that u > 0 stands for, as in `Domain`."""
    if r.low is not None and r.high is not None:
        return (r.low + r.high * u) / (1 + u)
    if r.high is not None:
        return r.high - u
    return u if r.low is None else r.low + u
