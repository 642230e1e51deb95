"""Is an impedance positive real, or a reflection bounded real, for all values its parameters may have?"""

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from itertools import islice

from passivity.budget import VERDICT, UndecidedError, budget
from passivity.calculus.question import Question as Asked
from passivity.errors import shorten
from passivity.expression.number import written
from passivity.status import Status
from passivity.symbolic.assumption import Range, trials
from passivity.symbolic.formula import Claim, Condition, Joined
from passivity.symbolic.question import Question
from passivity.verdict import Verdict, Witness

MAX_TRIALS = 600
MAX_WORK = 400_000  # of all trials together: characters read and squares of degrees
_SHOWN = 200  # characters of all values in a reason


def decide(asked: Asked, made: partial) -> Verdict:
    """The verdict by polynomials in the parameters, with a search for values that refute."""
    text, free = asked.text, made.keywords["ranges"]
    question, formula, limit = None, None, "neither a proof nor a counterexample was found"
    try:
        with budget(VERDICT // 3):
            question = Question.of(asked.kind, asked.graph, asked.value, free)
            formula = question.formula()
    except UndecidedError as error:
        limit = str(error)
    if question and formula is True:
        why = "the exact test holds, whatever the parameters are"
        return made(Status.PROVED, reason=why, steps=tuple(question.lines()), note=question.note())
    condition, note = None, question.note() if question else ""
    if question and isinstance(formula, Claim | Joined):
        condition = Condition(formula, free, question.whole)

    def trial(values: dict[str, Fraction]) -> tuple[tuple[Witness, str] | None, int]:
        if condition and condition.formula.holds(values):
            return None, len(text)
        assert question is not None
        return question.refutation(values, asked), question.work

    if question and (found := _search(free, trial)):
        witness, why = found
        at = ", ".join(f"{name} = {written(x)}" for name, x in witness.names.items()) or "these numbers"
        why = f"not for {shorten(at, _SHOWN)}: {why}"
        return made(Status.REFUTED, reason=why, condition=condition, witness=witness, note=note)
    help_ = f"whether the assumptions imply {condition}" if condition else "values for the parameters"
    return made(Status.UNDECIDED, reason=f"{limit}; to settle it: {help_}", condition=condition, note=note)


def _search(
    ranges: tuple[Range, ...], test: Callable[[dict[str, Fraction]], tuple[tuple[Witness, str] | None, int]]
) -> tuple[Witness, str] | None:
    """The first counterexample in many trials; a test also tells what part of MAX_WORK it took."""
    work = 0
    for values in islice(trials(ranges), MAX_TRIALS):
        try:
            found, cost = test(values)
        except UndecidedError:
            return None
        work += cost
        if found or work > MAX_WORK:
            return found
    return None
