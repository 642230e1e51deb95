"""Expressions and matrices in s as fuzz."""

from random import Random

from fuzz.case import Case
from fuzz.mutate import damaged, number, value

NAMES = ("s", "s", "s", "R", "L", "C", "k", "j", "i", "pi", "e", "x_1", "Ω", "import", "lambda", "é")
FUNCTIONS = ("sqrt", "exp", "log", "tanh", "sinh", "cosh", "coth", "eval", "abs", "max")


def expression(rng: Random, depth: int = 4) -> str:
    """A random expression; deeper ones are longer."""
    kind = rng.random()
    if depth == 0 or kind < 0.3:
        return rng.choice(NAMES) if rng.random() < 0.6 else _constant(rng)
    if kind < 0.75:
        left, right = expression(rng, depth - 1), expression(rng, depth - 1)
        return f"{left}{rng.choice('+-*/')}{right}" if rng.random() < 0.5 else f"({left}){rng.choice('+-*/')}({right})"
    if kind < 0.85:
        return f"({expression(rng, depth - 1)})^{rng.choice((0, 1, 2, 3, -1, -2, 10, 99, 1000, '1/2', '1e9', 's'))}"
    if kind < 0.95:
        return f"{rng.choice(FUNCTIONS)}({expression(rng, depth - 1)})"
    return f"-{expression(rng, depth - 1)}"


def rational(rng: Random, degree: int = 3) -> str:
    """A rational function of low degree, perhaps passive."""
    above, below = (" + ".join(f"{_constant(rng)}*s^{k}" for k in range(rng.randint(0, degree) + 1)) for _ in range(2))
    return f"({above})/({below})"


def _constant(rng: Random) -> str:
    return (
        rng.choice(("0", "1", "2", "3", "1/2", "0.1", "1n", "5p", "2.5k", "50")) if rng.random() < 0.93 else number(rng)
    )


def scalar(rng: Random) -> Case:
    """`tline passivity` of an expression."""
    text = rational(rng) if rng.random() < 0.5 else expression(rng)
    if rng.random() < 0.2:
        text = damaged(rng, text).replace(b"\0", b"").decode("utf-8", "surrogateescape")
    args = ["passivity", text]
    for option, values in OPTIONS.items():
        if rng.random() < 0.12:
            given = rng.choice(values) if rng.random() < 0.8 else value(rng)
            args += [option] if option == "--json" else [option, given]
    for name in ("R", "L", "C", "k"):
        if rng.random() < 0.25:
            args += [
                "--param",
                rng.choice(
                    (f"{name}=1", f"{name}>0", f"{name} real", f"0<{name}<=1", f"{name}={value(rng)}", value(rng))
                ),
            ]
    return Case(args)


OPTIONS = {
    "--kind": ("pr", "br", "chain"), "--z0": ("50", "1"), "--delay": ("3 ns", "1"), "--within": ("0.01", "1 %"),
    "--error": ("0.001",), "--json": ("",), "--nearest": ("x.json",),
}  # fmt: skip


def matrix(rng: Random) -> Case:
    """`tline passivity` of a matrix."""
    size = rng.choice((1, 2, 2, 2, 3))
    plain = ("0", "1", "s", "2*s", "1/s", "s/2", "1/2")
    rows = [[rational(rng, 2) if rng.random() < 0.3 else rng.choice(plain) for _ in range(size)] for _ in range(size)]
    if rng.random() < 0.6:
        rows = [[rows[min(i, j)][max(i, j)] for j in range(size)] for i in range(size)]
    text = "[" + "; ".join(", ".join(row) for row in rows) + "]"
    if rng.random() < 0.25:
        text = damaged(rng, text).replace(b"\0", b"").decode("utf-8", "surrogateescape")
    args = [
        "passivity",
        text,
        *(["--kind", "br"] if rng.random() < 0.4 else []),
        *(["--json"] if rng.random() < 0.2 else []),
    ]
    return Case(args)
