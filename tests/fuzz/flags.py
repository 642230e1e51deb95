"""Every option of every command as fuzz, taken from the commands themselves."""

from functools import lru_cache
from random import Random
from typing import Any

import click

from fuzz.case import Case, shipped
from fuzz.mutate import damaged, value

WORDS = {  # likely values by what an option stands for
    "z0": ("50", "75 ohm"), "delay": ("1 ns", "2e-9"), "length": ("10 m", "300 m"), "radius": ("10 cm", "5 mm"),
    "density": ("998", "1 g/cm^3"), "tol": ("1e-4", "0.01"), "order": ("3", "5"), "slab": ("1 ns", "0.3 ns"),
    "path": ("near,far", "near"), "ports": ("near", "near,far"), "port": ("near",), "rise": ("50 ps", "1 ns"),
    "source": ("step", "nothing"), "probe": ("far",), "bit": ("2 ns",), "bits": ("5", "prbs7", "0110"),
    "points": ("20", "3"),
    "runs": ("10", "50"), "seed": ("1", "0"), "vary": ("lines.cable.z0=uniform(40, 60)",
    "lines.cable.delay=normal(3n, 1p)"),
    "low": ("1 MHz",), "high": ("1 GHz",), "t_end": ("1 s", "2 s", "20 ns"), "wave_speed": ("1000 m/s", "1500"),
    "letter": ("2a", "3c", "4b", "4d", "1f"), "method": ("euler", "bdf-events", "rk4"), "step": ("10 ms", "1 ms"),
    "output": ("x_k", "tension", "out.toml", "out.cir"), "models": ("lugre", "dahl", "coulomb", "tanh"),
    "model": ("coulomb", "karnopp", "lugre", "dahl", "elasto-plastic", "tanh"), "parameters": ("F_s=1.2 N",
    "sigma0=1e4"),
    "parameter_file": ("p.toml",), "what": ("1/(1+s)", "[1, 0; 0, 1]", "cable_rc.toml"),
    "scene": ("cable_rc.toml",), "file": ("cable_rc.cir",
    "m.s1p", "out.html"),
    "velocity": ("0.5",), "slope": ("0.5", "2 N/s"), "sine": ("1 N",), "frequency": ("1 Hz",), "angle": ("45 deg",
    "30 deg"),
    "inertia": ("1e-3 kg m^2",), "mass": ("1", "2 kg"), "friction": ("0.1 N m s",), "fluid": ("water",),
    "wall": ("steel", "pvc"),
    "temperature": ("20 degC", "12 degC"), "spring": ("20 N/m",), "pull": ("5 cm/s",), "speed": ("1 m/s",),
    "tension": ("5 N",),
}  # fmt: skip
WRITTEN = {
    "csv": ("out.csv",),
    "npz": ("out.npz",),
    "plot": ("out.svg", "out.png", "out.pdf"),
    "save": ("out.s1p",),
    "nearest": ("out.json",),
    "modelica": ("out.mo",),
    "figures": ("pictures",),
}
PARAMETERS = """inertia = ["1e-3 kg m^2", "2e-3 kg m^2"]
friction = "0.1 N m s"
radius = "10 cm"
angle = "45 deg"
"""
MEASURED = "# MHz S RI R 50\n1 0.5 0.1\n2 0.4 0.2\n3 0.35 0.2\n4 0.3 0.2\n"


@lru_cache
def commands() -> dict[tuple[str, ...], click.Command]:
    """All commands by the words that lead to them; those that measure for minutes left out."""
    from tline.cli.main import main

    found: dict[tuple[str, ...], click.Command] = {}

    def add(words: tuple[str, ...], command: click.Command) -> None:
        if isinstance(command, click.Group):
            context = click.Context(command)
            for name in command.list_commands(context):
                inner = command.get_command(context, name)
                if inner is not None:
                    add((*words, name), inner)
        else:
            found[words] = command

    add((), main)
    return found


def case(rng: Random, first: str | None = None) -> Case:
    """A command with some of its options; of one group only, if `first` names it."""
    known = [words for words in commands() if first in (None, words[0])]
    words = rng.choice(known)
    if words[-1] == "exercise" and rng.random() < 0.9:  # the same long answer again and again
        words = rng.choice(known)
    command, args, asked = commands()[words], list(words), set()
    for parameter in command.params:
        if isinstance(parameter, click.Argument):
            args += [_value(rng, parameter, asked) for _ in range(1 if rng.random() < 0.97 else rng.choice((0, 2)))]
        elif parameter.required or rng.random() < (
            0.03 if parameter.name == "plot" else min(0.3, 2.5 / len(command.params))
        ):
            args += _option(rng, parameter, asked)
        elif parameter.name == "output" and parameter.default:
            asked.add(parameter.default)
    if words[0] == "chart":  # with all that a chart needs it would be measured, for minutes
        args += rng.choice((["nothing"], ["--csv", "out.txt"], ["--plot", "none/out.png"], ["--points"]))
    if rng.random() < 0.03:
        args.insert(rng.randrange(len(args) + 1), value(rng))
    if rng.random() < 0.01:
        args += ["--help"]
    files = _files() | {"p.toml": damaged(rng, PARAMETERS)}
    return Case([arg.replace("\0", "") for arg in args], files, frozenset(asked))


def _option(rng: Random, parameter: click.Parameter, asked: set[str]) -> list[str]:
    name = rng.choice([*parameter.opts, *parameter.secondary_opts])
    if getattr(parameter, "is_flag", False):
        return [name]
    text = _value(rng, parameter, asked)
    return [name, text] if rng.random() < 0.5 or not name.startswith("--") else [f"{name}={text}"]


def _value(rng: Random, parameter: Any, asked: set[str]) -> str:
    key, text = parameter.name, value(rng)
    if key in WRITTEN and rng.random() < 0.9:
        text = rng.choice(WRITTEN[key])
    elif rng.random() < 0.7 and key in WORDS:
        text = rng.choice(WORDS[key])
    elif isinstance(parameter.type, click.Choice) and rng.random() < 0.5:
        text = rng.choice(list(parameter.type.choices))
    if key in (*WRITTEN, "output", "file", "table_file"):
        asked.add(text)
    return text


@lru_cache
def _files() -> dict[str, bytes]:
    text = shipped("cable_rc.toml", "cable_rc.cir") | {"m.s1p": MEASURED}
    return {name: content.encode() for name, content in text.items()}
