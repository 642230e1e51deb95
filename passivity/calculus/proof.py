"""Proofs as files: the nodes and steps that lead to a claim, in the texts that the verifier reads."""

import json
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from passivity.ball import near
from passivity.calculus.fact import Fact, in_texts, in_words
from passivity.calculus.graph import Graph, Value
from passivity.calculus.prove import ALL_RULES, DEPTHS, Prover, Step
from passivity.calculus.question import Question, check_file
from passivity.calculus.search import Search
from passivity.calculus.values import at_point, needed
from passivity.errors import shorten
from passivity.exact.certificate import verify as holds
from passivity.expression.number import written
from passivity.status import Kind
from passivity.verdict import Margin, Margins, Verdict
from passivity.verifier import FORMAT, FUNCTIONS, check, disc, read_fact, scaled

Proof = dict[str, Any]
LONGEST = 400  # characters of a node in words


def prove(
    question: Question, statement: str, prover: Prover | None = None, depths: tuple[int, ...] = DEPTHS
) -> Proof | None:
    """A proof by the rules, None if they lead to none."""
    graph, value, claim = question.graph, question.value, question.claim
    prover = prover or Prover(graph)
    last = prover.reach(value, claim, depths)
    return None if last is None else proof_of(graph, prover.steps, last, value, claim, statement)


def verify(evidence: Any) -> bool:
    """Whether the facts in a certificate or a proof hold and make a proof, checked by other means than the prover's.

    Parameters
    ----------
    evidence : Certificate, StorageCertificate or dict
        ``certificate`` of a verdict: on rational functions and matrices, or the ``proof`` of one on expressions.

    Examples
    --------
    >>> from passivity import RationalFunction, check_positive_real, is_positive_real
    >>> verify(check_positive_real(RationalFunction.from_expression("(s^2 + s + 1)/(s^2 + s + 4)")).certificate)
    True
    >>> verify(is_positive_real("1 + exp(-s)").proof)
    True
    """
    if isinstance(evidence, tuple):
        return all(verify(mode.load.certificate) and verify(mode.reflection.certificate) for mode in evidence)
    return check_evidence(json.loads(json.dumps(evidence))) is None if isinstance(evidence, dict) else holds(evidence)


def check_evidence(told: dict[str, Any]) -> str | None:
    """Return None if a proof or a witness, as read from its file, is valid; else the fault found."""
    return check(told, ALL_RULES) if told["format"] == FORMAT else check_file(told)


def margins_of(verdict: Verdict) -> Margins:
    """Smallest Re Z(jw) or largest |H(jw)|, sampled, and its bound by the last step of the proof."""
    question = verdict.question
    if any(question.graph.nodes[n][0] == "name" for n in needed(question.graph, question.value[1])):
        return Margins()
    w = Search(question, {}).lowest()
    there = None if w is None else at_point(question.graph, question.value, Fraction(0), Fraction(w))
    if w is None or there is None or not there.is_finite():
        return Margins()
    ends: Any = None
    if proof := verdict.proof:
        ends = disc(scaled(read_fact(proof["steps"][-1][1]), Fraction(proof["root"][0])))
    if verdict.kind is Kind.PR:
        return Margins(Margin(ends and ends[0], near(there.real), w))
    return Margins(reflection=Margin(near(abs(there)), ends and max(-ends[0], ends[1]), w, largest=True))


def proof_of(graph: Graph, steps: list[Step], last: int, value: Value, claim: Fact, statement: str) -> Proof:
    """Collect the steps that the last one rests on, and the nodes they are about."""
    used, stack = set(), [last]
    while stack:
        k = stack.pop()
        if k not in used:
            used.add(k)
            stack += steps[k][3]
    order = sorted(used)
    nodes: set[int] = {0}
    stack = [
        value[1],
        *(steps[k][0] for k in order),
        *(n for k in order if steps[k][2] == "equal" for n in steps[k][4][1]),
    ]
    while stack:
        n = stack.pop()
        if n not in nodes:
            nodes.add(n)
            stack += graph.inner(n)
    kept = sorted(nodes)
    new, at = {n: k for k, n in enumerate(kept)}, {k: i for i, k in enumerate(order)}

    def data(rule: str, given: Any) -> Any:
        return [given[0], [new[n] for n in given[1]]] if rule == "equal" else given

    names = {graph.nodes[n][1][0] for n in kept if graph.nodes[n][0] == "name"}
    return {
        "format": FORMAT,
        "statement": statement,
        "names": {name: in_texts(graph.names[name]) for name in sorted(names)},
        "nodes": [_node(graph, n, new) for n in kept],
        "steps": [
            [new[n], in_texts(fact), rule, [at[m] for m in premises], data(rule, given)]
            for n, fact, rule, premises, given in (steps[k] for k in order)
        ],
        "root": [written(value[0]), new[value[1]]],
        "claim": in_texts(claim),
    }


