"""Random questions for `tline passivity`, as command lines: from sense to nonsense, numbers from 1e-400 to 1e400."""

from random import Random

FUNCTIONS = ("exp", "log", "sqrt", "sinh", "cosh", "tanh", "coth", "sech", "csch")
UNITS = ("", "", "", "k", "M", "p", "n", "u", " ohm", " nH", " pF", " kohm", " ns", " F", " GHz")
SPREADS = (0, 0, 0, 1, 2, 6, 12, 40, 308, 400)  # decades of a number


def number(random: Random) -> str:
    """A number as a user may type it."""
    decades = random.choice(SPREADS)
    if not decades and random.random() < 0.7:
        return str(random.choice([0, 1, 1, 2, 3, 4, 5, 10, 50]))
    mantissa = random.choice(["1", "2", "4.7", "9.99", f"{random.uniform(0, 10):.{random.randint(1, 17)}f}"])
    exponent = random.choice([-1, 1]) * random.choice([decades, random.randint(0, decades)])
    text = mantissa + (f"e{exponent}" if exponent else "")
    return text + random.choice(UNITS)


def expression(random: Random, depth: int, names: tuple[str, ...] = (), functions: bool = True) -> str:
    """An expression in s and the names."""
    if depth <= 0 or random.random() < 0.15:
        return _leaf(random, names)
    inner = [expression(random, depth - 1 - random.randrange(2), names, functions) for _ in range(3)]
    kinds = ["sum", "difference", "product", "quotient", "sum", "product", "quotient", "power", "minus", "delay"]
    kind = random.choice(kinds[: None if functions else 9] + ["function"] * (3 * functions))
    match kind:
        case "sum":
            return " + ".join(inner[: random.randint(2, 3)])
        case "difference":
            return f"{inner[0]} - ({inner[1]})"
        case "product":
            return f"({inner[0]})*({inner[1]})"
        case "quotient":
            return f"({inner[0]})/({inner[1]})"
        case "power":
            return f"({inner[0]})^{random.choice([2, 2, 3, -1, -2, 5, 17, 40, 200, -200, 0])}"
        case "minus":
            return f"-({inner[0]})"
        case "delay":
            return f"exp(-{random.choice(['', number(random) + '*', *(name + '*' for name in names)])}s)*({inner[0]})"
    return f"{random.choice(FUNCTIONS)}({inner[0]})"


def _leaf(random: Random, names: tuple[str, ...]) -> str:
    kind = random.random()
    if names and kind < 0.4:
        return random.choice(names)
    if kind < 0.55:
        return "s"
    if kind < 0.7:
        return f"{number(random)}*s"
    return number(random)


def question(random: Random) -> list[str]:
    """Arguments of `tline passivity`."""
    what = random.choice(["rational", "function", "function", "function", "symbolic", "matrix", "chain", "within"])
    depth = random.choice([1, 2, 3, 3, 4, 5, 7])
    kind = ["--kind", random.choice(["pr", "br"])] if random.random() < 0.6 else []
    as_json = ["--json"] * (random.random() < 0.3)
    if what == "symbolic":
        names = ("R", "T", "k")[: random.randint(1, 3)]
        text = expression(random, min(depth, 4), names, random.random() < 0.5)
        return [text, *_parameters(random, [name for name in names if name in text]), *kind, *as_json]
    if what == "matrix":
        n = random.choice([1, 2, 2, 3])
        rows = [[expression(random, random.randrange(3), (), False) for _ in range(n)] for _ in range(n)]
        return ["[" + "; ".join(", ".join(row) for row in rows) + "]", *kind, *as_json]
    if what == "chain":
        line = ["--kind", "chain", "--z0", number(random), "--delay", number(random)]
        return [expression(random, min(depth, 4), (), False), *line, *as_json]
    if what == "within":
        return [expression(random, min(depth, 4), (), False), "--within", random.choice(["1e-9", "1 %", "1e-300"])]
    return [expression(random, depth, (), what == "function"), *kind, *as_json]


def _parameters(random: Random, names: list[str]) -> list[str]:
    found = []
    for name in names:
        x = number(random)
        forms = ["{n}>0", "{n}>=0", "{n} real", "0<{n}<={x}", "{n}>{x}", "{n}={x}", "{n}<-{x}"]
        found += ["--param", random.choice(forms).format(n=name, x=x)]
    return found


def state_space(random: Random) -> list[list[list[str]]]:
    """A, B, C, D with entries as texts."""
    n, m = random.randint(0, 6), random.randint(1, 3)
    shapes = ((n, n), (n, m), (m, n), (m, m))
    return [[[_signed(random) for _ in range(k)] for _ in range(h)] for h, k in shapes]


def _signed(random: Random) -> str:
    return random.choice(["", "-"]) + number(random) if random.random() < 0.7 else "0"
