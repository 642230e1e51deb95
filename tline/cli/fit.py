"""Command `tline fit`: the model of a Touchstone file as a load or a link, before its use in a scene."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

from tline.cli.from_signature import Output, command, drawn, picture
from tline.cli.measured import as_dict, bands_in_words
from tline.cli.options import check_readable, options_named
from tline.errors import InputError

if TYPE_CHECKING:
    from passivity import DelayedModel

MOST_POLES = 200
EXAMPLES = """\b
Examples:
  tline fit antenna.s1p --tol 1e-3 --plot fit.png
  tline fit antenna.s1p --delay "1.2 ns" --nearest --json
  tline fit filter.s2p --delay "0.4 ns, 0.6 ns" --nearest --plot fit.png
  tline fit channel.s2p --tol 1e-3 --nearest --json
Exit status: 0 proved passive, 1 not passive or no model within the tolerance, 2 bad input.
"""


@command(files={"plot": picture("|S| and its misfit over frequency")}, epilog=EXAMPLES)
def fit(file: str, *, tol: str = "1e-3", delay: str | None = None, nearest: bool = False) -> Output:
    """Fit a rational model behind delays to a Touchstone file, and prove it passive.

    A load or a link of kind = "touchstone" in a scene becomes this model. One port: a lossless line of the file's
    reference resistance and of the delay that saves most poles, then as few poles as the tolerance allows. Several
    ports: poles common to all entries of S, up to 200, behind the delays that are given or found. A scene refuses a
    model that is not passive; this shows where, and the error of the nearest passive one at its frequencies.

    Parameters
    ----------
    tol : NUMBER
        Largest distance of the model's S from the file's.
    delay : TIME
        To each port, one way, with commas between; found if not given, of up to four ports.
    nearest
        Take the nearest passive model where the fit is not passive or not within the tolerance, even where the file's
        own S is not passive.
    """
    from passivity.errors import ExpressionError

    check_readable(file)
    try:
        found = _found(file, tol, delay, nearest)
    except ExpressionError as error:
        where = {"tolerance": "--tol"}.get(error.where, file)
        told = InputError(where, error.problem, error.expected, error.got)
        if error.where != "tolerance":
            raise told from error
        click.echo(str(told), err=True)
        raise click.exceptions.Exit(1) from None
    files = {"plot": drawn("tline.pictures.bode:plot_misfit", found, file)}
    met = found.verdict.proved and found.meets(float(tol))
    return Output(_text(file, found, float(tol)), lambda: as_dict(found), files, exit_code=0 if met else 1)


def _found(file: str, tol: str, delay: str | None, nearest: bool) -> "DelayedModel":
    from passivity import fit_scattering, read_touchstone
    from tline.scene.quantity import FIT_TOLERANCE, Role

    with options_named({"": "--tol"}):
        asked = float(FIT_TOLERANCE.parse(tol, ""))
    with options_named({"": "--delay"}):
        time = Role("delay", "s", at_least=0)
        given = None if delay is None else [float(time.parse(part.strip(), "s")) for part in delay.split(",")]
    response = read_touchstone(file)
    if given is not None and len(given) != response.ports:
        raise InputError("--delay", "not one for each port", f"{response.ports}", f"{len(given)}")
    with trying() as tried:
        return fit_scattering(response, asked, nearest, given, tried)


@contextmanager
def trying() -> Iterator[Callable[[int, float], None]]:
    """Show on a terminal a bar of the poles of a model; yields a function to call after each attempt."""
    from tline.words.progress import Progress

    most = 0
    with Progress(MOST_POLES, "poles", sys.stderr.isatty(), "fit") as bar:

        def tried(order: int, error: float) -> None:
            nonlocal most
            bar.update(max(order - most, 0))
            most = max(order, most)

        yield tried


def _text(file: str, found: "DelayedModel", tol: float) -> Iterator[str]:
    yield f"{file}: {found.summary}"
    yield f"  because {found.why}"
    yield from bands_in_words(found, tol)
    model = found.model
    if found.samples.ports == 1:
        yield f"  S = {model.constant:.6g}" + " + sum of residue/(s - pole), both in 1/s:" * bool(len(model.poles))
        for a, r in zip(model.poles, model.residues, strict=True):
            other = ", and their conjugates" * bool(a.imag)
            yield f"    pole {complex(a):.6g}, residue {complex(r):.6g}{other}"
        return
    yield "  S = constant + sum of residues/(s - pole), all in 1/s; matrices of residues with --json:"
    for a in model.poles:
        yield f"    pole {complex(a):.6g}" + ", and its conjugate" * bool(a.imag)
