"""`tline passivity`: is an impedance positive real, or a reflection bounded real? With proof or witness."""

import json
import math
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import click

from tline.errors import InputError

if TYPE_CHECKING:
    from passivity import Chain, Margin, Margins, Robustness, Verdict

PICTURE = (".png", ".svg", ".pdf")
EXIT = {"proved": 0, "refuted": 1, "undecided": 3}
LONGEST = 40  # characters of a fraction that is printed as one
ROWS = (("input", "smallest Re Z(jω)"), ("output", "smallest Re 1/Z(jω)"), ("reflection", "largest |H(jω)|"))
EXAMPLES = """\b
Examples:
  tline passivity "R + s*L + 1/(s*C)" --param R="50 ohm" --param L="10 nH" --param C="4 pF" --z0 50
  tline passivity "(s^2 + s + 1)/(s^2 + s + 4)" --within 1e-9
  tline passivity "(1 - s)/(1 + s)" --kind br --plot allpass.png
  tline passivity "25 + 1n*s" --z0 50 --delay "3 ns"
  tline passivity "(s + 2)/(s^2 + s + 1)"
The last is refuted: Re Z falls to -0.1547, so with 0.155 in series it is proved.
Write -- before an expression that begins with a minus sign.
Exit status: 0 proved, 1 refuted, 3 undecided, 2 bad input.
"""


@click.command("passivity", epilog=EXAMPLES)
@click.argument("expression")
@click.option("--kind", type=click.Choice(["pr", "br"]), default="pr", help="pr: an impedance; br: a reflection.")
@click.option("--param", "parameters", metavar="NAME=VALUE", multiple=True, help="Value of a name, such as R='50 ohm'.")
@click.option("--z0", metavar="OHM", help="Impedance against which an impedance reflects, 1 if not given.")
@click.option("--delay", metavar="T", help="Look at the impedance through a lossless line of z0 and this delay.")
@click.option("--within", metavar="TOLERANCE", help="Ask also for all coefficients within a relative tolerance.")
@click.option("--plot", metavar="FILE", help="Z(jω) in the plane and |H(jω)|; .png, .svg or .pdf.")
@click.option("--json", "as_json", is_flag=True, help="Print everything exactly, with the certificate.")
@click.pass_context
def passivity(ctx: click.Context, expression: str, **given: Any) -> None:
    """Prove or refute that an impedance is positive real, or a reflection bounded real.

    EXPRESSION is rational in s: numbers (exact decimals, with SI prefix or unit), names, + - * / ^ and parentheses.
    The answer is exact: a proof, or a point s with Re s > 0 where the property fails, to be checked by hand.
    """
    from passivity import ExpressionError

    _check_file(given["plot"])
    if given["kind"] == "br":
        for option in ("z0", "delay", "within"):
            if given[option] is not None:
                raise InputError(f"--{option}", "is about impedances", "--kind pr beside it")
    try:
        verdict, margins, robust, chain = _answer(expression, given)
    except ExpressionError as error:
        where = {"z0": "--z0", "delay": "--delay", "tolerance": "--within"}.get(
            error.where, error.where or "expression"
        )
        where = f"--param {where.removeprefix('parameter ')}" if where.startswith("parameter ") else where
        raise InputError(where, error.problem, error.expected, error.got) from error
    if given["plot"]:
        _plot(verdict, margins, given)
    if given["as_json"]:
        from passivity.report import as_dict

        click.echo(json.dumps(as_dict(verdict, margins, robust, chain), indent=2, ensure_ascii=False))
    else:
        click.echo("\n".join(_text(verdict, margins, robust, given["z0"]) + (_derivation(chain) if chain else [])))
        if given["plot"]:
            click.echo(f"wrote {given['plot']}")
    ctx.exit(EXIT[chain.status if chain else verdict.status])


