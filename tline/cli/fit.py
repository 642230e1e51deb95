"""Command `tline fit`: the model of a Touchstone file as a load or a link, before its use in a scene."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from tline.cli.from_signature import Output, command, drawn, picture
from tline.cli.options import options_named
from tline.errors import InputError
from tline.units import engineering

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from passivity import DelayedModel

MOST_BANDS = 4
MOST_POLES = 200
EXAMPLES = """\b
Examples:
  tline fit antenna.s1p --tol 1e-3 --plot fit.png
  tline fit antenna.s1p --delay "1.2 ns" --nearest --json
  tline fit filter.s2p --delay "0.4 ns, 0.6 ns" --nearest --plot fit.png
  tline fit channel.s2p --tol 1e-3 --nearest --json
Exit status: 0 proved passive, 1 not passive or no model within the tolerance, 2 bad input.
"""


def as_dict(found: "DelayedModel") -> dict[str, Any]:
    """Poles and verdict, and distance of the model from the samples, in SI.

    With several ports residues and constant are matrices, and there is a delay for each. The distance is the largest of
    an entry at each frequency of the file.
    """
    model, samples = found.model, found.samples
    one = samples.ports == 1
    return {
        "status": found.verdict.status.value,
        "why": found.why,
        "delay": found.delay if one else found.delay.tolist(),
        "z0": float(samples.z0[0]) if one else samples.z0.tolist(),
        "poles": _parts(model.poles),
        "residues": _parts(model.residues),
        "constant": model.constant if one else model.constant.tolist(),
        "order": found.order,
        "error": found.error,
        "cost": found.cost,
        "distance": found.distance.tolist(),
        "samples": {"number": len(samples.f), "first": float(samples.f[0]), "last": float(samples.f[-1])},
    }


def bands_in_words(found: "DelayedModel", tolerance: float) -> Iterator[str]:
    """Describe where model and samples differ by more than the tolerance, in a line for each of the worst bands."""
    import numpy as np

    f, distance = found.samples.f, found.distance
    edges = np.flatnonzero(np.diff(distance > tolerance, prepend=False, append=False)).reshape(-1, 2)
    bands = sorted(edges, key=lambda edge: -distance[slice(*edge)].max())
    for start, stop in bands[:MOST_BANDS]:
        k = start + int(distance[start:stop].argmax())
        low, high, at = (engineering(float(x), "Hz") for x in f[[start, stop - 1, k]])
        yield f"  beyond the tolerance from {low} to {high}, by up to |ΔS| = {distance[k]:.3g} at {at}"
    if len(bands) > MOST_BANDS:
        yield f"  and in {len(bands) - MOST_BANDS} more bands"


def _parts(values: "NDArray[np.complex128]") -> list[Any]:
    """Real and imaginary part of each value."""
    import numpy as np

    return np.stack([values.real, values.imag], axis=-1).tolist()


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
    from tline.scene.text_file import check_readable

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
