"""Commands `tline examples`, `demo` and `live`: the scenes that come with tline, and views of one."""

from pathlib import Path

import click

from tline.cli.from_signature import Output, command
from tline.cli.options import make_folder

DEMO = {
    "plot": "pressure.png",
    "space-time": "space_time.png",
    "lattice": "lattice.png",
    "animate": "wave.html",
    "csv": "pressure.csv",
}


@command(
    epilog="""\b
Examples:
  tline examples
  tline examples water_pipe && tline run water_pipe.toml --plot pressure.png
"""
)
def examples(name: str | None = None, *, output: str = ".") -> Output:
    """List the scenes that come with tline; with a NAME copy one, and the files it names, to start from.

    Parameters
    ----------
    output : FOLDER
        Folder to write to; if not given, the working folder.
    as_json
        Print titles, or the files written, as JSON.
    """
    from tline import shipped

    if name is None:
        return Output([repr(shipped.examples)], shipped.examples.titles)
    written = [str(path) for path in shipped.examples.copy(name, output)]
    return Output([*(f"wrote {path}" for path in written), f"now: tline run {written[0]}"], lambda: written)


@command()
def demo(*, output: str = "tline-demo") -> None:
    """Run the scene water_pipe of `tline examples`, with all its pictures.

    At first use the program is compiled, which takes some seconds.

    Parameters
    ----------
    output : FOLDER
        Made if missing.
    """
    from tline.cli.run import run
    from tline.shipped import examples

    make_folder(output)
    scene = examples.path("water_pipe")
    options = [word for option, file in DEMO.items() for word in (f"--{option}", str(Path(output, file)))]
    run.main([str(scene), *options], prog_name="tline run", standalone_mode=False, parent=click.get_current_context())


@command(epilog="\b\nExamples:\n  tline live cable_rc\n  tline live valve.toml --no-browser\n")
def live(scene: str, *, no_browser: bool = False, confined: bool = False) -> None:
    """Open a page on this machine that runs SCENE as its numbers are moved.

    It shows network, traces, extremes, and for a chain the effort over place and time, and exports the scene as TOML
    and as Python. Only this machine can open it, by the address that is printed, until Ctrl-C, or
    after an hour without use.

    Parameters
    ----------
    no_browser
        Print the address alone.
    """
    import webbrowser

    from tline.interchange.any_file import read
    from tline.live.desk import Desk
    from tline.live.server import Server

    with Server(Desk(read(scene, confined=confined), f"tl.read({scene!r})")) as server:
        click.echo(f"{server.address}  (Ctrl-C ends it)")
        if not no_browser:
            webbrowser.open(server.address)
        server.serve()