def _answer(expression: str, given: dict[str, Any]) -> "tuple[Verdict, Margins, Robustness | None, Chain | None]":
    from passivity import (
        Margins,
        RationalFunction,
        Status,
        check_bounded_real,
        check_line,
        check_positive_real,
        margins,
        robustness,
    )
    from passivity.one_port.polynomial_sign import UndecidedError

    function = RationalFunction.from_expression(expression, _parameters(given["parameters"]))
    verdict = (check_positive_real if given["kind"] == "pr" else check_bounded_real)(function)
    z0, within, delay = given["z0"] or 1, given["within"], given["delay"]
    try:
        found = margins(verdict, z0)
    except UndecidedError:
        found = Margins(None, None, None)
    robust = None if within is None or verdict.status is Status.UNDECIDED else robustness(verdict, within)
    return verdict, found, robust, None if delay is None else check_line(function, z0, delay)


def _parameters(given: tuple[str, ...]) -> dict[str, str]:
    values: dict[str, str] = {}
    for text in given:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise InputError("--param", "not a name with a value", "NAME=VALUE such as R='50 ohm'", f"'{text:.60}'")
        if name in values:
            raise InputError(f"--param {name}", "given twice", "one value", f"'{values[name]:.30}' and '{value:.30}'")
        values[name] = value
    return values


def _check_file(path: str | None) -> None:
    if path is None:
        return
    from tline.solver.atomic import check_writable

    if not path.lower().endswith(PICTURE):
        raise InputError("--plot", "unknown kind of file", " or ".join(PICTURE), f"'{path}'")
    check_writable(path)


def _plot(verdict: "Verdict", margins: "Margins", given: dict[str, Any]) -> None:
    from passivity.one_port.picture import draw_verdict
    from passivity.rational.evaluate import exact
    from tline.pictures.style import save_figure, styled

    save_figure(styled(draw_verdict)(verdict, margins, float(exact(given["z0"] or 1, "z0"))), given["plot"])


def _text(verdict: "Verdict", margins: "Margins", robust: "Robustness | None", z0: str | None) -> list[str]:
    lines = [f"{verdict.kind.value}: {verdict.status.value}", f"  because {verdict.why}"]
    if verdict.witness:
        w = verdict.witness
        letter = "Z" if verdict.kind == "positive real" else "H"
        value = "infinite" if w.value_re is None else _complex(w.value_re, w.value_im or Fraction(0))
        lines += [f"  witness s = {_complex(w.re, w.im)}", f"    {letter}(s) = {value}"]
    if robust:
        words = {True: "the same", False: "not the same for all", None: "not shown to be the same"}[robust.same]
        lines.append(f"  within {float(robust.tolerance):.3g} of each coefficient: {words}")
        if robust.exception is not None:
            lines.append(f"    such as {_short(str(robust.exception))}")
    rows = [(name, getattr(margins, key)) for key, name in ROWS]
    against = f"   H = (Z - z0)/(Z + z0), z0 = {z0 or 1}" if verdict.kind == "positive real" else ""
    for name, margin in rows:
        if margin is not None:
            sign = "=" if margin.low == margin.high else "≈"
            tail = against if name.startswith("largest") else ""
            lines.append(f"  {name:<20} {sign} {_number(margin):<12} {_place(verdict, margin)}{tail}")
    return lines


def _derivation(chain: "Chain") -> list[str]:
    lines = ["", f"through a line of z0 = {float(chain.z0):.6g} and delay T = {float(chain.delay):.6g}:"]
    for step in chain.steps:
        lines += [f"  {step.claim}: {step.status.value}", f"    because {step.reason}"]
    return lines


def _place(verdict: "Verdict", margin: "Margin") -> str:
    if verdict.lossless:
        return "for all ω"
    if math.isinf(margin.frequency):
        return "for ω to infinity"
    return f"at ω = {margin.frequency:.6g} rad/s"


def _number(margin: "Margin") -> str:
    """Six digits, and more where they would hide on which side of 1 a number lies."""
    text = f"{margin.value:.6g}"
    if text == "1" and margin.low != 1:
        return f"1 {'-' if margin.low < 1 else '+'} {abs(float(Fraction(margin.low) - 1)):.3g}"
    return text


def _complex(re: Fraction, im: Fraction) -> str:
    exact = f"{re} {'-' if im < 0 else '+'} {abs(im)}j"
    if len(exact) <= LONGEST:
        return exact
    return f"{float(re):.12g} {'-' if im < 0 else '+'} {abs(float(im)):.12g}j  (rounded; exactly: --json)"


def _short(text: str) -> str:
    return text if len(text) <= 100 else text[:97] + "..."