def _node(graph: Graph, n: int, new: dict[int, int]) -> list[Any]:
    kind, parts = graph.nodes[n]
    if kind == "mul":
        return [kind, *([new[m], e] for m, e in parts)]
    if kind in ("sum", "line", *FUNCTIONS):
        return [kind, *([written(c), new[m]] for c, m in parts)]
    return [kind, *(list(x) if isinstance(x, tuple) else x for x in parts)]


def lines(proof: Proof) -> Iterator[str]:
    """A proof line by line: each function that it speaks of, the fact, the rule."""
    texts = Texts(proof["nodes"])
    for n, fact, rule, _, data in proof["steps"]:
        if n:
            yield f"{texts.of(n)}: {in_words(fact)}   [{'inverse' if data == [-1] else rule}]"


def proved_by(proof: Proof) -> str:
    """Write the statement proved, from the nodes and the claim of a proof; the statement in its file may be any text.

    Examples
    --------
    >>> from passivity.calculus.ask import is_positive_real
    >>> proved_by(is_positive_real("1/(R + 1/Z2)", ["R > 0", "Z2 positive real"]).proof)
    '1/(R + 1/Z2) is positive real, R being a constant >= 0, Z2 being positive real'
    """
    texts, (c, n) = Texts(proof["nodes"]), proof["root"]
    text = texts.scaled_text(c, n)
    if "#" in text:
        text = texts.written_out(n) if c == "1" else f"{c} times {texts.written_out(n)}"
    names = (f", {name} being {in_words(fact)}" for name, fact in proof["names"].items())
    return f"{shorten(text, LONGEST)} is {in_words(proof['claim'])}{''.join(names)}"


class Texts:
    """Nodes of a proof as expressions; a long or repeated node is written as #number."""

    def __init__(self, nodes: list[Any]):
        self.nodes = nodes
        self._known: list[str] = []
        for n in range(len(nodes)):  # what a node is made of comes before it
            text = self.written_out(n)
            self._known.append(text if len(text) <= LONGEST else f"#{n}")

    def of(self, n: int) -> str:
        """A node in text."""
        return self._known[n]

    def written_out(self, n: int) -> str:
        """A node in text, its parts as `of` has them."""
        kind, *parts = self.nodes[n]
        if kind in ("one", "s", "name"):
            return {"one": "1", "s": "s"}.get(kind) or parts[0]
        if kind == "sum":
            return " + ".join(self.scaled_text(c, m) for c, m in parts).replace("+ -", "- ")
        if kind == "mul":
            above = [self._power(m, e) for m, e in parts if e > 0]
            below = [self._power(m, -e) for m, e in parts if e < 0]
            under = f"/({'*'.join(below)})" if len(below) > 1 else f"/{below[0]}" if below else ""
            return ("*".join(above) or "1") + under
        return f"{kind}({', '.join(self.scaled_text(c, m) for c, m in parts)})"

    def scaled_text(self, c: str, m: int) -> str:
        """A multiple of a node in text."""
        if m == 0:
            return c
        text = self.of(m)
        inner = f"({text})" if self.nodes[m][0] == "sum" and text[0] != "#" else text
        return text if c == "1" else f"-{inner}" if c == "-1" else f"{c}*{inner}"

    def _power(self, m: int, e: int) -> str:
        text = self.of(m)
        inner = f"({text})" if self.nodes[m][0] == "sum" and text[0] != "#" else text
        return inner if e == 1 else f"{inner}^{e}"
