"""Small damage to valid text: bytes, words, numbers, lines."""

import re
from random import Random

NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
WORD = re.compile(r"[A-Za-z_]\w*|\S")
NUMBERS = (
    "0", "-0", "-0.0", "1", "-1", "2", "3", "0.5", "1e-9", "1e-3", "1e3", "1e9", "1e308", "-1e308", "1.8e308", "1e-308",
    "5e-324", "1e-400", "1e999999999", "1e-999999999", "1" + 400 * "0", "0." + 400 * "0" + "1", "nan", "inf", "-inf",
    "+inf", "Infinity", "0x10", "1_000", "1__0", "1e", ".", "-", "+", "--1", "1,5", "1/0", "1e5e5", "٣", "½", "2**63",
    "9223372036854775807", "9223372036854775808", "-9223372036854775809", "4294967296", "1e100", "1e-100",
    "1.0000000000000002",
)  # fmt: skip
UNITS = (
    "s", "ms", "ns", "m", "cm", "m/s", "ohm", "kohm", "V", "A", "bar", "Pa", "Pa s/m^3", "m^3/s", "L/s", "pF",
    "nH", "Hz",
    "MHz", "%", "deg", "K", "degC", "N m", "kg", "m^99", "m^-99", "m^0", "(m", "m)", "((m))", "m/m", "1", "N m s/rad",
    "rad/s", "µs", "μs", "Ω", "xyz", "m m m m m m", "bar/(m^3/s)", "1/s", "*", "s^2/s",
)  # fmt: skip
TEXTS = (
    "", " ", "\t", "a", "self", "None", "true", "{}", "[]", "%s", "%n", "{0}", "${HOME}", "$(touch x)", "`touch x`",
    "; touch x", "__import__('os').system('touch x')", "../x", "../../etc/passwd", "/etc/passwd", "/dev/null", ".",
    "..",
    "/", "~", "-", "--", "-h", "--help", "=", ",", ";", "é", "é́", "日本", "🚰", "\u202e", "\u2028", "\ufeff",
    "\x1b[31mred", "\x1b]0;t\x07",
    "\x7f", "\x85", "\x9b2J", "a\rb", "a\nb", "<script>alert(1)</script>", "</script>", "<!--", "&amp;",
    '"', "'", "\\", "\\u0000",
    "$x$", "$\\frac{1}{0}$", "_^$", "x" * 300, "a." * 50, "\udcff", "con", "a b", "#", "!", "*", "?", "[", "]", "|",
)  # fmt: skip
BYTES = (
    b"\x00",
    b"\xff",
    b"\xfe\xff",
    b"\xef\xbb\xbf",
    b"\r",
    b"\r\n",
    b"\x1b[2J",
    b"\xc3",
    b"\xf0\x9f\x9a\xb0",
    b"\x85",
    b"\x1a",
)


def number(rng: Random) -> str:
    """A number as text, likely an awkward one."""
    kind = rng.random()
    if kind < 0.5:
        return rng.choice(NUMBERS)
    if kind < 0.8:
        return f"{rng.uniform(-10, 10) * 10.0 ** rng.randint(-12, 12):.{rng.randint(1, 17)}g}"
    return str(rng.randint(-5, 100))


def value(rng: Random) -> str:
    """Any text that a user may type where a value is asked for."""
    kind = rng.random()
    if kind < 0.35:
        return number(rng)
    if kind < 0.75:
        return f"{number(rng)}{rng.choice(('', ' '))}{rng.choice(UNITS)}"
    return rng.choice(TEXTS)


def damaged(rng: Random, text: str) -> bytes:
    """The text with one to six mutations; most of them leave it nearly what it was."""
    for _ in range(rng.choice((1, 1, 1, 2, 3, 6))):
        text = rng.choice(CHANGES)(rng, text)
    data = text.encode("utf-8", "surrogateescape")
    for _ in range(rng.choice((0, 0, 0, 0, 1, 3))):
        k = rng.randrange(len(data) + 1)
        data = data[:k] + rng.choice((bytes([rng.randrange(256)]), *BYTES)) + data[k + rng.randint(0, 1) :]
    return data[: rng.randrange(len(data) + 1)] if rng.random() < 0.03 else data


def _number(rng: Random, text: str) -> str:
    return _replaced(rng, text, NUMBER, number(rng))


def _word(rng: Random, text: str) -> str:
    words = WORD.findall(text) or [""]
    return _replaced(rng, text, WORD, rng.choice((rng.choice(words), rng.choice(TEXTS), value(rng), "")))


def _replaced(rng: Random, text: str, pattern: re.Pattern[str], new: str) -> str:
    found = list(pattern.finditer(text))
    if not found:
        return text + new
    at = rng.choice(found)
    return text[: at.start()] + new + text[at.end() :]


def _lines(rng: Random, text: str) -> str:
    """Leave out, repeat, move or join lines."""
    lines = text.split("\n")
    k, j = rng.randrange(len(lines)), rng.randrange(len(lines))
    match rng.randrange(5):
        case 0:
            del lines[k]
        case 1:
            lines.insert(j, lines[k])
        case 2:
            lines[k], lines[j] = lines[j], lines[k]
        case 3:
            lines[k : k + 2] = ["".join(lines[k : k + 2])]
        case _:
            lines[k] = lines[k] * rng.choice((2, 20))
    return "\n".join(lines)


def _nested(rng: Random, text: str) -> str:
    """Something in brackets in brackets."""
    deep, (left, right) = (
        rng.choice((2, 30, 3000)),
        rng.choice(("[]", "()", "{}", ("{a = ", "}"), ("-", ""), ("1+", ""))),
    )
    return _replaced(rng, text, NUMBER, deep * left + "1" + deep * right)


def _character(rng: Random, text: str) -> str:
    k = rng.randrange(len(text) + 1)
    return text[:k] + rng.choice((*"[](){}=,;:'\"\\#*^/+-.eE \t\n", *TEXTS)) + text[k + rng.randint(0, 1) :]


CHANGES = (_number, _number, _number, _word, _word, _lines, _lines, _character, _nested)
