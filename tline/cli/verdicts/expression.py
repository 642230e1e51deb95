"""A text in s: rational, with delays and roots of s, with parameters or functions that have no values, with `let`."""

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tline.cli.verdicts import one_port
from tline.cli.verdicts.answer import Answer, Asked, complex_text, values
from tline.errors import InputError

if TYPE_CHECKING:
    from passivity import Conclusion, SymbolicVerdict

OPAQUE = re.compile(r"^[^=]*\s(pr|br|positive real|bounded real)\s*$", re.IGNORECASE)
ASSUMPTION = re.compile(rf"[<>]|\s+real\s*$|{OPAQUE.pattern}", re.IGNORECASE)
STRUCTURE = re.compile(r"\blet\s|\bline\s*\(|[;\n]")
MOST_STEPS = 40  # lines of a proof that are printed


def answer(text: str, asked: Asked) -> Answer:
    """Decide a text, or the file of one, by the route it needs; write what proves it where that is asked for."""
    from passivity import Kind, check_expression, check_symbolic
    from passivity.calculus.ask import of_text

    kind = Kind.BR if asked.kind == "br" else Kind.PR
    asked.refuse("expressions", "error", "nearest")
    text = _read(text) if text.lower().endswith(".txt") else text
    assumed = [given for given in asked.parameters if ASSUMPTION.search(given)]
    known = values(tuple(given for given in asked.parameters if given not in assumed))
    structure = bool(STRUCTURE.search(text)) or any(map(OPAQUE.search, asked.parameters))
    if asked.kind == "chain" and (structure or asked.certificate is not None):
        return _derived(text, asked, assumed, known)
    if structure or (assumed and asked.certificate is not None):
        asked.refuse("the structure of a function", "z0", "delay", "within")
        return _concluded(of_text(text, kind, assumed, known), asked)
    if assumed:
        asked.refuse("parameters without values", "z0", "delay", "within")
        return _symbolic(check_symbolic(text, kind, assumed, known))
    verdict = check_expression(text, kind, known)
    if verdict.rational is not None:
        found = one_port.answer(verdict.rational.function, asked)
        return Answer(found.status, found.lines + _written(verdict, asked), found.told, found.draw)
    asked.refuse("functions that are not rational", "z0", "delay", "within")
    return _concluded(verdict, asked)


def _derived(text: str, asked: Asked, assumed: list[str], known: dict[str, str]) -> Answer:
    """From any load of a line to its input port."""
    from passivity import derive

    asked.refuse("the structure of a function", "within")
    if known:
        raise InputError("--param", "a value in a derivation", "it in place of the name")
    derived = derive(text, asked.z0 or "z0", asked.delay or "T", assumed)
    last = derived.statements[-1][1]
    return Answer(last.status.value, [*str(derived).splitlines(), *_written(last, asked)], _told(last))


def _concluded(verdict: "Conclusion", asked: Asked) -> Answer:
    from passivity.expression.number import digits, written

    lines, told = str(verdict).splitlines(), _told(verdict)
    letter = "Z" if verdict.kind == "positive real" else "H"
    if found := verdict.witness:
        where = [f"  witness s = {complex_text(found.re, found.im)}", f"    {letter}(s) = {found.value.str(12)}"]
        lines[2:2] = [f"  {name} = {written(x)}" for name, x in found.values.items()] + where
    if margin := verdict.margin:
        name = "smallest Re Z(jω)" if letter == "Z" else "largest |H(jω)|"
        sign = "about" if margin.bound is None else "≈"
        bound = ", sampled" if margin.bound is None else f", proved not to pass {digits(margin.bound)}"
        value = f"{float(margin.attained):.6g}"
        lines.append(f"  {name:<20} {sign} {value:<12} at ω = {margin.frequency:.6g} rad/s{bound}")
        told["margin"] = {
            "attained": margin.attained.str(20),
            "bound": None if margin.bound is None else written(margin.bound),
            "frequency": margin.frequency,
        }
    return Answer(verdict.status.value, lines + _written(verdict, asked), told)


def _told(verdict: "Conclusion") -> dict[str, Any]:
    from passivity import verify
    from passivity.budget import VERDICT, if_affordable

    told: dict[str, Any] = {"kind": verdict.kind.value, "statement": verdict.statement, "status": verdict.status.value}
    told |= {"why": verdict.why, "proof": verdict.proof, "witness": verdict.witness and verdict.witness.file}
    told |= {"balls": verdict.balls and verdict.balls.file}
    if verdict.pole:
        told[verdict.pole.word] = verdict.pole.place.str(20)
    if proof := verdict.proof or verdict.balls:
        told["verified"] = if_affordable(VERDICT, verify, proof)
    return told


def _written(verdict: "Conclusion", asked: Asked) -> list[str]:
    """Write what anyone can check, if that is asked for."""
    from passivity.calculus.proof import save

    if asked.certificate is None:
        return []
    if verdict.evidence is None:
        return ["nothing was written: no proof along the expression, and no witness in reach"]
    save(verdict.evidence, asked.certificate)
    return [f"wrote {asked.certificate}"]


def _symbolic(verdict: "SymbolicVerdict") -> Answer:
    from passivity.expression.number import written

    lines = [f"{verdict.kind.value}: {verdict.status.value}", f"  because {verdict.why}"]
    told: dict[str, Any] = {"kind": verdict.kind.value, "status": verdict.status.value, "why": verdict.why}
    told |= {"assumed": [str(r) for r in verdict.ranges], "proof": list(verdict.proof), "note": verdict.note}
    told |= {"condition": str(verdict.condition) if verdict.condition else None, "counterexample": None}
    if verdict.condition:
        lines.append(f"  exactly if {verdict.condition}")
    if found := verdict.counterexample:
        lines += [f"  {name} = {written(value)}" for name, value in found.values.items()]
        lines.append(f"  witness s = {complex_text(found.witness.re, found.witness.im)}")
        point = {key: None if part is None else written(part) for key, part in vars(found.witness).items()}
        at = {name: written(value) for name, value in found.values.items()}
        told["counterexample"] = {"values": at, "witness": point, "delay": written(found.delay)}
    lines += [f"  {line}" for line in verdict.proof[:MOST_STEPS]]
    if (more := len(verdict.proof) - MOST_STEPS) > 0:
        lines.append(f"  … and {more} more steps (--json has all)")
    if verdict.note:
        lines.append(f"  note: {verdict.note}")
    return Answer(verdict.status.value, lines, told)


def verified(path: str) -> Answer:
    """Check a file with a proof or a witness."""
    from passivity.evidence import check_evidence

    try:
        evidence = json.loads(_read(path))
    except ValueError as error:
        raise InputError(path, "not JSON", "a file written by --certificate", str(error)[:60]) from error
    if not isinstance(evidence, dict) or "format" not in evidence:
        raise InputError(path, "neither a proof nor a witness", "a file written by --certificate")
    wrong = check_evidence(evidence)
    what = evidence.get("statement") or f"the witness against {evidence.get('text')}"
    line = f"does not hold: {wrong}" if wrong else f"holds: {what}"
    return Answer("refuted" if wrong else "proved", [line], {"holds": wrong is None, "wrong": wrong, "statement": what})


def _read(path: str) -> str:
    try:
        return Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(path, "cannot be read", "a text file", str(error)[:80]) from error
