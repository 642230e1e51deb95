"""An expression in s: rational, with delays and roots of s, or with parameters that have no values."""

import re
from typing import TYPE_CHECKING, Any

from tline.cli.verdicts import one_port
from tline.cli.verdicts.answer import Answer, Asked, complex_text, values

if TYPE_CHECKING:
    from passivity.delayed.decide import ExpressionVerdict
    from passivity.symbolic.verdict import SymbolicVerdict

ASSUMPTION = re.compile(r"[<>]|\s+real\s*$")
MOST_STEPS = 40  # lines of a proof that are printed


def answer(text: str, asked: Asked) -> Answer:
    """Decide an expression by the route it needs."""
    from passivity import Kind, check_expression, check_symbolic

    kind = Kind.BR if asked.kind == "br" else Kind.PR
    asked.refuse("expressions", "error", "nearest")
    assumed = [given for given in asked.parameters if ASSUMPTION.search(given)]
    known = values(tuple(given for given in asked.parameters if given not in assumed))
    if assumed:
        asked.refuse("parameters without values", "z0", "delay", "within")
        return _symbolic(check_symbolic(text, kind, assumed, known))
    verdict = check_expression(text, kind, known)
    if verdict.rational is not None:
        return one_port.answer(verdict.rational.function, asked)
    asked.refuse("functions that are not rational", "z0", "delay", "within")
    return _delayed(verdict)


def _symbolic(verdict: "SymbolicVerdict") -> Answer:
    from passivity.expression.number import written
    from passivity.symbolic.report import symbolic_as_dict

    lines = [f"{verdict.kind.value}: {verdict.status.value}", f"  because {verdict.why}"]
    if verdict.condition:
        lines.append(f"  exactly if {verdict.condition}")
    if found := verdict.counterexample:
        lines += [f"  {name} = {written(value)}" for name, value in found.values.items()]
        lines.append(f"  witness s = {complex_text(found.witness.re, found.witness.im)}")
    lines += [f"  {line}" for line in _cut(list(verdict.proof))]
    if verdict.note:
        lines.append(f"  note: {verdict.note}")
    return Answer(verdict.status.value, lines, symbolic_as_dict(verdict))


def _delayed(verdict: "ExpressionVerdict") -> Answer:
    from passivity.delayed.report import expression_as_dict
    from passivity.expression.number import digits

    lines = [f"{verdict.kind.value}: {verdict.status.value}", f"  because {verdict.why}"]
    letter = "Z" if verdict.kind == "positive real" else "H"
    if found := verdict.witness:
        lines += [f"  witness s = {complex_text(found.re, found.im)}", f"    {letter}(s) = {found.value.str(12)}"]
    if verdict.proof:
        lines += [f"    {line}" for line in _cut(list(verdict.proof.lines()))]
    if margin := verdict.margin:
        name = "smallest Re Z(jω)" if letter == "Z" else "largest |H(jω)|"
        sign = "≈" if margin.is_enclosed else "about"
        bound = f", proved not to pass {digits(margin.bound)}" if margin.bound is not None else ", sampled"
        value = f"{float(margin.attained):.6g}"
        lines.append(f"  {name:<20} {sign} {value:<12} at ω = {margin.frequency:.6g} rad/s{bound}")
    return Answer(verdict.status.value, lines, expression_as_dict(verdict))


def _cut(lines: list[Any]) -> list[Any]:
    more = len(lines) - MOST_STEPS
    return lines if more <= 0 else [*lines[:MOST_STEPS], f"… and {more} more steps (--json has all)"]
