"""Click commands from Python functions: options from signatures, their help from numpydoc docstrings.

A command is a function. Its arguments in front of ``*`` are the command's arguments, the others its options: a bool is
a flag, a tuple may be repeated, a `Literal` is a choice. An argument ``**given`` stands for all arguments of the
functions that the command passes it on to. The help of an option is in one docstring, that of the first of these
functions that documents it. An argument annotated as "Scene" is read from the file named; the return value
is an `Output`, or a result with its own display. Errors name options in place of arguments.
"""

import inspect
import json
import re
from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager
from importlib import import_module
from typing import Annotated, Any, Literal, NamedTuple, get_args, get_origin

import click
from click.core import ParameterSource

from tline.cli.docstrings import REQUIRED, UNKNOWN, Argument, arguments_of, documented_in, without_sections
from tline.cli.options import CSV, PICTURE, check_files, options_named
from tline.presentation import Presentation
from tline.units import to_si

WORDS = {  # metavariables by name of the argument
    "TIME": "t_end rise period begin h step jitter delay filter_time sinusoidal duty_cycle",
    "NUMBER": "tol seed workers exponent reserve points kv stages ber dfe",
    "NODE": "node at",
    "SPEED": "wave_speed rated_speed",
    "PRESSURE": "set_pressure band rating",
    "LIMIT": "lowest highest",
    "LEVEL": "low high noise",
    "OHM": "z0",
    "J": "inertia",
    "1…16": "order",
    "FROM,…,TO": "path",
    "BITS": "bits",
    "PORTS": "ports",
    "FILE": "output",
    "SI|US|UNIT,…": "units",
    "FILE.csv": "material",
    "HOURS": "hour",
    "KIND[:COUNT]": "sample",
    "FILE.npz": "resume",
    "KG": "mass",
    "ω": "speed_bandwidth tension_bandwidth",
    "TORQUE": "limit",
    "m/s": "v0",
}
METAVARS = {name: metavar for metavar, names in WORDS.items() for name in names.split()}
COMMON = {  # options of many commands
    "tol": "Largest error, relative to the amplitude; the scene's, or 1e-6, if not given.",
    "confined": "Read no files outside of the scene's folder.",
    "active": "Run even if a load is active, that is, not positive real.",
    "as_json": "Print the numbers in SI and full precision.",
}
OWN = {"scene", "progress"}  # arguments without an option
LAST = ("active", "confined", "as_json")


class FileKind(NamedTuple):
    """File that a command writes on request: its suffixes, and its content."""

    suffixes: tuple[str, ...]
    content: str

    def option(self, name: str) -> click.Option:
        """Option for the path of the file."""
        *some, last = self.suffixes or [""]
        named = some and some[0] not in self.content
        told = f"{self.content}; {', '.join(some)} or {last}." if named else f"{self.content}."
        return click.Option(
            [*_flags(name), name], metavar="FILE" if some else f"FILE{last}", help=told.replace("`", "'")
        )


class Output(NamedTuple):
    """Result of a command: as text and as data, writers of its files, or the reason for none, and the exit status."""

    text: Iterable[str]
    data: Callable[[], Any]
    files: Mapping[str, Callable[[str], Any]] = {}
    notes: Iterable[str] = ()
    exit_code: int = 0


