"""Commands for scenes as files: `tline import`, `export`, `schema`, `examples`, `demo` and `live`."""

import json
from pathlib import Path
from typing import Any

import click

from tline.cli.from_signature import Output, command
from tline.cli.options import hours, make_folder, print_or_write
from tline.errors import InputError

READ = "tline.interchange.water_scene:read_inp"


@command(
    READ,
    names={"hour": "at_hour"},
    omit=("path",),
    epilog="""\b
Examples:
  tline import cable.cir -o cable.toml
  tline import cable.cir | head
  tline import town.inp --wave-speed "1000 m/s" -o town.toml
  tline import town.inp --material walls.csv --at-hour 17 -o evening.toml
""",
)
def import_(file: str, *, output: str | None = None, **given: Any) -> None:
    """Turn another program's file into a scene.

    FILE is a SPICE netlist (.cir, .ckt, .net, .sp, .spi), a schematic of LTspice (.asc) or a network of EPANET (.inp).
    Elements that scenes lack are refused, all at once, by line or name. Parts left out without harm are noted.

    Parameters
    ----------
    output : SCENE.toml
        Write the scene to a file instead of printing it.
    """
    from tline.interchange.any_file import read_foreign
    from tline.scene.file import scene_text

    given |= {"hour": hours(given["hour"])} if "hour" in given else {}
    scene, notes = read_foreign(Path(file), **given)
    for note in notes:
        click.echo(f"note: {note}", err=True)
    print_or_write(scene_text(scene), output)


@command(
    epilog="""\b
Examples:
  tline export cable.toml -o cable.cir
  tline export cable.toml --rise "1 ps" | head
"""
)
def export(scene: str, *, output: str | None = None, rise: str | None = None, confined: bool = False) -> None:
    """Turn an electrical scene into a SPICE netlist.

    Lines become T elements, sources V or I with their resistors, loads R, L and C, probes .save, all values exact.
    Elements that netlists lack are refused by name.

    Parameters
    ----------
    output : FILE.cir
        Write the netlist to a file instead of printing it.
    rise : TIME
        Duration of a jump in the netlist, such as '1 ps': SPICE has no jumps.
    """
    from tline.interchange.any_file import read
    from tline.interchange.netlist_text import spice_text
    from tline.units import to_si

    if output is not None and not output.lower().endswith(".cir"):
        raise InputError("--output", "unknown kind of file", ".cir", f"'{output}'")
    seconds = None if rise is None else to_si(rise, "s", "--rise")
    if seconds is not None and not seconds > 0:
        raise InputError("--rise", "not above zero", "a time such as '1 ps'", rise or "")
    print_or_write(spice_text(read(scene, confined=confined), seconds), output)


@command(
    epilog="""\b
Examples:
  tline schema -o scene.schema.json
  tline schema | head
"""
)
def schema(*, output: str | None = None) -> None:
    """Print the JSON schema of scene files.

    An editor with TOML support completes and checks scenes with it; the first line of the scene names it:
    `#:schema scene.schema.json`.

    Parameters
    ----------
    output : FILE
        Write to a file instead of printing.
    """
    from tline.scene.file import schema as describe

    print_or_write(json.dumps(describe(), indent=2, ensure_ascii=False) + "\n", output)


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
    from tline.live.desk import Desk, Server

    with Server(Desk(read(scene, confined=confined), f"tl.read({scene!r})")) as server:
        click.echo(f"{server.address}  (Ctrl-C ends it)")
        if not no_browser:
            webbrowser.open(server.address)
        server.serve()
