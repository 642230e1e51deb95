"""Lines of SPICE netlists: T elements, O elements by an LTRA model, W elements by a static RLGC model."""

from math import sqrt
from typing import Any

from tline.interchange.deck import Card, nodes_of

PER_METRE = {"r", "l", "c", "len"}
NUMERICAL = {  # of LTRA: how that program computes, not what the line is
    "rel", "abs", "nosteplimit", "nocontrol", "lininterp", "quadinterp", "mixedinterp", "compactrel", "compactabs",
    "truncnr", "truncdontcut", "steplimit",
}  # fmt: skip
MATRICES = {"l0": "inductance", "c0": "capacitance", "r0": "resistance", "g0": "conductance", "rs": "skin", "gd": ""}
NO_MATTER = {"delayopt", "fgd"}  # of W: the first tells how to compute, the second is a corner of Gd
HIGH = 1e9  # Hz, at which the resistance by Rs is said


def lossless_line(card: Card) -> dict[str, Any]:
    """A T element as a scene's line without nodes."""
    words = card.words[4:]
    given = {key.lower(): card.value(value) for key, value in zip(words[::3], words[2::3], strict=False)}
    names = "Z0 with TD, or with F (and NL)"
    if len(words) % 3 or any(word != "=" for word in words[1::3]) or not given.keys() <= {"z0", "td", "f", "nl"}:
        raise card.refuse("not a list of what a lossless line has", names, " ".join(words)[:60])
    if "z0" not in given or ("td" in given) == ("f" in given) or given.keys() & {"td", "nl"} == {"td", "nl"}:
        raise card.refuse("its z0 and delay are not given once", names, ", ".join(given).upper())
    if given.get("f", 1.0) <= 0:
        raise card.refuse("its frequency is not above zero", "more than 0", f"{given['f']:g}")
    delay = given["td"] if "td" in given else given.get("nl", 0.25) / given["f"]
    return {"z0": given["z0"], "delay": delay}


def ltra_line(model: Card) -> dict[str, Any]:
    """R, L and C per metre by an LTRA model, as a scene's line without nodes."""
    kind, words = "".join(model.words[1:2]), model.words[2:]
    if kind.lower() != "ltra":
        raise model.refuse("not known here", "LTRA", f"'{kind}'")
    given: dict[str, float] = {}
    while words:
        key, *words = words
        valued = words[:1] == ["="] and len(words) > 1
        if key.lower() not in PER_METRE | NUMERICAL or (key.lower() in PER_METRE and not valued):
            raise model.refuse("not a list of what a line with resistance has", "R, L, C and LEN", f"'{key}'")
        if valued:
            given[key.lower()] = model.value(words[1])
            words = words[2:]
    for name in ("l", "c", "len"):
        if given.get(name, 0.0) <= 0:
            raise model.refuse(f"its {name.upper()} is not above zero", "more than 0", f"{given.get(name, 0.0):g}")
    if given.get("r", 0.0) < 0:
        raise model.refuse("its R is below zero", "0 or more", f"{given['r']:g}")
    delay = given["len"] * (given["l"] * given["c"]) ** 0.5
    line = {"z0": (given["l"] / given["c"]) ** 0.5, "delay": delay, "length": given["len"]}
    return line | ({"resistance": given["r"]} if given.get("r") else {})