class Command(click.Command):
    """Command with options from a function's signature; see `command`."""

    def __init__(
        self,
        function: Callable[..., Output | Presentation | None],
        sources: Iterable[str],
        names: Mapping[str, str],
        files: Mapping[str, FileKind],
        omit: Iterable[str],
        more: Iterable[click.Parameter],
        epilog: str,
    ):
        self.function, self.names, self.kinds = function, names, files
        self.own, text = inspect.signature(function).parameters, inspect.getdoc(function) or ""
        self.reads = "scene" in self.own and self.own["scene"].annotation == "Scene"
        own, given = documented_in(text), [arguments_of(source) for source in sources]
        left_out, params = {*self.own, *OWN, *omit}, dict[str, click.Parameter]()
        for name, each in self.own.items():
            if each.kind is each.VAR_KEYWORD:
                params |= {str(option.name): option for option in more}
                for argument, told in (item for source in given for item in source.items()):
                    if argument not in left_out | params.keys():
                        params[argument] = self._option(argument, told, [own, *given])
            elif each.kind is each.POSITIONAL_OR_KEYWORD:
                needed = each.default is each.empty
                several = get_origin(each.annotation) is tuple
                default = {} if needed else {"default": each.default}
                params[name] = click.Argument([name], nargs=-1 if several else 1, required=needed, **default)
            elif name != "files":
                default = REQUIRED if each.default is each.empty else each.default
                params[name] = self._option(name, Argument(each.annotation, default), [own, *given])
        params |= {name: kind.option(name) for name, kind in files.items()}
        if self.reads:
            params["confined"] = self._option("confined", Argument(bool, False), [own])
        if inspect.signature(function).return_annotation is not None:
            params["as_json"] = self._option("as_json", Argument(bool, False), [own])
        last = [params.pop(name) for name in LAST if name in params]
        first = sorted(params.values(), key=lambda param: not param.required)
        name = names.get("", function.__name__.rstrip("_").replace("_", "-"))
        super().__init__(
            name,
            params=[*first, *last],
            callback=self._run,
            help=without_sections(text),
            epilog=epilog,
        )

    def named(self, **more: str) -> AbstractContextManager[None]:
        """Let errors within name the option where the library names its argument, or the key of a scene."""
        options = [param for param in self.params if isinstance(param, click.Option)]
        return options_named({str(each.name): each.opts[-1] for each in options} | more)

    def in_si(self, given: Mapping[str, str | None]) -> dict[str, float]:
        """Values in SI of the options given whose help has a unit in brackets."""
        options = {str(each.name): each for each in self.params if isinstance(each, click.Option)}
        found = {name: re.search(r"\[([^\]]+)\]", options[name].help or "") for name in given}
        units = {name: unit[1] for name, unit in found.items() if unit and given[name] is not None}
        return {name: to_si(str(given[name]), unit, options[name].opts[-1]) for name, unit in units.items()}

    def _option(self, name: str, told: Argument, documented: list[dict[str, Argument]]) -> click.Option:
        said = [each[name] for each in documented if name in each and each[name].help]
        found = said[0] if said else UNKNOWN._replace(help=COMMON[name])
        short = _flags(name)[:-1] if name not in self.names else []
        flags = [*short, _flags(self.names.get(name, "json" if name == "as_json" else name))[-1]]
        if told.annotation in (bool, "bool"):
            shown = [flags[-1].replace("--", "--no-")] if told.default else flags
            text = f"Do not {found.help[0].lower()}{found.help[1:]}" if told.default else found.help
            return click.Option(
                [*shown, name], is_flag=True, flag_value=not told.default, default=told.default, help=text
            )
        if told.annotation in (bool | None, "bool | None"):
            both = f"{flags[-1]}/{flags[-1].replace('--', '--no-')}"
            return click.Option([both, name], default=None, help=found.help)
        several, kind = told.annotation in (tuple[str, ...], "Texts"), _type(told.annotation)
        more: dict[str, Any] = {"multiple": True} if several else {"required": told.default is REQUIRED}
        if not several and told.default not in (REQUIRED, None, "", ()):
            text = f"{told.default:g}" if isinstance(told.default, float) else str(told.default)
            more |= {"default": text, "show_default": "not given" not in found.help}
        if kind is str or kind is int:
            written = "|".join(re.findall('"([^"]+)"', found.kind)) or METAVARS.get(name, "NAME")
            more["metavar"] = found.kind if name in documented[0] else written
        return click.Option([*flags, name], type=kind, help=found.help, **more)

    def shown(
        self, found: Any, *more: str, told: Mapping[str, Any] | None = None, exit_code: int = 0, **files: Any
    ) -> Output:
        """Display a result: its text with lines below it, its numbers, with more of them, notes and files."""
        known = {name: drawn(found.picture, found) if kind.suffixes == PICTURE else found.save
                 for name, kind in self.kinds.items() if name not in files}  # fmt: skip
        text, notes = [*found.text_lines(), *more], getattr(found, "notes", ())
        return Output(text, lambda: found.to_dict() | (told or {}), known | files, notes, exit_code)

    def _run(self, as_json: bool = False, **given: Any) -> None:
        context = click.get_current_context()
        files = {name: given.pop(name) for name in self.kinds}
        check_files({_flags(name)[-1]: (file, self.kinds[name].suffixes) for name, file in files.items()})
        wanted = {name: file for name, file in files.items() if file is not None}
        if self.reads:
            from tline.interchange.any_file import read

            given["scene"] = read(given["scene"], confined=given.pop("confined"))
        default = {name for name in given if context.get_parameter_source(name) is ParameterSource.DEFAULT}
        kept = {name: value for name, value in given.items() if name in self.own or name not in default}
        with self.named():
            found = self.function(**kept, **({"files": wanted} if "files" in self.own else {}))
            if found is None:
                return
            output = found if isinstance(found, Output) else self.shown(found)
            _tell(output, wanted, as_json)
        context.exit(output.exit_code)


