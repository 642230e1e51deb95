"""Is an impedance positive real, or a reflection bounded real, for all values its parameters may have?"""

from functools import partial
from itertools import islice

from passivity.budget import VERDICT, UndecidedError, budget
from passivity.calculus.question import Question as Asked
from passivity.errors import shorten
from passivity.expression.number import written
from passivity.status import Status
from passivity.symbolic.assumption import trials
from passivity.symbolic.formula import Claim, Condition, Joined
from passivity.symbolic.question import Question
from passivity.verdict import Verdict

MAX_TRIALS = 600
MAX_WORK = 400_000  # of all trials together: characters read and squares of degrees
_SHOWN = 200  # characters of all values in a reason


def decide(asked: Asked, made: partial) -> Verdict:
    """The verdict by polynomials in the parameters, with a search for values that refute."""
    free = made.keywords["ranges"]
    question, formula, limit = None, None, "neither a proof nor a counterexample was found"
    try:
        with budget(VERDICT // 3):
            question = Question.of(asked.kind, asked.graph, asked.value, free)
            formula = question.formula()
    except UndecidedError as error:
        limit = str(error)
    if question is None:
        return made(Status.UNDECIDED, reason=f"{limit}; to settle it: values for the parameters")
    if formula is True:
        why = "the exact test holds, whatever the parameters are"
        return made(Status.PROVED, reason=why, steps=tuple(question.lines()), note=question.note())
    condition, note = None, question.note()
    if isinstance(formula, Claim | Joined):
        condition = Condition(formula, free, question.whole)

    work = 0  # done in the trials
    for values in islice(trials(free), MAX_TRIALS):
        holds = condition is not None and condition.formula.holds(values)
        work += len(asked.text) if holds else question.work
        try:
            found = None if holds else question.refutation(values, asked)
        except UndecidedError:
            break
        if found:
            witness, why = found
            at = shorten(", ".join(f"{name} = {written(x)}" for name, x in witness.names.items()), _SHOWN)
            return made(Status.REFUTED, reason=f"not for {at}: {why}", condition=condition, witness=witness, note=note)
        if work > MAX_WORK:
            break
    help_ = f"whether the assumptions imply {condition}" if condition else "values for the parameters"
    return made(Status.UNDECIDED, reason=f"{limit}; to settle it: {help_}", condition=condition, note=note)
