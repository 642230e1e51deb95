"""Parameters and functions that SPICE netlists define: .param and .func, in braces, quotes or bare."""

import re

from tline.interchange.spice_functions import Defined

PARAMETERS = (".param", ".params", ".parameter", ".global_param", ".csparam")
FUNCTION = ".func"
NAME = r"[a-z_]\w*"
START = re.compile(rf"({NAME})\s*(\([^(){{}}'\"]*\))?\s*=(?!=)", re.IGNORECASE)
HELD = re.compile(r"\{[^{}]*\}|'[^']*'|\"[^\"]*\"")
DEFINITION = re.compile(rf"\.\w+\s+({NAME})\s*\(([^()]*)\)\s*=?\s*(.+)", re.IGNORECASE)


def assignments(text: str) -> list[str]:
    """Words of a card of parameters: name, '=' and value again and again; what is bare gets braces.

    Examples
    --------
    >>> assignments(".param z=50 w = z*2 +1k, d='2*z' f(x)='x*2'")
    ['z', '=', '50', 'w', '=', '{z*2 +1k}', 'd', '=', "'2*z'", 'f(x)', '=', "'x*2'"]
    """
    hidden = HELD.sub(lambda found: "#" * len(found[0]), text)
    starts = list(START.finditer(hidden))
    ends = [*(start.start() for start in starts[1:]), len(text)][: len(starts)]
    words = text[: starts[0].start()].split()[1:] if starts else text.split()[1:]
    for start, end in zip(starts, ends, strict=True):
        value = text[start.end() : end].strip().rstrip(",").strip()
        bare = not HELD.fullmatch(value) and not re.fullmatch(r"[\w.+-]*", value)
        words += [start[1] + (start[2] or ""), "=", f"{{{value}}}" if bare else value]
    return [word for word in words if word]


def function(text: str) -> tuple[str, Defined] | None:
    """Name and definition of a function by its card, or by an assignment behind a word."""
    found = DEFINITION.fullmatch(text)
    if found is None:
        return None
    names = tuple(name.strip().lower() for name in found[2].split(",") if name.strip())
    return found[1].lower(), Defined(names, found[3].strip().strip("{}'\""))