def command(
    *sources: str,
    names: Mapping[str, str] | None = None,
    files: Mapping[str, FileKind] | None = None,
    omit: Iterable[str] = (),
    more: Iterable[click.Parameter] = (),
    epilog: str = "",
    group: click.Group | None = None,
    kind: type[Command] = Command,
) -> Callable[[Callable[..., Output | Presentation | None]], Command]:
    """Make a command of the function below.

    Parameters
    ----------
    *sources : str
        Functions that its ``**given`` is passed on to, as ``"module:name"``.
    names : mapping of str to str, optional
        Options with other names than their arguments; the command's own name at the empty text.
    files : mapping of str to FileKind, optional
        Files that the command can write; an argument ``files`` gets the paths requested.
    omit : iterable of str
        Arguments of the sources that the command gives itself.
    more : iterable of click.Parameter
        Further options, which ``**given`` gets as well.
    epilog : str
        Examples.
    group : click.Group, optional
        Group of the command.
    kind : type
        Class of the command, if it parses its words in a way of its own.
    """

    def made(function: Callable[..., Output | Presentation | None]) -> Command:
        found = kind(function, sources, names or {}, files or {}, omit, more, epilog)
        if group is not None:
            group.add_command(found)
        return found

    return made


def table(content: str) -> FileKind:
    """Table of something."""
    return FileKind(CSV, content)


def picture(content: str) -> FileKind:
    """Picture of something."""
    return FileKind(PICTURE, content)


def drawn(function: str, *args: Any, **more: Any) -> Callable[[str], None]:
    """Return a writer that draws with a function ``"module:name"``, imported at call, and saves the figure."""

    def save(file: str) -> None:
        from tline.style import save_figure, styled

        module, _, name = function.partition(":")
        save_figure(styled(getattr(import_module(module), name))(*args, **more), file)

    return save


def tabled(columns: Mapping[str, Any]) -> Callable[[str], None]:
    """Return a writer of arrays as the columns of a table."""

    def save(file: str) -> None:
        from tline.atomic import write_columns

        write_columns(file, columns)

    return save


def _flags(name: str) -> list[str]:
    return [*(["-o"] if name == "output" else []), f"--{name.replace('_', '-')}"]


def _type(annotation: Any) -> Any:
    choice = next((each for each in (annotation, *get_args(annotation)) if get_origin(each) is Literal), None)
    if choice is not None:
        return click.Choice(get_args(choice))
    return (
        get_args(annotation)[1] if get_origin(annotation) is Annotated else int if annotation in (int, "int") else str
    )


def _written(file: str, told: Any) -> str:
    return told if isinstance(told, str) else f"wrote {file}"


def _tell(output: Output, files: Mapping[str, str], as_json: bool) -> None:
    said = [_written(file, output.files[name](file)) for name, file in files.items()]
    for note in output.notes:
        click.echo(f"note: {note}", err=True)
    if as_json:
        click.echo(json.dumps(output.data(), indent=2, ensure_ascii=False))
    else:
        click.echo("\n".join([*output.text, *said]))
