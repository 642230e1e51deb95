"""A rational impedance or reflection: the exact verdict, its margins, robustness, and the way through a line."""

from fractions import Fraction
from typing import TYPE_CHECKING

from tline.cli.verdicts.answer import Answer, Asked
from tline.errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from passivity import Margins, RationalFunction, Verdict


def answer(function: "RationalFunction", asked: Asked) -> Answer:
    """Decide, and say everything that was asked."""
    from passivity import Margins, Status, check_bounded_real, check_line, check_positive_real, margins, robustness
    from passivity.exact.report import as_dict, in_lines
    from passivity.polynomial.sign import UndecidedError

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
        found, missing = Margins(), [f"  margins not found: {error}"]
    tolerance = None if asked.within is None else _tolerance(asked.within)
    robust = None if tolerance is None or verdict.status is Status.UNDECIDED else robustness(verdict, tolerance)
    chain = None if asked.delay is None else check_line(function, z0, asked.delay)
    lines = in_lines(verdict, found, robust, z0) + missing + ([] if chain is None else ["", *chain.text_lines()])
    status = verdict.status if chain is None else chain.status
    draw = None if chain is not None else lambda: _draw(verdict, found, z0)
    told = as_dict(verdict, found, robust) | ({} if chain is None else {"line": chain.to_dict()})
    return Answer(status.value, lines, told, draw)


def _tolerance(text: str) -> Fraction:
    """A number, or a percentage such as "5 %"."""
    from passivity.rational.evaluate import exact

    number = text.strip().removesuffix("%")
    return exact(number, "tolerance") / (1 if number == text.strip() else 100)


def _draw(verdict: "Verdict", margins: "Margins", z0: str) -> "Figure":
    from passivity.exact.picture import draw_verdict
    from passivity.expression.number import double
    from passivity.rational.evaluate import exact

    return draw_verdict(verdict, margins, double(exact(z0, "z0")))