def rlgc_line(card: Card, model: Card, conductors: int) -> dict[str, Any]:
    """What a W element and its RLGC model say, as a scene's line without nodes.

    Z(f) = Ro + √f (1+j) Rs + 2πj f Lo and Y(f) = Go + 2πj f Co per metre, lower triangles of symmetric matrices.

    Raises
    ------
    InputError
        Naming the card that has something else, or the model with a matrix that is not whole, or with Gd.

    References
    ----------
    HSPICE Elements and Device Models Manual, chapter "W element", input model 1; D. B. Kuznetsov, J. E. Schutt-Aine,
    IEEE Trans. Circuits and Systems I 43 (1996) 110-121.
    """
    own = rlgc_settings(card)
    length = card.value(own["l"])
    if length <= 0:
        raise card.refuse("its length is not above zero", "more than 0", f"{length:g}")
    given = _assigned(model, model.words[2:])
    if "".join(model.words[1:2]).lower() != "w" or [word.lower() for word in given.pop("modeltype", [])] != ["rlgc"]:
        raise model.refuse("not known here", ".model NAME W MODELTYPE=RLGC", f"'{' '.join(model.words[1:5])}'")
    for which, said in ((card, [own["n"]]), (model, given.pop("n", [own["n"]]))):
        if [which.value(word) for word in said] != [conductors]:
            raise which.refuse("another number of conductors", f"N={conductors}", f"N={' '.join(said)}")
    line: dict[str, Any] = {"length": length}
    for key, words in given.items():
        name = key[0] + "0" if key[1:] == "o" else key
        if name not in MATRICES or MATRICES[name] in line:
            raise model.refuse("not a list of what a line has", "Lo, Co, Ro, Go and Rs, each once", f"'{key:.40}'")
        line[MATRICES[name]] = _symmetric(model, key, words, conductors)
    if any(map(any, line.pop("", []))):
        problem = "Gd, a conductance proportional to frequency, is not causal beside a constant capacitance"
        raise model.refuse(problem, "Gd=0, and loss_tangent in the scene")
    for key, name in (("Lo", "inductance"), ("Co", "capacitance")):
        if name not in line or min(row[k] for k, row in enumerate(line[name])) <= 0:
            raise model.refuse(f"its {key} is not above zero", "more than 0 for each conductor")
    line = {name: value for name, value in line.items() if name == "length" or any(map(any, value))}
    if "skin" in line:
        high = [[value * sqrt(HIGH) for value in row] for row in line["skin"]]
        line["skin"] = {"resistance": high, "frequency": HIGH, "added": True}
    return line if conductors > 1 else _single(line)


def rlgc_settings(card: Card) -> dict[str, str]:
    """N, L and RLGCMODEL of a W element."""
    given = _assigned(card, card.words[nodes_of(card.words) :])
    own = {key: words[0] for key, words in given.items() if key not in NO_MATTER and len(words) == 1}
    if own.keys() != {"n", "l", "rlgcmodel"} or given.keys() - NO_MATTER != own.keys():
        expected = "N=1 in 0 out 0 RLGCMODEL=name L=length"
        raise card.refuse("not a line by a static RLGC model", expected, f"'{' '.join(card.words):.60}'")
    return own


def _assigned(card: Card, words: list[str]) -> dict[str, list[str]]:
    """Names with the words behind their equal signs."""
    starts = [k - 1 for k, word in enumerate(words) if word == "="]
    if starts[:1] != [0]:
        raise card.refuse("not a list of values", "name=value", f"'{' '.join(words):.40}'")
    ends = [*starts[1:], len(words)]
    return {words[start].lower(): words[start + 2 : end] for start, end in zip(starts, ends, strict=True)}


def _symmetric(model: Card, key: str, words: list[str], n: int) -> list[list[float]]:
    """Rows of a matrix by its lower triangle."""
    values, rows = [model.value(word) for word in words], range(n)
    if len(values) != n * (n + 1) // 2:
        problem, expected = f"its {key.capitalize()} is not a lower triangle", f"{n * (n + 1) // 2} values"
        raise model.refuse(problem, expected, f"{len(values)}")
    return [[values[max(i, j) * (max(i, j) + 1) // 2 + min(i, j)] for j in rows] for i in rows]


def _single(line: dict[str, Any]) -> dict[str, Any]:
    """A line of one conductor, its matrices as numbers."""
    plain = {name: value[0][0] if isinstance(value, list) else value for name, value in line.items()}
    if "skin" in plain:
        plain["skin"] = plain["skin"] | {"resistance": plain["skin"]["resistance"][0][0]}
    return plain
