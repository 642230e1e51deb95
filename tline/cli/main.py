"""Command `tline`: finds a subcommand by name, imports only that one, and reports errors in one sentence.

Text cannot steer the terminal, and closed or full streams do no harm.
"""

import atexit
import gc
import io
import os
import sys
import traceback
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from threading import active_count
from typing import Any, TextIO

import click

from tline.errors import ActiveError, InputError, LeftOutWarning, NotKeptWarning
from tline.words.wording import printable


class UnreadError(Exception):
    """The reader of the output is gone."""


class Printable(io.TextIOBase):
    """Stream that writes control characters as ``\\u001b``; a carriage return in front, of a progress bar, stays.

    Parameters
    ----------
    stream : TextIO
        Target of the text.
    optional : bool
        Whether text that cannot be written there is dropped.
    """

    encoding, errors = "utf-8", "replace"

    def __init__(self, stream: TextIO, optional: bool):
        self.stream, self.optional = stream, optional
        self.encoding = stream.encoding or "utf-8"

    def writable(self) -> bool:  # noqa: D102
        return True

    def isatty(self) -> bool:  # noqa: D102
        return self.stream.isatty()

    def fileno(self) -> int:  # noqa: D102
        return self.stream.fileno()

    def write(self, text: str | bytes) -> int:  # noqa: D102
        text = text.decode() if isinstance(text, bytes) else text  # click writes shell completions as bytes
        front = "\r" if text.startswith("\r") else ""
        with self._tolerant():
            self.stream.write(front + printable(text[len(front) :]))
        return len(text)

    def flush(self) -> None:  # noqa: D102
        with self._tolerant():
            self.stream.flush()

    @contextmanager
    def _tolerant(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            if not self.optional:
                raise (UnreadError() if isinstance(error, BrokenPipeError) else error) from None


@contextmanager
def terminal() -> Iterator[None]:
    """Replace closed streams, and pass all text through `Printable`, while a command runs.

    Printing to a closed stdout is an error at that time; text for a closed or full stderr is lost.
    """
    _open_descriptors()
    before = sys.stdout, sys.stderr
    out, err = before[0] or _stream(1), before[1] or _stream(2)
    for stream in (out, err):
        if isinstance(stream, io.TextIOWrapper):  # '?' replaces Greek letters that cannot be printed
            stream.reconfigure(errors="replace")
    sys.stdout, sys.stderr = Printable(out, False), Printable(err, True)
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before


def forsake_stdout() -> None:
    """Discard output not flushed yet, after the reader is gone."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _open_descriptors() -> None:
    """Occupy the descriptors 0 to 2, so that no file of the program gets one of them and is overwritten."""
    for number, mode in enumerate((os.O_RDONLY, os.O_RDONLY, os.O_WRONLY)):  # writing to stdout shall fail
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, mode)


def _stream(number: int) -> TextIO:
    return io.TextIOWrapper(io.FileIO(number, "w", closefd=False), "utf-8", write_through=True)  # pyright: ignore[reportArgumentType]


def program() -> None:
    """Run `tline`, and exit.

    When all is written the system frees memory at once; clearing every module and collecting garbage before would
    take a tenth of the time of a small scene. While threads are alive, Python waits for them as usual.
    """
    gc.set_threshold(500_000)  # a command makes little garbage, but a tenth of the time of its imports is collecting it
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # else pydantic reads the metadata of all packages
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # threads wait for each other longer than small matrices take
    try:
        main()
    except SystemExit as end:
        if not isinstance(end.code, int) or active_count() > 1:
            raise
        code = end.code
    else:
        return
    atexit._run_exitfuncs()
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    finally:
        os._exit(code)


COMMANDS = {
    "line": (
        "tline.cli.line:line",
        "z0, wave speed and the rest of a pipe or a cable, from what is known of it.",
    ),
    "run": ("tline.cli.run:run", "Simulate a scene."),
    "live": (
        "tline.cli.scene_files:live",
        "A scene as a page on this machine: sliders for its numbers, and all follows.",
    ),
    "demo": ("tline.cli.scene_files:demo", "A valve shuts on a water pipe: numbers, pictures and an animation."),
    "exercise": ("tline.cli.exercise:exercise", "The exercise tline grew out of, answered letter by letter."),
    "examples": ("tline.cli.scene_files:examples", "The scenes that come with tline, to look at or to start from."),
    "surge": ("tline.cli.surge:surge", "Operate a water network without editing a file: the worst of a surge."),
    "study": ("tline.cli.surge:study", "Many surges of a water network, and variants of it, from one file."),
    "design": ("tline.cli.design:design", "Size an air vessel, a closure, a relief valve or a flywheel."),
    "sweep": ("tline.cli.sweep:sweep", "A scene in many runs with other values: grids, tolerances of parts, clusters."),
    "frequency": ("tline.cli.frequency:frequency", "A scene over frequency: transfer functions, S-parameters."),
    "tdr": ("tline.cli.signal:tdr", "Time-domain reflectometry: a step into a node, and what comes back."),
    "eye": ("tline.cli.signal:eye", "Eye diagram of a bit pattern at a probe."),
    "channel": (
        "tline.cli.signal:channel",
        "A measured channel: losses, eye of all bit patterns, a report on one page.",
    ),
    "crosstalk": (
        "tline.cli.signal:crosstalk",
        "Near- and far-end crosstalk of coupled conductors.",
    ),
    "passivity": (
        "tline.cli.passivity:passivity",
        "Prove or refute that an impedance is positive real, or a reflection bounded real.",
    ),
    "fit": (
        "tline.cli.fit:fit",
        "The passive model that a Touchstone file becomes in a scene, and how well it fits.",
    ),
    "friction": ("tline.cli.friction:friction", "Friction models on a testbench, and where methods fail."),
    "drives": ("tline.cli.drives:drives", "Two spools, a belt, a pulley: from equations to control and animation."),
    "chart": ("tline.cli.chart:chart", "Speed against accuracy: methods and programs compared, measured now."),
    "import": (
        "tline.cli.scene_files:import_",
        "A scene from another program's file: SPICE netlists, EPANET networks.",
    ),
    "export": ("tline.cli.scene_files:export", "A scene as SPICE netlist."),
    "warm-up": ("tline.cli.warm_up:warm_up", "Compile ahead what runs may need."),
    "schema": ("tline.cli.scene_files:schema", "JSON schema of scene files, for editors."),
}
NOTES = NotKeptWarning, LeftOutWarning


class LazyGroup(click.Group):
    """Group that imports a subcommand when it is used, and lists them all without importing any."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run as a program, and exit.

        Errors of the user go to stderr in one sentence with exit status 2, an active scene exits with 1. A fault of the
        program exits with 70 (EX_SOFTWARE of sysexits.h), as 1 would be an answer; an interrupt exits with 130 as in
        other programs, and a closed pipe, silently, with 141.
        """
        with terminal():
            sys.exit(self._exit_code(*args, **kwargs))

    def _exit_code(self, *args: Any, **kwargs: Any) -> int:
        try:
            with _noted():
                done = super().main(*args, **kwargs | {"standalone_mode": False})
            sys.stdout.flush()
        except InputError as error:
            click.echo(str(error), err=True, color=True)
            return 1 if isinstance(error, ActiveError) else 2
        except UnreadError:
            forsake_stdout()
            return 141
        except OSError as error:  # any other: the output cannot be written
            click.echo(f"output: cannot be written, got {(error.strerror or str(error)).lower()}", err=True)
            forsake_stdout()
            return 2
        except click.ClickException as error:
            error.show()
            return error.exit_code
        except (click.Abort, KeyboardInterrupt):
            click.echo("interrupted", err=True)
            return 130
        except MemoryError:
            click.echo("memory: there is not enough of it for this, expected a smaller input", err=True)
            return 2
        except Exception as error:  # noqa: BLE001 (whatever it is)
            place = traceback.extract_tb(error.__traceback__)[-1]
            what = f"{type(error).__name__} in line {place.lineno} of {Path(place.filename).name}"
            said = " ".join(f"{error!s:.200}".split())
            click.echo(
                f"tline: a fault of the program, please report it with the command: {what}: {said}",
                err=True,
                color=True,
            )
            return 70
        return done if isinstance(done, int) else 0

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of all subcommands."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Subcommand of that name, None if there is none."""
        if cmd_name not in COMMANDS:
            return None
        module, _, attribute = COMMANDS[cmd_name][0].partition(":")
        return getattr(import_module(module), attribute)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the subcommands with their lines in the table above."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, summary) for name, (_, summary) in COMMANDS.items()])


@contextmanager
def _noted() -> Iterator[None]:
    """Print notes in a line, without the location in the program that a warning has."""
    with warnings.catch_warnings():
        show = warnings.showwarning

        def note(message: Warning | str, category: type[Warning], *rest: Any) -> None:
            if issubclass(category, NOTES):
                click.echo(f"note: {message}", err=True, color=True)
            else:
                show(message, category, *rest)

        for category in NOTES:
            warnings.simplefilter("always", category)
        warnings.showwarning = note
        yield


def _print_version(ctx: click.Context, _: click.Parameter, wanted: bool) -> None:
    if wanted:
        from tline import __version__

        click.echo(f"tline {__version__}")
        ctx.exit()


@click.group(cls=LazyGroup, name="tline", context_settings={"help_option_names": ["-h", "--help"], "color": True})
@click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_print_version,
    help="Show the version.",
)
def main() -> None:
    """Waves on pipes and cables.

    'tline COMMAND --help' shows examples.
    """
