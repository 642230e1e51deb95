"""Is this positive real, or bounded real? One question for texts, coefficients, systems and networks."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from passivity.budget import VERDICT, UndecidedError, budget
from passivity.calculus.graph import BOUNDED_REAL, POSITIVE_REAL, Fact, Graph, Value
from passivity.calculus.proof import Proof, lines, proof_of
from passivity.calculus.prove import Prover
from passivity.calculus.read import read, statements
from passivity.calculus.witness import Witness, find_witness
from passivity.errors import ExpressionError, shorten, shown
from passivity.expression.parse import parse
from passivity.expression.tree import symbols
from passivity.rational.evaluate import Exact, exact
from passivity.status import Decided, Kind, Status
from passivity.symbolic.assumption import Range, collect

_OPAQUE = re.compile(r"\s*([^\W\d]\w*)\s+(?:(pr|positive real)|br|bounded real)\s*", re.IGNORECASE)
_SHOWN = 24  # lines of a proof that are printed


@dataclass(frozen=True)
class Conclusion(Decided):
    """Whether a function has a property, with what anyone can check.

    Parameters
    ----------
    kind : Kind
    statement : str
        What was asked, with the assumptions.
    status : Status
    why : str
        The reason in one sentence.
    proof : dict or None
        What `passivity.verifier` checks, if the rules prove it; `passivity.calculus.proof.save` writes it.
    witness : dict or None
        Values of the names, and a point s where the property fails.
    oracle : object
        The verdict of the exact test or of balls, where one of these decided.
    """

    kind: Kind
    statement: str
    status: Status
    why: str
    proof: Proof | None = None
    witness: Witness | None = None
    oracle: Any = None

    def __str__(self) -> str:
        told = [f"{self.statement}: {self.status.value}", f"  because {self.why}"]
        if self.proof:
            steps = list(lines(self.proof))
            told += [f"    {line}" for line in steps[:_SHOWN]]
            told += [f"    … and {len(steps) - _SHOWN} more steps"] if len(steps) > _SHOWN else []
        return "\n".join(told)


def is_positive_real(what: Any, assume: Iterable[str] = (), values: Mapping[str, Exact] | None = None) -> Conclusion:
    """Is a function analytic in Re s > 0 with Re Z >= 0 there, as the impedance of a passive one-port is?

    Parameters
    ----------
    what : str, pair of sequences, RationalFunction, RationalMatrix, StateSpace, or system
        An expression, also with ``let NAME = EXPRESSION;`` before it; numerator and denominator, highest power first;
        a system of scipy.signal or python-control.
    assume : iterable of str
        ``R > 0``, ``0 < k < 1``, ``k real`` of parameters; ``Z2 positive real``, ``H bounded real`` of any functions.
    values : mapping of str to number or text, optional
        Numbers for names.

    Raises
    ------
    ExpressionError
        For anything else, and for what `passivity.calculus.read.read` refuses.

    Examples
    --------
    >>> print(is_positive_real("Z2/(1 + Z2/R)", ["Z2 positive real", "R > 0"]).status)
    proved
    >>> print(is_positive_real(([1, 2], [1, 1, 1])).status)
    refuted
    """
    return ask(what, Kind.PR, assume, values)


def is_bounded_real(what: Any, assume: Iterable[str] = (), values: Mapping[str, Exact] | None = None) -> Conclusion:
    """Is a function analytic in Re s > 0 with |H| <= 1 there, as the reflection of a passive one-port is?

    Parameters
    ----------
    what : str, pair of sequences, RationalFunction, RationalMatrix, StateSpace, or system
    assume : iterable of str
    values : mapping of str to number or text, optional
        All as of `is_positive_real`.

    Examples
    --------
    >>> print(is_bounded_real("exp(-2*T*s)*(Z2 - z0)/(Z2 + z0)", ["Z2 pr", "z0 > 0", "T >= 0"]).status)
    proved
    """
    return ask(what, Kind.BR, assume, values)


def ask(what: Any, kind: Kind, assume: Iterable[str] = (), values: Mapping[str, Exact] | None = None) -> Conclusion:
    """The conclusion of one of the two functions above."""
    if isinstance(what, str):
        return of_text(what, kind, assume, values)
    from passivity.multiport.positive_real import check as check_matrix
    from passivity.multiport.systems import from_system
    from passivity.multiport.verdict import Network
    from passivity.one_port.positive_real import check
    from passivity.rational.function import RationalFunction

    if isinstance(what, tuple | list) and len(what) == 2:
        what = RationalFunction.from_coefficients(*what)
    elif not isinstance(what, RationalFunction | Network):
        if not any(hasattr(what, name) for name in ("A", "num", "zeros")):
            expected = "text, (numerator, denominator), a state space, or a system of scipy.signal or python-control"
            raise ExpressionError("what", "not a function of s", expected, shorten(shown(what, repr)))
        what = from_system(what)
    verdict = check(what, kind) if isinstance(what, RationalFunction) else check_matrix(what, kind)
    return Conclusion(kind, f"{kind.value}", verdict.status, verdict.why or verdict.budget, oracle=verdict)


def of_text(text: str, kind: Kind, assume: Iterable[str] = (), values: Mapping[str, Exact] | None = None) -> Conclusion:
    """The conclusion about a text: a witness in floats, the rules, then the exact test, polynomials and balls."""
    numbers = {name: exact(x, f"parameter {name}") for name, x in (values or {}).items()}
    assume = [assume] if isinstance(assume, str) else list(assume)
    graph = Graph(assumed(assume))
    value = read(graph, text, numbers)
    claim = POSITIVE_REAL if kind is Kind.PR else BOUNDED_REAL
    given = f" for all {', '.join(assume)}" if assume else ""
    statement = f"{' '.join(text.split()):.300} is {kind.value}{given}"
    plain = len(statements(text)) == 1 and "line(" not in text
    if plain and graph.is_rational[value[1]]:
        return _by_oracle(kind, statement, text, assume, numbers)
    try:
        with budget(VERDICT):
            found = find_witness(graph, value, claim, text, numbers)
            if found:
                return Conclusion(kind, statement, Status.REFUTED, _failing(kind, found), witness=found)
            prover = Prover(graph)
            last = prover.reach(value, claim)
        if last is not None:
            proof = proof_of(graph, prover.steps, last, value, claim, statement)
            why = f"it follows in {len(proof['steps'])} steps from what it is made of"
            return Conclusion(kind, statement, Status.PROVED, why, proof=proof)
        limit = "no rule applies and no counterexample was found"
    except UndecidedError as error:
        limit = str(error)
    if plain and not any(fact[0] == "disc" for fact in graph.names.values()):
        return _by_oracle(kind, statement, text, assume, numbers)
    helps = settling(graph, value, claim)
    why = f"{limit}; it would be settled by {' or '.join(helps)}" if helps else limit
    return Conclusion(kind, statement, Status.UNDECIDED, why)


def _by_oracle(kind: Kind, statement: str, text: str, assume: list[str], numbers: dict) -> Conclusion:
    from passivity.delayed.decide import check_expression
    from passivity.symbolic.check import check_symbolic

    names = symbols(parse(text)) - {"s"}
    if assume and names - numbers.keys():
        verdict = check_symbolic(text, kind, assume, {name: x for name, x in numbers.items() if name in names})
    else:
        verdict = check_expression(text, kind, numbers)
    return Conclusion(kind, statement, verdict.status, verdict.why, oracle=verdict)


def _failing(kind: Kind, witness: Witness) -> str:
    at = ", ".join(f"{name} = {x}" for name, x in witness["values"].items())
    s = f"s = {witness['s'][0]} + {witness['s'][1]}j"
    letter = "Z" if kind is Kind.PR else "H"
    return f"{letter}(s) = {witness['value']} at {s}{f', {at}' if at else ''}"[:600]


def assumed(assume: Iterable[str]) -> dict[str, Fact]:
    """What is assumed of each name, as facts.

    Examples
    --------
    >>> assumed(["R > 0", "H bounded real"])["R"]
    ('real', Fraction(0, 1), inf)
    """
    opaque: dict[str, Fact] = {}
    ranges: list[str | Range] = []
    for text in assume:
        if isinstance(text, str) and (found := _OPAQUE.fullmatch(text)):
            if found[1] == "s":
                raise ExpressionError(f"assumption {text.strip()}", "s is the Laplace variable", "another name")
            opaque[found[1]] = POSITIVE_REAL if found[2] else BOUNDED_REAL
        else:
            ranges.append(text)
    facts: dict[str, Fact] = {name: r.fact for name, r in collect(ranges).items()}
    if both := opaque.keys() & facts.keys():
        raise ExpressionError(f"assumption {min(both)}", "a function and a number at once", "one of them")
    return facts | opaque


def settling(graph: Graph, value: Value, claim: Fact) -> list[str]:
    """Assumptions on one name each, with any of which the rules prove the claim."""
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
            try:
                with budget(VERDICT // 10):
                    if Prover(trial).reach(value, claim) is not None:
                        found.append(words.format(name))
            except UndecidedError:
                continue
    return found
