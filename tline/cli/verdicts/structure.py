"""What is proved along its structure: `let` statements, lines, any functions with a property; and files of proofs."""

import json
import re
from pathlib import Path

from tline.cli.verdicts.answer import Answer, Asked, values
from tline.errors import InputError

OPAQUE = re.compile(r"\s(pr|br|positive real|bounded real)\s*$", re.IGNORECASE)
LETS = re.compile(r"\blet\s|\bline\s*\(|[;\n]")
ASSUMPTION = re.compile(rf"[<>]|\s+real\s*$|{OPAQUE.pattern}", re.IGNORECASE)


def asks(what: str, asked: Asked) -> bool:
    """Whether a question is one of this kind."""
    if what.startswith("["):
        return False
    opaque = any(OPAQUE.search(given) and "=" not in given for given in asked.parameters)
    return opaque or bool(LETS.search(what)) or what.lower().endswith(".txt") or asked.certificate is not None


def answer(text: str, asked: Asked) -> Answer:
    """Decide a text or the file of one, and write the proof or the witness where that is asked for."""
    from passivity.calculus.ask import of_text
    from passivity.calculus.derivation import derive
    from passivity.calculus.proof import save
    from passivity.status import Kind

    asked.refuse("the structure of a function", "within", "error", "nearest")
    if text.lower().endswith(".txt"):
        text = _read(text)
    assumed = [given for given in asked.parameters if ASSUMPTION.search(given)]
    known = values(tuple(given for given in asked.parameters if given not in assumed))
    if asked.kind == "chain":
        if known:
            raise InputError("--param", "a value in a derivation", "it in place of the name")
        derived = derive(text, asked.z0 or "z0", asked.delay or "T", assumed)
        conclusion, lines = derived.statements[-1][1], str(derived).splitlines()
    else:
        asked.refuse("the structure of a function", "z0", "delay")
        conclusion = of_text(text, Kind.BR if asked.kind == "br" else Kind.PR, assumed, known)
        lines = str(conclusion).splitlines()
    evidence = conclusion.proof or conclusion.witness
    if asked.certificate is not None:
        if evidence is None:
            lines.append("nothing was written: no proof along the expression, and no witness of this kind")
        else:
            save(evidence, asked.certificate)
            lines.append(f"wrote {asked.certificate}")
    told = {
        "kind": conclusion.kind.value,
        "statement": conclusion.statement,
        "status": conclusion.status.value,
        "why": conclusion.why,
        "proof": conclusion.proof,
        "witness": conclusion.witness,
    }
    return Answer(conclusion.status.value, lines, told)


def verified(path: str) -> Answer:
    """Check a file with a proof or a witness."""
    from passivity.calculus.witness import check_file
    from passivity.verifier import FORMAT, check

    try:
        evidence = json.loads(_read(path))
    except ValueError as error:
        raise InputError(path, "not JSON", "a file written by --certificate", str(error)[:60]) from error
    if not isinstance(evidence, dict) or "format" not in evidence:
        raise InputError(path, "neither a proof nor a witness", "a file written by --certificate")
    proof = evidence["format"] == FORMAT
    wrong = check(evidence) if proof else check_file(evidence)
    what = evidence.get("statement") if proof else f"the witness against {evidence.get('text')}"
    line = f"does not hold: {wrong}" if wrong else f"holds: {what}"
    return Answer("refuted" if wrong else "proved", [line], {"holds": wrong is None, "wrong": wrong, "statement": what})


def _read(path: str) -> str:
    try:
        return Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(path, "cannot be read", "a text file", str(error)[:80]) from error
