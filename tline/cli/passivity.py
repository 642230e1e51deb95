"""`tline passivity`: is an impedance positive real, or a reflection bounded real? With proof or witness."""

import json
import re
from importlib import import_module
from typing import Any

import click

from tline.cli.options import confined_option
from tline.cli.verdicts.answer import Answer, Asked
from tline.cli.verdicts.expression import verified
from tline.errors import InputError

PICTURE = (".png", ".svg", ".pdf")
SAMPLES = re.compile(r"\.(csv|[syz][0-9]+p|ts)$", re.IGNORECASE)
EXAMPLES = """\b
Examples:
  tline passivity "R + s*L + 1/(s*C)" --param R="50 ohm" --param L="10 nH" --param C="4 pF" --z0 50
  tline passivity "R + s*L + 1/(s*C)" --param "R real" --param "L>0" --param "C>0"
  tline passivity "(s + 2)/(s^2 + s + 1)" --plot refuted.png
  tline passivity "-(1 - s)/(1 + s)" --kind br --json
  tline passivity "25 + 1n*s" --kind chain --z0 50 --delay "3 ns"
  tline passivity "sqrt((1 + 2*s)/(3 + s))*tanh(sqrt((1 + 2*s)*(3 + s)))"
  tline passivity "let z = Z2 + 1n*s; line(50, T*s, z)" --param "Z2 positive real" --param "T>0"
  tline passivity Z2 --kind chain --param "Z2 positive real" --z0 z0 --delay T --param "z0>0" --param "T>0"
  tline passivity "1 + exp(-s)" --certificate proof.json
  tline passivity --verify proof.json
  tline passivity "[2*s + 1, s; s, 2*s]"
  tline passivity scene.toml
  tline passivity measured.s2p --error 0.001 --plot bands.png
  tline passivity measured.csv --kind br --nearest model.json
Exit status: 0 proved, 1 refuted, 3 undecided (and no violation seen in samples), 2 bad input.
"""


class ExpressionCommand(click.Command):
    """Takes an expression that begins with a minus sign for what it is."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """There are no short options but -h, so a dash begins an expression if no second one and a letter follow."""
        try:
            return super().parse_args(ctx, [f" {arg}" if re.match(r"-(?!-[a-z]|-$|h$)", arg) else arg for arg in args])
        except click.NoSuchOption as error:
            raise click.NoSuchOption(f"{error.option_name:.30}", possibilities=error.possibilities, ctx=ctx) from None


@click.command("passivity", cls=ExpressionCommand, epilog=EXAMPLES)
@click.argument("what", required=False)
@click.option(
    "--kind",
    type=click.Choice(["pr", "br", "chain"]),
    help="pr: an impedance (default); br: a reflection; chain: an impedance seen through a line, step by step.",
)
@click.option(
    "--param",
    "parameters",
    metavar="NAME=VALUE",
    multiple=True,
    help="Value of a name, such as R='50 ohm', or what is assumed of it, such as 'R>0', '0<k<=1' or 'k real'; of any"
    " function, 'Z2 positive real' or 'H bounded real'.",
)
@click.option("--z0", metavar="OHM", help="Impedance against which an impedance reflects, 1 if not given.")
@click.option("--delay", metavar="T", help="Look at the impedance through a lossless line of z0 and this delay.")
@click.option(
    "--within",
    metavar="TOLERANCE",
    help="Ask also for all coefficients within a relative tolerance, such as 0.01 or '1 %'.",
)
@click.option("--error", metavar="BAR", help="How far each sample of a file may be from the truth.")
@click.option(
    "--nearest",
    metavar="FILE",
    help="Fit samples and write the nearest passive model; the exit status is then its own. .json: poles and residues;"
    " .s1p, .s2p, ...: its values at the same frequencies.",
)
@click.option("--plot", metavar="FILE", help="Nyquist and Smith chart, |H(jω)|, or samples; .png, .svg or .pdf.")
@click.option("--certificate", metavar="FILE.json", help="Write the proof along the expression, or the witness.")
@click.option("--verify", metavar="FILE.json", help="Check such a file instead, by the rules alone.")
@confined_option
@click.option("--json", "as_json", is_flag=True, help="Print everything exactly, with the certificate.")
@click.pass_context
def passivity(
    ctx: click.Context, what: str | None, plot: str | None, verify: str | None, as_json: bool, **given: Any
) -> None:
    """Prove or refute that an impedance is positive real, or a reflection bounded real.

    WHAT is an expression in s with numbers (exact decimals, with SI prefix or unit), names, + - * / ^, parentheses,
    exp, sqrt, log and hyperbolic functions, line(z0, T*s, load), after "let NAME = EXPRESSION;" as often as needed, or
    a file (.txt) with such text; a matrix [a, b; c, d] of rational ones; a scene (.toml), whose loads are
    checked; or samples (.csv with the header f,re,im, or Touchstone). The answer is a proof, or a point s with
    Re s > 0 where the property fails, to be checked by hand; samples can only refute.
    """
    from passivity import ExpressionError

    if (what is None) == (verify is None):
        raise InputError("WHAT", "one question is needed", "an expression or a file, or --verify FILE.json alone")
    _check_files(plot, given["nearest"], given["certificate"])
    try:
        answer = _answer(what.strip(), Asked(**given)) if what is not None else verified(str(verify))
        drawn = _plot(answer, plot) if plot else []
    except ExpressionError as error:
        where = _option(error.where, "--within" if given["error"] is None else "--error")
        raise InputError(where, error.problem, error.expected, error.got) from error
    if as_json:
        click.echo(json.dumps(answer.told, indent=2, ensure_ascii=False))
    else:
        click.echo("\n".join(answer.lines + drawn))
    ctx.exit(answer.exit_code)


def _answer(what: str, asked: Asked) -> Answer:
    """Ask the one who knows about this kind of thing."""
    if what.lower().endswith(".toml"):
        kind = "scene"
    elif SAMPLES.search(what):
        kind = "samples"
    else:
        kind = "matrix" if what.startswith("[") else "expression"
    return import_module(f"tline.cli.verdicts.{kind}").answer(what, asked)


def _option(where: str, tolerance: str) -> str:
    """The option to act on, where it is one."""
    thing, comma, place = where.partition(", ")
    named = re.sub("^(parameter|assumption) ", "--param ", thing) or "expression"
    options = {"z0": "--z0", "delay": "--delay", "tolerance": tolerance, "assumption": "--param"}
    return options.get(thing, named) + comma + place


def _check_files(plot: str | None, nearest: str | None, certificate: str | None) -> None:
    if plot is None and nearest is None and certificate is None:
        return
    from tline.solver.result.atomic import check_writable

    for option, path, known in (
        ("--plot", plot, PICTURE),
        ("--nearest", nearest, (".json", *(f".s{k}p" for k in range(1, 17)))),
        ("--certificate", certificate, (".json",)),
    ):
        if path is not None:
            if not path.lower().endswith(known):
                raise InputError(option, "unknown kind of file", " or ".join(known[:3]), f"'{path}'")
            check_writable(path)


def _plot(answer: Answer, file: str) -> list[str]:
    from tline.pictures.style import save_figure, styled

    if answer.draw is None:
        raise InputError(
            "--plot", "there is no picture of this", "a rational impedance or reflection without delay, or samples"
        )
    save_figure(styled(answer.draw)(), file)
    return [f"wrote {file}"]
