"""Is this positive real, or bounded real? One question for texts, coefficients, systems and networks."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import chain, islice
from typing import Any

from flint import ctx

from passivity.ball import of_fraction, of_point
from passivity.budget import VERDICT, UndecidedError, budget, granted, if_affordable
from passivity.calculus.fact import POSITIVE_REAL, Fact
from passivity.calculus.given import Structure, checked, given
from passivity.calculus.graph import ONE, Graph, Value
from passivity.calculus.leaf import function_of, in_waves
from passivity.calculus.proof import prove
from passivity.calculus.prove import DEPTHS, Prover
from passivity.calculus.question import Question, free_names, is_discrete, trees
from passivity.calculus.rewrite import Line as Reading
from passivity.calculus.search import Scales, Search
from passivity.calculus.values import at_point, in_ball, needed
from passivity.discrete import LET, Discrete, check_outside, outside
from passivity.errors import ExpressionError
from passivity.exact.positive_real import check
from passivity.expression.tree import Line, is_rational, nodes
from passivity.rational.evaluate import Exact, check_names, exact, of_tree
from passivity.rational.function import RationalFunction
from passivity.status import Kind, Status
from passivity.symbolic.assumption import Range, assumed, random_values
from passivity.verdict import Verdict, Witness

_EACH = VERDICT // 2  # of the ways to decide
_EACH_NODE = 1_000_000  # more, of the first way
_LONG = 200  # nodes of a graph that is not multiplied out before rules have been tried
_BITS = 1024  # of a place that is known exactly
_TRIALS = 12  # choices of values for names
_PLACES = [(Fraction(x, d), Fraction(y, d)) for x, y, d in ((37, 29, 1), (5, 3, 7), (1, 70, 13))]


def is_positive_real(
    what: Any, assume: Iterable[str] = (), values: Mapping[str, Exact] | None = None, *, budget: float = 1
) -> Verdict:
    """Is a function analytic in Re s > 0 with Re Z >= 0 there, as the impedance of a passive one-port is?

    Of a text: by rules, which turn facts about the parts into facts about the whole; by a search for a point where the
    property fails, shown in balls; by balls on the axis, if all is rational in s and delays. Functions are principal
    branches. A function that is not real for real s > 0 does not have the property.

    Parameters
    ----------
    what : text, numbers, system, network or samples
        An expression, also with ``let NAME = EXPRESSION;`` before it; a number; numerator and denominator, highest
        power first; matrices A, B, C, D, or E, A, B, C, D of E x' = A x + B u; each of these with dt behind it, or an
        expression in z, for a function of discrete time, which is asked about for |z| > 1; a `RationalFunction`,
        `RationalMatrix` or `StateSpace`; a system of scipy.signal or python-control; a network of scikit-rf or a
        `SampledResponse`, which can only be refuted; a line
        or a scene of tline, about which `passivity.calculus.given` says more.
    assume : iterable of str
        ``R > 0``, ``0 < k < 1``, ``k real`` of parameters; ``Z2 positive real``, ``H bounded real`` of any functions.
    values : mapping of str to number or text, optional
        Numbers for names.
    budget : float
        How many times the usual work may be done before the answer is "undecided".

    Raises
    ------
    ExpressionError
        For any other argument, and where `passivity.calculus.question.read` raises it.

    References
    ----------
    O. Brune, "Synthesis of a finite two-terminal network whose driving-point impedance is a prescribed function of
    frequency", J. Math. Phys. 10 (1931), 191-236: sums, inverses and compositions of positive real functions.

    Examples
    --------
    >>> print(is_positive_real("Z2/(1 + Z2/R)", ["Z2 positive real", "R > 0"]).status)
    proved
    >>> print(is_positive_real(([1, 2], [1, 1, 1])).status)
    refuted
    """
    with granted(budget):
        return ask(what, Kind.PR, assume, values)


def is_bounded_real(
    what: Any, assume: Iterable[str] = (), values: Mapping[str, Exact] | None = None, *, budget: float = 1
) -> Verdict:
    """Is a function analytic in Re s > 0 with |H| <= 1 there, as the reflection of a passive one-port is?

    Parameters
    ----------
    what : text, numbers, system, network or samples
    assume : iterable of str
    values : mapping of str to number or text, optional
    budget : float
        All as of `is_positive_real`.

    Examples
    --------
    >>> print(is_bounded_real("exp(-2*T*s)*(Z2 - z0)/(Z2 + z0)", ["Z2 pr", "z0 > 0", "T >= 0"]).status)
    proved
    """
    with granted(budget):
        return ask(what, Kind.BR, assume, values)


def ask(what: Any, kind: Kind, assume: Iterable[str] = (), values: Mapping[str, Exact] | None = None) -> Any:
    """The verdict of `is_positive_real` or `is_bounded_real`."""
    if isinstance(what, str):
        return _noted(what, kind, [assume] if isinstance(assume, str) else list(assume), values)
    if assume or values:
        problem = "says nothing about a function without names"
        raise ExpressionError("assume" if assume else "values", problem, "it beside a text")
    what = given(what, kind)
    if isinstance(what, str):
        return of_text(what, kind)
    if isinstance(what, Structure):  # of which power is what there is to know, whatever was asked for
        return of_text(what.text, Kind.PR, what.assume, statement=what.statement)
    if isinstance(what, Discrete):
        return check_outside(what.network, kind)
    return check(what, kind) if isinstance(what, RationalFunction) else checked(what, kind)


def _noted(text: str, kind: Kind, assume: list[str], values: Mapping[str, Exact] | None) -> Verdict:
    """Return the verdict on a text; assumptions on names not in the text are ignored, with a note."""
    names = free_names(text)
    about = [min({*assumed([each])[0]}) for each in assume]
    verdict = of_text(text, kind, [each for each, name in zip(assume, about, strict=True) if name in names], values)
    if not (unused := ", ".join(sorted({*about} - names))):
        return verdict
    listed = f"its names are {', '.join(sorted(names)):.200}" if names else "it has no names"
    note = f"what is assumed of {unused:.200} counts for nothing, it is not in the expression: {listed}"
    verdict = replace(verdict, note="; ".join(filter(None, (verdict.note, note))))
    return _with_values(verdict, assumed(assume)[1])


def _with_values(verdict: Verdict, ranges: list[Range]) -> Verdict:
    """The verdict with values of names that do not matter in its witness."""
    if verdict.witness is None:
        return verdict
    return replace(
        verdict, witness=replace(verdict.witness, names={**next(random_values(ranges)), **verdict.witness.names})
    )


def of_text(
    text: str,
    kind: Kind,
    assume: Iterable[str] = (),
    values: Mapping[str, Exact] | None = None,
    statement: str = "",
) -> Verdict:
    """The verdict on a text, by the first way that leads to one.

    Raises
    ------
    ExpressionError
        For a name without value and assumption, for a value or an assumption of a name that is not in the text, and
        where `passivity.calculus.question.read` raises it.
    """
    numbers = {name: exact(x, f"parameter {name}") for name, x in (values or {}).items()}
    assume = list(assume)
    facts, ranges = assumed(assume)
    ranges.sort(key=lambda r: r.name)
    discrete = is_discrete(text, {**numbers, **facts})
    names = free_names(text) - ({"z"} if discrete else set())
    check_names(names, {**numbers, **facts}, "no value and no assumption")
    under = f" for all {', '.join(map(str, assume))}" if assume else ""
    statement = statement or f"{' '.join(text.split()):.300} is {kind.value}{' for |z| > 1' if discrete else ''}{under}"
    numbers |= {r.name: r.low for r in ranges if r.is_point and r.low is not None and r.name not in numbers}
    facts = {name: fact for name, fact in facts.items() if name not in numbers}
    whole = LET + text if discrete else text
    made = partial(Verdict, kind, None, statement=statement, asked=(whole, numbers, facts))
    (_, plain), *more = trees(text)
    if not more and is_rational(plain) and not facts and names <= numbers.keys():
        # with what numerator and denominator have in common, and 1/0
        r = of_tree(plain, numbers, "z" if discrete else "s")
        return outside(_exact(made, r.bilinear()), r) if discrete else _exact(made, r)
    question = Question.of(kind, whole, numbers, facts)
    structured = bool(more) or any(isinstance(node, Line) for node in nodes(plain))
    verdict = _of_question(made, question, ranges, structured)
    return outside(verdict) if discrete else verdict


def _of_question(made: partial, question: Question, ranges: list[Range], structured: bool) -> Verdict:
    graph = question.graph
    left = {graph.nodes[n][1][0] for n in needed(graph, question.value[1]) if graph.nodes[n][0] == "name"}
    if not left:
        return _with_values(_with_numbers(made, question), ranges)
    made = partial(made, ranges=tuple(r for r in ranges if r.name in left and graph.names[r.name][0] == "real"))
    return _with_names(made, question, [r for r in ranges if r.name in left], structured)


def _exact(made: partial, r: RationalFunction) -> Verdict:
    return replace(check(r, made.args[0]), **made.keywords)


def _with_numbers(made: partial, question: Question) -> Verdict:
    """The first of the ways that leads to an answer; each has its own budget."""
    graph, value = question.graph, question.value
    long, prover = len(graph.nodes) > _LONG, Prover(graph)
    if graph.is_rational[value[1]]:
        if long and (found := _at_once(made, question, prover)):
            return found[0]
        try:
            return _exact(made, function_of(graph, value[1]) * value[0])
        except ExpressionError as error:
            if not long or "too" not in error.problem.split():
                raise
    rough = (in_ball(graph, value, of_point(*s)) for s in _PLACES)
    if not any(x.is_finite() for x in chain(rough, (at_point(graph, value, *s) for s in _PLACES))):
        expected = "an expression that is neither 1/0 nor beyond all numbers everywhere"
        raise ExpressionError("", "no value in reach", expected)
    missing: list[str] = []
    if found := _at_once(made, question, prover):
        return found[0]
    search, active = Search(question, {}), prover.active()
    ways = (
        lambda: _refuted(made, search.glance()),
        lambda: _in_waves(made, question, search),
        lambda: _refuted(made, search.behind(active)),
        lambda: _proved(made, question, prover, DEPTHS[1:-1]),
        lambda: _in_balls(made, question, search, prover, active),
        lambda: _refuted(made, search.hunt()),
        lambda: _proved(made, question, prover, DEPTHS[-1:]),
    )
    for k, way in enumerate(ways):  # a look at a point takes as long as the function is
        try:
            with budget(_EACH if k else _EACH + _EACH_NODE * len(graph.nodes)):
                if found := way():
                    return found[0]
        except UndecidedError as error:
            missing.append(str(error))
    why = f"no rule applies, no counterexample was found, and balls do not settle it: {'; '.join(missing)}"
    return made(Status.UNDECIDED, reason=why)


def _at_once(made: partial, question: Question, prover: Prover) -> list[Verdict]:
    """Apply the rules along the given structure, with work at most proportional to its length."""
    units = _EACH + _EACH_NODE * len(question.graph.nodes)
    return if_affordable(units, _proved, made, question, prover, DEPTHS[:1]) or []


def _proved(made: partial, question: Question, prover: Prover, depths: tuple[int, ...]) -> list[Verdict]:
    proof = prove(question, made.keywords["statement"], prover, depths)
    why = f"it follows in {len(proof['steps'])} steps from what it is made of" if proof else ""
    return [made(Status.PROVED, reason=why, certificate=proof)] if proof else []


def _refuted(made: partial, found: Witness | None) -> list[Verdict]:
    return [made(Status.REFUTED, reason=found.why, witness=found)] if found else []


def _in_waves(made: partial, question: Question, search: Search) -> list[Verdict]:
    """Refuted exactly, as a function of t = tanh(unit s/2), if it is rational in that."""
    found = in_waves(question.graph, question.value[1])
    point = check(found[1] * question.value[0], question.kind).witness if found else None
    if found is None or point is None:
        return []
    with ctx.workprec(_BITS):
        t = of_point(point.re, point.im)
        return _refuted(made, search.rounded(((1 + t) / (1 - t)).log() / of_fraction(found[0])))


def _in_balls(
    made: partial, question: Question, search: Search, prover: Prover, active: list[tuple[int, int, Reading]]
) -> list[Verdict]:
    """Prove in balls the load of the farthest line that rules leave undecided, else the whole function."""
    for _, _, (_, _, load) in active[:1]:
        if if_affordable(_EACH * 3 // 4, prover.strictly, Kind.PR, load) and (
            found := _at_once(made, question, prover)
        ):
            return found
    try:
        return _proved(made, question, prover, DEPTHS[:1]) if prover.strictly(question.kind, question.value) else []
    except UndecidedError as error:
        frequency = getattr(error, "frequency", None)
        if frequency is not None and (witness := search.beside(frequency)):
            return _refuted(made, witness)
        raise


def _with_names(made: partial, question: Question, ranges: list[Range], structured: bool) -> Verdict:
    """For any values of the names, and any functions: by rules, and of parameters by polynomials in them."""
    prover, parameters = Prover(question.graph), all(question.graph.names[r.name][0] == "real" for r in ranges)
    look_first = structured or not parameters
    try:
        if found := _at_once(made, question, prover):
            return found[0]
        with budget(VERDICT if look_first else VERDICT // 4):
            seen = _glanced(made, question, ranges) if look_first else []
            if found := seen or _proved(made, question, prover, DEPTHS[1:]):
                return found[0]
        limit = "no rule applies and no counterexample was found"
    except UndecidedError as error:
        limit = str(error)
    if found := _by_polynomials(made, question, prover):
        return found[0]
    if parameters:
        from passivity.symbolic.question import decide

        with budget(VERDICT):
            verdict = decide(question, made)
        if verdict.status is Status.UNDECIDED and not look_first:
            return next(iter(if_affordable(_EACH, _glanced, made, question, ranges) or [verdict]))
        if verdict.status is not Status.UNDECIDED:
            return verdict
    helps = settling(question.graph, question.value, question.claim)
    return made(Status.UNDECIDED, reason=f"{limit}; it would be settled by {' or '.join(helps)}" if helps else limit)


def _by_polynomials(made: partial, question: Question, prover: Prover) -> list[Verdict]:
    """By rules, from what polynomials prove of the largest parts that are rational in s and parameters."""
    graph, inside, found = question.graph, set(), False
    order = needed(graph, question.value[1])
    plain = {0}
    for n in order:
        kind, parts = graph.nodes[n]
        real = kind in ("s", "sum", "mul") or (kind == "name" and graph.names[parts[0]][0] == "real")
        plain |= {n} if real and plain.issuperset(graph.inner(n)) else set()
    for n in reversed(order):
        if n in plain:
            if n not in inside and graph.moves[n] and not graph.is_rational[n] and n != question.value[1]:
                found |= bool(if_affordable(_EACH // 4, prover.for_all, Kind.PR, (ONE, n)))
            inside |= {*graph.inner(n)}
    return _at_once(made, question, prover) if found else []


def _glanced(made: partial, question: Question, ranges: list[Range]) -> list[Verdict]:
    scales = Scales(question)
    for names in islice(random_values(ranges), _TRIALS):
        if found := _refuted(made, Search(question, names, scales).glance()):
            return found
    return []


def settling(graph: Graph, value: Value, claim: Fact) -> list[str]:
    """List assumptions, each on one name, any of which lets the rules prove the claim."""
    found = []
    for name, fact in graph.names.items():
        for other, words in (
            (("real", POSITIVE_REAL[1], POSITIVE_REAL[2]), "{} >= 0"),
            (POSITIVE_REAL, "{} positive real"),
        ):
            if other[0] != fact[0] or other == fact or fact[1] >= 0:
                continue
            trial = Graph(graph.names | {name: other})
            trial.share(graph)
            if if_affordable(VERDICT // 10, Prover(trial).reach, value, claim) is not None:
                found.append(words.format(name))
    return found
