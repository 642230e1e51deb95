"""A text in s: rational, with delays and roots of s, with parameters or functions that have no values, with `let`."""

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING

from tline.cli.verdicts import one_port
from tline.cli.verdicts.answer import Answer, Asked, values
from tline.errors import InputError

if TYPE_CHECKING:
    from passivity import Conclusion

OPAQUE = re.compile(r"^[^=]*\s(pr|br|positive real|bounded real)\s*$", re.IGNORECASE)
ASSUMPTION = re.compile(rf"[<>]|\s+real\s*$|{OPAQUE.pattern}", re.IGNORECASE)
STRUCTURE = re.compile(r"\blet\s|\bline\s*\(|[;\n]")


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
        found = check_symbolic(text, kind, assumed, known)
        return Answer(found.status.value, found.text_lines(), found.to_dict())
    verdict = check_expression(text, kind, known)
    if verdict.rational is not None:
        found = one_port.answer(verdict.rational.function, asked)
        return Answer(found.status, found.lines + written(verdict, asked), found.told, found.draw)
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
    return Answer(last.status.value, [*derived.text_lines(), *written(last, asked)], last.to_dict())


def _concluded(verdict: "Conclusion", asked: Asked) -> Answer:
    return Answer(verdict.status.value, verdict.text_lines() + written(verdict, asked), verdict.to_dict())


def written(verdict: "Conclusion", asked: Asked) -> list[str]:
    """Write what anyone can check, if that is asked for."""
    from passivity.calculus.proof import save

    if asked.certificate is None:
        return []
    if verdict.evidence is None:
        return ["nothing was written: no proof along the expression, and no witness in reach"]
    save(verdict.evidence, asked.certificate)
    return [f"wrote {asked.certificate}"]


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
