"""`tline fit`: the model that a Touchstone file becomes as a load of a scene, before it is one."""

import json
from typing import TYPE_CHECKING

import click

from tline.cli.options import PICTURE, check_files
from tline.errors import InputError

if TYPE_CHECKING:
    from passivity.sampled.behind_delay import DelayedModel

EXAMPLES = """\b
Examples:
  tline fit antenna.s1p --tolerance 1e-3 --plot fit.png
  tline fit antenna.s1p --delay "1.2 ns" --nearest --json
Exit status: 0 proved passive, 1 not passive or no model within the tolerance, 2 bad input.
"""


@click.command("fit", epilog=EXAMPLES)
@click.argument("file")
@click.option(
    "--tolerance", default="1e-3", show_default=True, help="Largest distance of the model's S from the file's."
)
@click.option("--delay", metavar="T", help="Time to the one-port, one way; found if not given, 0 for none.")
@click.option("--nearest", is_flag=True, help="Take the nearest passive model where the fit is not passive.")
@click.option("--plot", metavar="FILE", help="|S| and the misfit over frequency; .png, .svg or .pdf.")
@click.option("--json", "as_json", is_flag=True, help="Print the numbers in SI and full precision.")
@click.pass_context
def fit(
    ctx: click.Context, file: str, tolerance: str, delay: str | None, nearest: bool, plot: str | None, as_json: bool
) -> None:
    """Fit a rational model behind a delay to a Touchstone file of one port, and prove it passive.

    It is what a load of kind = "touchstone" in a scene becomes: a lossless line of the file's reference resistance
    and of the delay that saves most poles, then as few poles as the tolerance takes. A scene refuses a model that is
    not passive; see here where, and what the nearest passive one costs.
    """
    from passivity.errors import ExpressionError

    check_files({"--plot": (plot, PICTURE)})
    try:
        found = _found(file, tolerance, delay, nearest)
    except ExpressionError as error:
        where = {"tolerance": "--tolerance", "samples": file}.get(error.where, error.where)
        told = InputError(where, error.problem, error.expected, error.got)
        if error.where != "tolerance":
            raise told from error
        click.echo(str(told), err=True)
        ctx.exit(1)
    _show(file, found, as_json)
    if plot:
        from tline.pictures.misfit import plot_misfit
        from tline.pictures.style import save_figure

        save_figure(plot_misfit(found, file), plot)
        if not as_json:
            click.echo(f"wrote {plot}")
    ctx.exit(0 if found.verdict.status.value == "proved" else 1)


def _found(file: str, tolerance: str, delay: str | None, nearest: bool) -> "DelayedModel":
    from passivity.sampled.behind_delay import fit_behind_delay
    from passivity.sampled.read import read_touchstone
    from tline.cli.options import options_named
    from tline.scene.quantity import TOLERANCE, Role

    with options_named({"": "--tolerance"}):
        asked = float(TOLERANCE.parse(tolerance, ""))
    with options_named({"": "--delay"}):
        given = None if delay is None else float(Role("delay", "s", at_least=0).parse(delay, "s"))
    return fit_behind_delay(read_touchstone(file), asked, given, nearest)


def _show(file: str, found: "DelayedModel", as_json: bool) -> None:
    from tline.cli.measured import model_as_dict, model_in_words

    if as_json:
        click.echo(json.dumps(model_as_dict(found), indent=2, ensure_ascii=False))
        return
    click.echo(f"{file}: {model_in_words(found)}")
    click.echo(f"  because {found.why}")
    click.echo(f"  S = {found.model.constant:.6g}" + " + sum of residue/(s - pole), both in 1/s:" * bool(found.order))
    for a, r in zip(found.model.poles, found.model.residues, strict=True):
        other = ", and their conjugates" * bool(a.imag)
        click.echo(f"    pole {complex(a):.6g}, residue {complex(r):.6g}{other}")
