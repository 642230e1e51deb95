"""`tline fit`: the model that a Touchstone file becomes as a load or a link of a scene, before it is one."""

import json
from typing import TYPE_CHECKING

import click

from tline.cli.options import PICTURE, check_files, check_readable
from tline.errors import InputError

if TYPE_CHECKING:
    from passivity import DelayedModel, MeasuredNetwork

EXAMPLES = """\b
Examples:
  tline fit antenna.s1p --tol 1e-3 --plot fit.png
  tline fit antenna.s1p --delay "1.2 ns" --nearest --json
  tline fit filter.s2p --delay "0.4 ns, 0.6 ns" --nearest --plot fit.png
Exit status: 0 proved passive, 1 not passive or no model within the tolerance, 2 bad input.
"""


@click.command("fit", epilog=EXAMPLES)
@click.argument("file")
@click.option("--tol", default="1e-3", show_default=True, help="Largest distance of the model's S from the file's.")
@click.option(
    "--delay", metavar="T", help="Time to each port, one way, with commas between; of one port found if not given."
)
@click.option("--nearest", is_flag=True, help="Take the nearest passive model where the fit is not passive.")
@click.option("--plot", metavar="FILE", help="|S| and its misfit over frequency; .png, .svg or .pdf.")
@click.option("--json", "as_json", is_flag=True, help="Print the numbers in SI and full precision.")
@click.pass_context
def fit(
    ctx: click.Context, file: str, tol: str, delay: str | None, nearest: bool, plot: str | None, as_json: bool
) -> None:
    """Fit a rational model behind delays to a Touchstone file, and prove it passive.

    It is what a load or a link of kind = "touchstone" in a scene becomes. One port: a lossless line of the file's
    reference resistance and of the delay that saves most poles, then as few poles as the tolerance takes. Several
    ports: poles common to all entries of S, behind the delays that are given. A scene refuses a model that is not
    passive; see here where, and what the nearest passive one costs.
    """
    from passivity.errors import ExpressionError

    check_files({"--plot": (plot, PICTURE)})
    check_readable(file)
    try:
        found = _found(file, tol, delay, nearest)
    except ExpressionError as error:
        where = {"tolerance": "--tol"}.get(error.where, file)
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


def _found(file: str, tol: str, delay: str | None, nearest: bool) -> "DelayedModel | MeasuredNetwork":
    from passivity import fit_behind_delay, fit_scattering, read_touchstone
    from tline.cli.options import options_named
    from tline.scene.quantity import TOLERANCE, Role

    with options_named({"": "--tol"}):
        asked = float(TOLERANCE.parse(tol, ""))
    with options_named({"": "--delay"}):
        time = Role("delay", "s", at_least=0)
        given = None if delay is None else [float(time.parse(part.strip(), "s")) for part in delay.split(",")]
    response = read_touchstone(file)
    if given is not None and len(given) != response.ports:
        raise InputError("--delay", "not one for each port", f"{response.ports}", f"{len(given)}")
    if response.ports > 1:
        return fit_scattering(response, asked, nearest, given or 0.0)
    return fit_behind_delay(response, asked, given[0] if given else None, nearest)


def _show(file: str, found: "DelayedModel | MeasuredNetwork", as_json: bool) -> None:
    from passivity import MeasuredNetwork
    from tline.cli.measured import model_as_dict, model_in_words, network_as_dict, network_in_words

    if as_json:
        told = network_as_dict(found) if isinstance(found, MeasuredNetwork) else model_as_dict(found)
        click.echo(json.dumps(told, indent=2, ensure_ascii=False))
        return
    click.echo(f"{file}: {network_in_words(found) if isinstance(found, MeasuredNetwork) else model_in_words(found)}")
    click.echo(f"  because {found.why}")
    if isinstance(found, MeasuredNetwork):
        click.echo("  S = constant + sum of residues/(s - pole), all in 1/s; matrices of residues with --json:")
        for a in found.model.poles:
            click.echo(f"    pole {complex(a):.6g}" + ", and its conjugate" * bool(a.imag))
        return
    model = found.model
    click.echo(f"  S = {model.constant:.6g}" + " + sum of residue/(s - pole), both in 1/s:" * bool(found.order))
    for a, r in zip(model.poles, model.residues, strict=True):
        other = ", and their conjugates" * bool(a.imag)
        click.echo(f"    pole {complex(a):.6g}, residue {complex(r):.6g}{other}")
