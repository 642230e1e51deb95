"""Command `tline passivity`: prove or refute that an impedance is positive real, or a reflection bounded real."""

import re
from typing import TYPE_CHECKING, Literal

import click

from tline.cli import verdicts
from tline.cli.from_signature import Command, FileKind, Output, command, picture
from tline.errors import InputError

if TYPE_CHECKING:
    from passivity import ExpressionError

SAMPLES = re.compile(r"\.(csv|[syz][0-9]+p|ts)$", re.IGNORECASE)
FILES = {
    "nearest": FileKind(
        (".json", *(f".s{ports}p" for ports in range(1, 17))),
        "Fit samples and write the nearest passive model; the exit status is then its own. .json: poles and residues;"
        " .s1p, .s2p, ...: its values at the same frequencies",
    ),
    "plot": picture("Nyquist and Smith chart, |H(jω)|, singular values, or samples"),
    "certificate": FileKind((".json",), "Write the proof along the expression, or the witness"),
}
PICTURED = "a function without names and line, a matrix, or samples"
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
  tline passivity "[2*s + 1, s; s, 2*s]" --plot eigenvalues.png
  tline passivity "(z + 1)/(z - 1)"
  tline passivity "(s + 2)/(s + 1)" --sector 1,2
  tline passivity "(1 + H/z)/(1 - H/z)" --param "H bounded real"
  tline passivity scene.toml
  tline passivity measured.s2p --error 0.001 --plot bands.png
  tline passivity measured.csv --kind br --nearest model.json
Exit status: 0 proved, 1 refuted, 3 undecided (and no violation seen in samples), 2 bad input.
"""


class ExpressionCommand(Command):
    """Command that accepts an expression beginning with a minus sign."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Take a dash as the start of an expression, except in -h and before a second dash with a letter."""
        try:
            return super().parse_args(ctx, [f" {arg}" if re.match(r"-(?!-[a-z]|-$|h$)", arg) else arg for arg in args])
        except click.NoSuchOption as error:
            raise click.NoSuchOption(f"{error.option_name:.30}", possibilities=error.possibilities, ctx=ctx) from None


@command(names={"parameters": "param"}, files=FILES, epilog=EXAMPLES, kind=ExpressionCommand)
def passivity(
    what: str = "",
    *,
    kind: Literal["pr", "br", "chain"] | None = None,
    parameters: tuple[str, ...] = (),
    z0: str | None = None,
    delay: str | None = None,
    within: str | None = None,
    sector: str | None = None,
    supply: str | None = None,
    error: str | None = None,
    verify: str | None = None,
    confined: bool = False,
    files: dict[str, str],
) -> Output:
    """Prove or refute that an impedance is positive real, or a reflection bounded real.

    WHAT is an expression in s, or in z for a function of discrete time outside the unit disc, with numbers (exact
    decimals, with SI prefix or unit), names, + - * / ^, parentheses, exp, sqrt, log and hyperbolic functions,
    line(z0, T*s, load), after "let NAME = EXPRESSION;" as often as needed, or a file (.txt) with such text; a matrix
    [a, b; c, d] of rational ones; a scene (.toml), whose loads are checked; or samples (.csv with the header f,re,im,
    or Touchstone). The answer is a proof, or a point s with Re s > 0 where the property fails, to be checked by hand;
    samples can only refute. Of an impedance the smallest Re Z is its input index, the smallest Re 1/Z its output index.

    Parameters
    ----------
    kind
        pr: an impedance (default); br: a reflection; chain: an impedance seen through a line, step by step.
    parameters : NAME=VALUE
        Value of a name, such as R='50 ohm', or an assumption, such as 'R>0', '0<k<=1' or 'k real'; of any
        function, 'Z2 positive real' or 'H bounded real'.
    z0 : OHM
        Impedance against which an impedance reflects, 1 if not given.
    delay : T
        Look at the impedance through a lossless line of z0 and this delay.
    within : TOLERANCE
        Require it also for all coefficients within a relative tolerance, such as 0.01 or '1 %'.
    sector : LOW,HIGH
        Ask whether all values lie in the disc on these ends, or, with inf, in a half-plane: 0.5,inf is an input index.
    supply : Q,S,R
        Ask whether Q |W|^2 + 2 S Re W + R >= 0 of all values W: dissipative for this supply.
    error : BAR
        Largest distance of each sample of a file from its true value.
    verify : FILE.json
        Check such a file instead, by the rules alone.
    as_json
        Print everything exactly, with the certificate.
    """
    from passivity import ExpressionError

    if bool(what) == (verify is not None):
        raise InputError("WHAT", "one question is needed", "an expression or a file, or --verify FILE.json alone")
    given = kind, parameters, z0, delay, within, error
    asked = verdicts.Asked(*given, files.get("nearest"), files.get("certificate"), sector, supply, confined)
    try:
        output = _answer(what.strip(), asked) if verify is None else verdicts.verified(verify)
    except ExpressionError as problem:
        raise _named(problem, "--within" if error is None else "--error") from problem
    if "plot" in files and "plot" not in output.files:
        raise InputError("--plot", "there is no picture of this", PICTURED)
    return output


def _answer(what: str, asked: verdicts.Asked) -> Output:
    """Answer by the kind of input."""
    if what.lower().endswith(".toml"):
        return verdicts.scene(what, asked)
    if SAMPLES.search(what):
        return verdicts.samples(what, asked)
    return (verdicts.matrix if what.startswith("[") else verdicts.expression)(what, asked)


def _named(error: "ExpressionError", tolerance: str) -> InputError:
    """Return the error with the option to act on in place of the argument, where there is one."""
    thing, comma, place = error.where.partition(", ")
    named = re.sub("^(parameters?|assumption) ", "--param ", thing) or "expression"
    options = {"z0": "--z0", "delay": "--delay", "tolerance": tolerance, "assumption": "--param"}
    options |= {"sector": "--sector", "supply": "--supply"}
    return InputError(options.get(thing, named) + comma + place, error.problem, error.expected, error.got)
