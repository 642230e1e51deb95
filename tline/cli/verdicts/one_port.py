"""A rational impedance or reflection: the exact verdict, its margins, robustness, and the way through a line."""

import math
from fractions import Fraction
from typing import TYPE_CHECKING

from tline.cli.verdicts.answer import Answer, Asked, complex_text
from tline.errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from passivity import Chain, Margin, Margins, RationalFunction, Robustness, Verdict

ROWS = (("input", "smallest Re Z(jω)"), ("output", "smallest Re 1/Z(jω)"), ("reflection", "largest |H(jω)|"))


def answer(function: "RationalFunction", asked: Asked) -> Answer:
    """Decide, and say everything that was asked."""
    from passivity import Margins, Status, check_bounded_real, check_line, check_positive_real, margins, robustness
    from passivity.one_port.polynomial_sign import UndecidedError
    from passivity.report import as_dict

    if asked.kind == "br":
        asked.refuse("reflections", "z0", "delay", "within")
    if asked.kind == "chain" and not (asked.z0 and asked.delay):
        missing = "delay" if asked.z0 else "z0"
        raise InputError(f"--{missing}", "is missing", "z0 and delay of the line that --kind chain looks through")
    verdict = (check_bounded_real if asked.kind == "br" else check_positive_real)(function)
    z0, missing = "1" if asked.z0 is None else asked.z0, []
    try:
        found = margins(verdict, z0)
    except UndecidedError as error:
        found, missing = Margins(None, None, None), [f"  margins not found: {error}"]
    tolerance = None if asked.within is None else _tolerance(asked.within)
    robust = None if tolerance is None or verdict.status is Status.UNDECIDED else robustness(verdict, tolerance)
    chain = None if asked.delay is None else check_line(function, z0, asked.delay)
    lines = _text(verdict, found, robust, z0) + missing + ([] if chain is None else _derivation(chain))
    status = verdict.status if chain is None else chain.status
    draw = None if chain is not None else lambda: _draw(verdict, found, z0)
    return Answer(status.value, lines, as_dict(verdict, found, robust, chain), draw)


def _tolerance(text: str) -> Fraction:
    """A number, or a percentage such as "5 %"."""
    from passivity.rational.evaluate import exact

    number = text.strip().removesuffix("%")
    return exact(number, "tolerance") / (1 if number == text.strip() else 100)


def _draw(verdict: "Verdict", margins: "Margins", z0: str) -> "Figure":
    from passivity.expression.number import double
    from passivity.one_port.picture import draw_verdict
    from passivity.rational.evaluate import exact

    return draw_verdict(verdict, margins, double(exact(z0, "z0")))


def _text(verdict: "Verdict", margins: "Margins", robust: "Robustness | None", z0: str) -> list[str]:
    from passivity.expression.number import digits

    lines = [f"{verdict.kind.value}: {verdict.status.value}", f"  because {verdict.why}"]
    if verdict.witness:
        w = verdict.witness
        letter = "Z" if verdict.kind == "positive real" else "H"
        value = "infinite" if w.value_re is None else complex_text(w.value_re, w.value_im or Fraction(0))
        lines += [f"  witness s = {complex_text(w.re, w.im)}", f"    {letter}(s) = {value}"]
    if robust:
        words = {True: "the same", False: "not the same for all", None: "not shown to be the same"}[robust.same]
        lines.append(f"  within {digits(robust.tolerance, 3)} of each coefficient: {words}")
        if robust.exception is not None:
            lines.append(f"    such as {_short(str(robust.exception))}")
    rows = [(name, getattr(margins, key)) for key, name in ROWS]
    against = f"   H = (Z - z0)/(Z + z0), z0 = {z0}" if verdict.kind == "positive real" else ""
    for name, margin in rows:
        if margin is not None:
            sign = "=" if margin.low == margin.high else "≈"
            tail = against if name.startswith("largest") else ""
            lines.append(f"  {name:<20} {sign} {_number(margin):<12} {_place(verdict, margin)}{tail}")
    return lines


def _derivation(chain: "Chain") -> list[str]:
    from passivity import admittance_identity, reflection_identity
    from passivity.expression.number import digits

    lines = ["", f"through a line of z0 = {digits(chain.z0)} and delay T = {digits(chain.delay)}:"]
    for step in chain.steps:
        lines += [f"  {step.claim}: {step.status.value}", f"    because {step.reason}"]
    used = [identity for steps in (reflection_identity(), admittance_identity()) for identity in steps[-1:]]
    lines += ["  with the identities, checked as polynomials:"]
    return [*lines, *(f"    {identity.text}" for identity in used if identity.holds)]


def _place(verdict: "Verdict", margin: "Margin") -> str:
    if verdict.lossless:
        return "for all ω"
    if math.isinf(margin.frequency):
        return "for ω to infinity"
    return f"at ω = {margin.frequency:.6g} rad/s"


def _number(margin: "Margin") -> str:
    """Six digits, and more where they would hide on which side of 1 a number lies."""
    from passivity.expression.number import digits

    text = digits(margin.middle)
    if text == "1" and margin.low != 1:
        return f"1 {'-' if margin.low < 1 else '+'} {digits(abs(Fraction(margin.low) - 1), 3)}"
    return text


def _short(text: str) -> str:
    return text if len(text) <= 100 else text[:97] + "..."
