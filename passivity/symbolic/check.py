"""Is an impedance positive real, or a reflection bounded real, for all values its parameters may have?"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import islice

from passivity.budget import VERDICT, UndecidedError, budget
from passivity.calculus.fact import CLAIMS
from passivity.calculus.graph import Graph, Value
from passivity.calculus.proof import Proof, prove
from passivity.calculus.question import Question as Asked
from passivity.calculus.read import read
from passivity.errors import ExpressionError, shorten, shown
from passivity.expression.number import written
from passivity.expression.parse import parse
from passivity.expression.tree import Node, is_rational, symbols
from passivity.rational.evaluate import Exact, exact, of_tree
from passivity.status import Kind, Status
from passivity.symbolic.assumption import Range, collect, meet, trials
from passivity.symbolic.formula import Claim, Condition, Joined
from passivity.symbolic.question import Question
from passivity.verdict import Verdict, Witness

MAX_PARAMETERS = 200
MAX_TRIALS = 600
MAX_WORK = 400_000  # of all trials together: characters read and squares of degrees
_SHOWN = 200  # characters of all values in a reason


def check_symbolic(
    text: str, kind: Kind, assumptions: Iterable[str | Range], parameters: Mapping[str, Exact] | None = None
) -> Verdict:
    """Is a function with parameters positive real or bounded real for all values that satisfy the assumptions?

    Values for which the expression is 0/0 when multiplied out are left out, for there is no function.

    Parameters
    ----------
    text : str
        What `passivity.expression.parse.parse` reads.
    kind : Kind
        PR for an impedance or admittance, BR for a reflection.
    assumptions : iterable of str or Range
        What `parse_assumption` reads: one or more for each name but ``s`` that has no value.
    parameters : mapping of str to number or text, optional
        Values of the others.

    Returns
    -------
    Verdict
        Proved along the expression or by the signs of expanded polynomials; or refuted with values, by the exact test
        at these. The exact condition is added for degree two in s at most, and where one factor decides.

    Raises
    ------
    ExpressionError
        What `parse` and `parse_assumption` refuse; a name without a value or an assumption; assumptions on other
        names, or that no value satisfies; more than MAX_PARAMETERS; 0/0 for all values.

    References
    ----------
    M. Z. Q. Chen, M. C. Smith, IEEE Transactions on Automatic Control 54 (2009), 390-393.

    Examples
    --------
    >>> check_symbolic("R + s*L + 1/(s*C)", Kind.PR, ["R > 0", "L > 0", "C > 0"]).status
    <Status.PROVED: 'proved'>
    >>> verdict = check_symbolic("k*(1 - s*t)/(1 + s*t)", Kind.BR, ["t > 0", "k real"])
    >>> print(verdict.status, "/", verdict.condition, "/", verdict.witness.names["k"])
    refuted / -1 <= k <= 1 / 2
    """
    tree = parse(text)
    ranges = _ranges(tree, assumptions, parameters or {})
    numbers = {r.name: r.low for r in ranges if r.low is not None and r.is_point}
    graph = Graph({r.name: r.fact for r in ranges if not r.is_point})
    with budget(VERDICT):
        try:
            value = _read(graph, tree, text, numbers)
        except UndecidedError as error:
            why = f"{error}; to settle it: values for the parameters"
            return Verdict(kind, None, Status.UNDECIDED, reason=why, ranges=ranges)
        asked = Asked(graph, value, CLAIMS[kind], text, numbers)
        under = ", ".join(map(str, ranges))
        verdict = decide(asked, kind, ranges, f"{' '.join(text.split()):.300} is {kind.value} for all {under}")
        return replace(verdict, asked=(text, numbers, graph.names))


def decide(asked: Asked, kind: Kind, ranges: tuple[Range, ...], statement: str) -> Verdict:
    """The verdict by rules, then by polynomials in the parameters, with a search for values that refute."""
    free, text = tuple(r for r in ranges if not r.is_point), asked.text
    made = partial(Verdict, kind, None, statement=statement, ranges=ranges)
    if proof := _proof(asked, statement):
        return made(Status.PROVED, reason="so is each of its parts", certificate=proof)
    question, formula, limit = None, None, "neither a proof nor a counterexample was found"
    try:
        with budget(VERDICT // 3):
            question = Question.of(kind, asked.graph, asked.value, free)
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


def _read(graph: Graph, tree: Node, text: str, numbers: Mapping[str, Fraction]) -> Value:
    try:
        return read(graph, text, numbers)
    except ExpressionError as error:
        if "too" in error.problem.split():
            raise UndecidedError(str(error)) from error
        if is_rational(tree):  # 0/0 is said to be one
            of_tree(tree, dict.fromkeys(graph.names, Fraction(1)) | dict(numbers))
        raise


def _proof(asked: Asked, statement: str) -> Proof | None:
    try:
        with budget(VERDICT // 4):
            return prove(asked, statement)
    except (UndecidedError, ExpressionError):  # too large
        return None


def _ranges(tree: Node, assumptions: Iterable[str | Range], parameters: Mapping[str, Exact]) -> tuple[Range, ...]:
    """What is known of each name, in alphabetical order."""
    ranges = collect(assumptions)
    for name, number in parameters.items():
        number = exact(number, f"parameter {name}")
        ranges[name] = meet(ranges.get(name), Range(name, number, number))
    names = symbols(tree) - {"s"}
    if len(ranges) > MAX_PARAMETERS:
        raise ExpressionError("parameters", "too many", f"at most {MAX_PARAMETERS}", f"{len(ranges)}")
    listed = f"{', '.join(sorted(names)) or 'no names':.200}"
    for name in sorted(names - set(ranges)):
        raise ExpressionError(f"parameter {name:.60}", "no value and no assumption", f"such as {name:.60} > 0")
    for name in sorted(set(ranges) - names, key=str):
        problem = "s is the Laplace variable" if name == "s" else "not in the expression"
        raise ExpressionError(f"parameter {shown(name)}", problem, f"something about {listed}")
    return tuple(ranges[name] for name in sorted(names))
