"""CSV and Touchstone files as fuzz, through every command that reads them."""

from random import Random

from fuzz.case import Case
from fuzz.mutate import damaged, number

LINE = '[lines.l]\nnodes = ["a", "b"]\nz0 = 50\ndelay = 1e-9\n'
HEAD = 'medium = "electrical"\nt_end = 5e-9\n[probes.p]\nat = "b"\n'
WAVE = (
    HEAD
    + LINE
    + '[sources.s]\nat = "a"\nkind = "voltage"\nresistance = 50\nvalue = {shape = "table", file = "t.csv"}\n'
)
CABLE = HEAD + '[lines.l]\nnodes = ["a", "b"]\nlength = 1\ntabulated = {file = "t.csv"}\n'
ONE = HEAD + LINE + '[loads.m]\nat = "b"\nkind = "touchstone"\nfile = "m.s1p"\n'
TWO = HEAD + LINE + '[links.m]\nnodes = ["a", "b"]\nkind = "touchstone"\nfile = "m.s2p"\n'


def csv(rng: Random) -> Case:
    """A table of two to five columns."""
    kind, columns, head = rng.choice(
        (("wave", 2, "t,u"), ("cable", 3, "f,R,L"), ("cable", 5, "f,R,L,G,C"), ("samples", 3, "f,re,im"),
         ("force", 2, "t,F"), ("torque", 3, "t,T1,T2"))
    )  # fmt: skip
    rows = [
        ",".join([f"{k * 1e-9 if kind == 'wave' else k:g}", *(_cell(rng) for _ in range(columns - 1))])
        for k in range(rng.randint(0, 8))
    ]
    text = "\n".join([head] * (rng.random() < 0.8) + rows)
    data = damaged(rng, text) if rng.random() < 0.7 else text.encode("utf-8", "surrogateescape")
    files = {"t.csv": data}
    match kind:
        case "wave" | "cable":
            return Case(["run", "s.toml"], files | {"s.toml": (WAVE if kind == "wave" else CABLE).encode()})
        case "samples":
            return Case(["passivity", "t.csv", *rng.choice(([], ["--kind", "br"], ["--error", "0.01"]))], files)
        case "force":
            return Case(["friction", "run", "coulomb", "--table", "t.csv"], files)
        case _:
            return Case(["drives", "step", "--table", "t.csv", *["--hold"] * (rng.random() < 0.3)], files)


def _cell(rng: Random) -> str:
    return f"{rng.uniform(0, 2):.3g}" if rng.random() < 0.9 else number(rng)


def touchstone(rng: Random) -> Case:
    """S-parameters of one port or two."""
    ports = rng.choice((1, 1, 2))
    unit, form = rng.choice(("Hz", "kHz", "MHz", "GHz")), rng.choice(("RI", "MA", "DB"))
    head = f"# {unit} {rng.choice('SSSSZYG')} {form} R {rng.choice(('50', '75', number(rng)))}"
    rows = [" ".join([f"{k + 1}", *(_cell(rng) for _ in range(2 * ports**2))]) for k in range(rng.randint(0, 12))]
    text = "\n".join(["! made by nobody"] * (rng.random() < 0.3) + [head] + rows)
    data = damaged(rng, text) if rng.random() < 0.6 else text.encode("utf-8", "surrogateescape")
    name = f"m.s{ports}p"
    files = {name: data}
    commands = [["fit", name], ["fit", name, "--nearest"], ["passivity", name], ["fit", name, "--tol", "0.1"]]
    if rng.random() < 0.4:
        return Case(["run", "s.toml"], files | {"s.toml": (ONE if ports == 1 else TWO).encode()})
    return Case(rng.choice(commands), files)
