"""`tline demo`: a valve shuts at the end of a water pipe; numbers, pictures and an animation."""

from pathlib import Path

import click

from tline.cli.from_signature import command

FILES = {
    "plot": "pressure.png",
    "space-time": "space_time.png",
    "lattice": "lattice.png",
    "animate": "wave.html",
    "csv": "pressure.csv",
}


@command()
def demo(*, output: str = "tline-demo") -> None:
    """Run the scene water_pipe of `tline examples`, with all that can be drawn of it.

    The first time, what it needs is compiled, which takes some seconds.

    Parameters
    ----------
    output : FOLDER
        Made if missing.
    """
    from tline.cli.run import run
    from tline.errors import InputError
    from tline.shipped import examples

    try:
        Path(output).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(output, "cannot be made", "a folder", (error.strerror or str(error)).lower()) from None
    scene = examples.path("water_pipe")
    options = [word for option, file in FILES.items() for word in (f"--{option}", str(Path(output, file)))]
    run.main([str(scene), *options], prog_name="tline run", standalone_mode=False, parent=click.get_current_context())
