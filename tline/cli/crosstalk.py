"""`tline crosstalk`: what a driven conductor sends into those beside it."""

import json

import click

from tline.cli.options import PICTURE, check_files, confined_option, options_named, tol_option, tolerance

EXAMPLES = """\b
Examples:
  tline crosstalk scenes/skin_pair.toml --plot crosstalk.png
  tline crosstalk scenes/coupled_pair.toml --csv crosstalk.csv --json
"""


@click.command("crosstalk", epilog=EXAMPLES)
@click.argument("scene")
@click.option("--line", metavar="NAME", help="Coupled conductors; not needed if there are no others.")
@click.option("--csv", metavar="FILE.csv", help="Voltages of all conductors, differences and means of pairs.")
@click.option("--plot", metavar="FILE", help="Driven and quiet conductors, and modes of a pair; .png, .svg or .pdf.")
@tol_option
@confined_option
@click.option("--json", "as_json", is_flag=True, help="Print the numbers in SI and full precision.")
def crosstalk(
    scene: str, line: str | None, csv: str | None, plot: str | None, tol: str | None, confined: bool, as_json: bool
) -> None:
    """Run a scene with coupled conductors, one of which is driven, and compare the others with it.

    Near-end crosstalk (NEXT) is the largest change of voltage of a quiet conductor at the driven side, far-end
    crosstalk (FEXT) that at the other side, both over the swing of the driven end. Differential and common mode are
    the difference and the mean of two conductors at one end.
    """
    check_files({"--csv": (csv, (".csv",)), "--plot": (plot, PICTURE)})
    from tline.scene.file import read_scene
    from tline.signal.crosstalk import crosstalk as measure
    from tline.signal.crosstalk import save_crosstalk

    read = read_scene(scene, confined=confined)
    with options_named({"line": "--line"}):
        seen = measure(read, line, tol=None if tol is None else tolerance(tol), progress=True)
    if csv:
        save_crosstalk(seen, csv)
    if plot:
        from tline.pictures.crosstalk import plot_crosstalk
        from tline.pictures.style import save_figure

        save_figure(plot_crosstalk(seen, read.title), plot)
    modes = {
        ", ".join(pair): {"differential": float(abs(u).max()), "common": float(abs(seen.common[pair]).max())}
        for pair, u in seen.differential.items()
    }
    if as_json:
        told = {"line": seen.line, "driven": seen.driven, "swing": seen.swing, "near": seen.near, "far": seen.far}
        click.echo(json.dumps(told | {"modes": modes}))
        return
    click.echo(f"'{seen.driven}' of '{seen.line}' swings by {seen.swing:.6g} V")
    for word, shares in (("near end", seen.near), ("far end", seen.far)):
        for node, share in shares.items():
            click.echo(f"{word} '{node}' {share * seen.swing:.6g} V, {100 * share:.4g} %")
    for pair, each in modes.items():
        click.echo(f"{pair}: differential up to {each['differential']:.6g} V, common up to {each['common']:.6g} V")
    for file in filter(None, (csv, plot)):
        click.echo(f"wrote {file}")
