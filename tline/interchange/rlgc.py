"""Matrices of W elements: static RLGC models, in the netlist or in a file of their own."""

from tline.errors import InputError
from tline.interchange.deck import Card
from tline.interchange.netlist import Netlist
from tline.scene.text_file import Folder, read_text

MATRICES = {"l0": "l", "c0": "c", "r0": "r", "g0": "g", "rs": "rs", "gd": "gd"}
IN_FILE = ("l", "c", "r", "g", "rs", "gd")  # in this order
NO_MATTER = {"delayopt", "fgd"}  # the first tells how to compute, the second is a corner of Gd
LOWER, UPPER = "a lower", "an upper"
Matrix = list[list[float]]


def symmetric(model: Card, key: str, words: list[str], n: int, side: str) -> Matrix:
    """Rows of a symmetric matrix by its lower or upper triangle, row by row."""
    if len(words) != n * (n + 1) // 2:
        problem, expected = f"its {key.capitalize()} is not {side} triangle", f"{n * (n + 1) // 2} values"
        raise model.refuse(problem, expected, f"{len(words)}")
    rows = [[0.0] * n for _ in range(n)]
    places = [(i, j) for i in range(n) for j in (range(i + 1) if side == LOWER else range(i, n))]
    for (i, j), word in zip(places, words, strict=True):
        rows[i][j] = rows[j][i] = model.value(word)
    return rows


def rlgc_matrices(
    card: Card, net: Netlist, own: dict[str, list[str]], conductors: int
) -> tuple[float, dict[str, Matrix]]:
    """Length and matrices per length of a W element.

    Z(f) = Ro + √f (1+j) Rs + 2πj f Lo and Y(f) = Go + f Gd + 2πj f Co per metre, lower triangles of symmetric matrices.

    References
    ----------
    HSPICE Elements and Device Models Manual, chapter "W element", input model 1; D. B. Kuznetsov, J. E. Schutt-Aine,
    IEEE Trans. Circuits and Systems I 43 (1996) 110-121.
    """
    own = {key: words for key, words in own.items() if key not in NO_MATTER}
    given = {key: words[0] for key, words in own.items() if len(words) == 1}
    if "tablemodel" in given:
        raise card.refuse("a table over frequency", "tabulated, with a CSV file, in the scene")
    if given.keys() != own.keys() or given.keys() not in ({"n", "l", "rlgcmodel"}, {"n", "l", "rlgcfile"}):
        expected = "N=1 in 0 out 0 RLGCMODEL=name L=length, or RLGCFILE=file"
        raise card.refuse("not a line by a static RLGC model", expected, f"'{' '.join(card.words):.60}'")
    if card.value(given["n"]) != conductors:
        raise card.refuse("another number of conductors", f"N={conductors}", f"N={given['n']:.40}")
    length = card.value(given["l"])
    if "rlgcfile" in given:
        matrices = _from_file(card, net, given["rlgcfile"].strip("'\""), conductors)
    else:
        matrices = _from_model(net.model(card, given["rlgcmodel"]), conductors)
    if conductors > 1 and any(map(any, matrices.get("gd", []))):
        problem = "Gd of several conductors, a conductance proportional to frequency, is not causal beside constant C"
        raise card.refuse(problem, "Gd=0")
    return length, matrices


def _from_model(model: Card, n: int) -> dict[str, Matrix]:
    _, given = model.of_kind("W").assigned(2)
    if [word.lower() for word in given.pop("modeltype", [])] != ["rlgc"]:
        raise model.refuse("not known here", ".model NAME W MODELTYPE=RLGC", f"'{' '.join(model.words[1:5])}'")
    if [model.value(word) for word in given.pop("n", [str(n)])] != [n]:
        raise model.refuse("another number of conductors", f"N={n}")
    found: dict[str, Matrix] = {}
    for key, words in given.items():
        name = MATRICES.get(key[0] + "0" if key[1:] in ("", "o") else key)
        if name is None or name in found:
            raise model.refuse("not a list of what a line has", "Lo, Co, Ro, Go, Rs and Gd, each once", f"'{key:.40}'")
        found[name] = symmetric(model, key, words, n, LOWER)
    return found


def _from_file(card: Card, net: Netlist, name: str, n: int) -> dict[str, Matrix]:
    """Matrices of a file beside the netlist: the number of conductors, then lower triangles in a fixed order."""
    try:
        text = read_text(Folder(net.folder, confined=True).find(name), legacy=True)
    except InputError as error:
        raise card.refuse(error.problem.replace("scene's", "netlist's"), error.expected, error.got) from None
    words = [word for line in text.splitlines() for word in line.partition("*")[0].replace(",", " ").split()]
    size = n * (n + 1) // 2
    count, left = divmod(len(words) - 1, size)
    if not words or card.value(words[0]) != n or left or not 2 <= count <= len(IN_FILE):
        problem = f"'{name:.60}' has not the numbers of {n} conductors"
        raise card.refuse(problem, f"{n}, then {size} numbers for each of L, C, R, G, Rs and Gd, at least L and C")
    parts = [words[1 + k * size : 1 + (k + 1) * size] for k in range(count)]
    return {key: symmetric(card, key, part, n, LOWER) for key, part in zip(IN_FILE, parts, strict=False)}
