"""Commands of a SPICE netlist: end time, printed nodes, initial voltages, measures, steps."""

import re
from collections.abc import Callable, Iterable, Iterator
from math import floor, log
from shlex import quote
from typing import Any, NamedTuple

from tline.errors import InputError
from tline.interchange.deck import Card, Findings
from tline.interchange.netlist import REFERENCE, Netlist
from tline.interchange.spice_expression import PARAMETERS
from tline.interchange.spice_source import Transient
from tline.interchange.subcircuits import GROUND
from tline.units import engineering

SHOWN = (".print", ".plot", ".save", ".probe", ".probe64")
VOLTAGE = re.compile(r"(?<![\w.])v\(\s*([^\s,()]+)\s*(?:,\s*([^\s,()]+)\s*)?\)", re.IGNORECASE)
ALL = ("*", "nodes")  # as names of all nodes
AT_BEGIN = re.compile(r"v\(\s*([^\s,()]+)\s*\)\s*=\s*(\S+)", re.IGNORECASE)
FORMS = re.compile(r"\w+\s*=\s*\S+|\b(?:tran|dc|ac|all|xlimit\s+\S+\s+\S+|ylimit\s+\S+\s+\S+)\b", re.IGNORECASE)
HARMLESS = {
    ".options": "", ".option": "", ".opt": "", ".width": "", ".op": "", ".title": "", ".backanno": "", ".list": "",
    ".status": "", ".stat": "", ".nodeset": "a guess of the steady state, which is found without", ".preprocess": "",
    ".data": "make a run for each value", ".sens": "", ".four": "",
    ".dc": "another analysis", ".noise": "another analysis", ".tf": "",
    ".hb": "another analysis", ".pz": "another analysis", ".disto": "another analysis", ".lin": "another analysis",
    ".fft": "", ".graph": "", ".protect": "", ".unprotect": "", ".connect": "", ".machine": "",
    ".wave": "", ".net": "another analysis", ".preset": "", ".result": "", ".dcvolt": "", ".set_subcircuit": "",
}  # fmt: skip
TEMPERATURES = (".temp", ".temperature")
MEASURE = (".measure", ".meas")
DIFFERENCE = re.compile(r"(?:[{'\"]\s*)?v\(\s*([^\s(),]+)\s*\)\s*-\s*v\(\s*([^\s(),]+)\s*\)\s*[}'\"]?", re.IGNORECASE)
WORD = re.compile(r"v\([^()]*\)|\{[^{}]*\}|'[^']*'|[^\s=,]+", re.IGNORECASE)
EXTENTS = {
    "MAX": "maximum", "MIN": "minimum", "PP": "peak to peak", "AVG": "mean", "RMS": "rms",
    "INTEG": "integral", "INTEGRAL": "integral",
}  # fmt: skip
EDGES = {"RISE": "rise", "FALL": "fall", "CROSS": "any"}
OTHERS = ("AC", "DC", "OP", "NOISE", "TF", "SP", "FFT", "TRAN_CONT", "AC_CONT", "DC_CONT", "NOISE_CONT")
STEP, MOST_VALUES = ".step", 100_000
RATIOS = {"dec": 10.0, "oct": 2.0}
BARE = re.compile(r"[\w-]+", re.ASCII)  # a key that needs no quotes


def transient(cards: list[Card], frequencies: list[Card], path: str, found: Findings) -> Transient | None:
    """Read the first .tran of a netlist, or without one the first .ac."""
    for card in frequencies if cards else frequencies[1:]:
        found.note(card.where, "skipped: another analysis: tline frequency")
    if frequencies and not cards:
        with found.gathered():
            return _without_run(frequencies[0], found)
        return None
    if not cards:
        found.mistakes.append(InputError(path, "the end time is not given", ".tran STEP END"))
        return None
    for other in cards[1:]:
        found.note(other.where, "skipped, for the first run counts")
    with found.gathered():
        return _times(cards[0], found)
    return None


def _without_run(card: Card, found: Findings) -> Transient:
    """A period of the lowest frequency, where only frequencies are asked for."""
    words, spread = card.words, bool(card.words) and card.words[0].lower() in ("dec", "oct", "lin")
    if not (len(words) in (4, 5) if spread else len(words) > 2):
        expected = ".ac dec POINTS FROM TO, or FROM TO STEP"
        raise card.refuse("not a range of frequencies", expected, f"'{' '.join(words):.40}'")
    if spread:
        points, low, high = map(card.value, words[1:4])
        least = high / points if points > 0 else 0.0
    else:  # of gnucap, whose third word may also be dec, oct, or a factor
        low, high = map(card.value, words[:2])
        least = card.value(words[2]) if len(words) == 3 else low
    if not 0 <= low <= high or min(least, high) <= 0:
        expected = "FROM 0 or more, TO not below it, points or a step above 0"
        raise card.refuse("not a range of frequencies", expected, f"'{' '.join(words):.40}'")
    low = low or least
    first, last, period = engineering(low, "Hz"), engineering(high, "Hz"), engineering(1 / low, "s")
    advice = f'tline frequency SCENE.toml --from "{first}" --to "{last}"'
    found.note(card.where, f"there is no .tran, and {period} is the end; {advice} shows it, per unit of a source")
    return Transient(0.0, 1 / low, True, False)


def _times(card: Card, found: Findings) -> Transient:
    words = [word for word in card.words if word.lower() not in ("uic", "noop")]
    numbers: list[float] = []
    for word in words:
        if not re.match(r"[\d.+{'-]", word) and word.lower() not in card.parameters:
            break
        numbers.append(card.value(word))
    if words[len(numbers) :]:
        found.note(card.where, f"'{' '.join(words[len(numbers) :]):.60}' is skipped")
    if not 1 <= len(numbers) <= 5:
        raise card.refuse("not a time step and an end", ".tran STEP END [0 [LONGEST STEP]] [UIC]")
    step, end = (0.0, numbers[0]) if len(numbers) == 1 else numbers[:2]
    if step < 0 or end <= 0:
        raise card.refuse("a time that is not above zero", "more than 0")
    if numbers[2:3] not in ([], [0.0]) and step > 0:
        found.note(card.where, f"results before {numbers[2]:g} s are kept")
    return Transient(step, end, len(words) < len(card.words))


def nodes_shown(card: Card, found: Findings) -> Iterator[tuple[Card, str]]:
    """Yield the nodes that a card prints, each with the card; other requests are noted."""
    rest = FORMS.sub(" ", VOLTAGE.sub(" ", card.text)).split()[1:]
    rest = [word for word in rest if re.search(r"\w\(|@|\[", word)]
    if rest:
        found.note(card.where, f"voltages of nodes are recorded, and '{' '.join(rest):.40}' is not")
    for pair in VOLTAGE.findall(card.text):
        yield from ((card, name.replace(":", ".")) for name in pair if name and name.lower() not in {*GROUND, *ALL})


def values_at_begin(cards: Iterable[Card]) -> dict[str, tuple[Card, float]]:
    """Voltages of nodes by .ic, by name in lower case."""
    given: dict[str, tuple[Card, float]] = {}
    for card in cards:
        pairs = AT_BEGIN.findall(card.text)
        if not pairs or AT_BEGIN.sub("", card.text).split()[1:]:
            raise card.refuse("not a list of voltages", ".ic v(NODE)=VALUE", f"'{card.text:.40}'")
        for name, value in pairs:
            given[name.replace(":", ".").lower()] = card, card.value(value)
    return given


def skip(card: Card, found: Findings, has_heat: bool) -> None:
    """Note a command that changes nothing here."""
    name = card.name.lower()
    if name in TEMPERATURES and has_heat and card.words and abs(card.value(card.words[0]) - 27) > 1e-9:
        raise card.refuse("another temperature beside diodes, or coefficients of it", "27 degC", card.words[0])
    if name not in HARMLESS and name not in TEMPERATURES:
        raise card.refuse("a command that is not known here", ".tran, .model, .subckt, .param, .include, .ic, .print")
    advice = HARMLESS.get(name, "")
    found.note(card.where, f"skipped{f': {advice}' if advice else ''}")


Table = dict[str, Any]


def measures(cards: Iterable[Card], net: Netlist) -> dict[str, Table]:
    """Measures by name; unknown ones are skipped with a note, since they change no voltage."""
    found: dict[str, Table] = {}
    for card in cards:
        try:
            reader = _MeasureReader(card, net)
            found[reader.name] = reader.measure()
            net.cards["measures", reader.name] = card
        except InputError as error:
            net.found.note(card.where, f"skipped: {error.problem}{', got ' * bool(error.got)}{error.got}")
    return found


def nodes_measured(tables: dict[str, Table]) -> list[str]:
    """Nodes at which measures need probes."""
    ends = [each.get(key) for each in tables.values() for key in ("start", "stop", "when")]
    parts = [*tables.values(), *(end for end in ends if isinstance(end, dict))]
    return [part[key] for part in parts for key in ("probe", "minus") if key in part]


class _MeasureReader:
    """Takes the words of a card from the left; '=' counts for nothing."""

    def __init__(self, card: Card, net: Netlist):
        self.card, self.net, self.words = card, net, WORD.findall(DIFFERENCE.sub(r"v(\1,\2)", card.text))[1:]
        self._is("TRAN")
        if self.words and self.words[0].upper() in OTHERS:
            raise card.refuse("another analysis")
        self._take()
        self.name = self.last

    def measure(self) -> Table:
        """The whole card."""
        word = self._take()
        if word in EXTENTS:
            table = {"kind": EXTENTS[word]} | self._signal() | self._span()
        elif word == "WHEN":
            table = {"kind": "crossing"} | self._crossing()
        elif word == "FIND":
            table = {"kind": "value"} | self._signal()
            table |= {"at": self._number()} if self._is("AT") else {"when": self._crossing_after("WHEN")}
        elif word == "TRIG" and self._is("AT"):
            if self._number() != 0:
                raise self.card.refuse("an interval from an instant that is not 0")
            table = {"kind": "crossing"} | self._crossing_after("TARG")
        elif word == "TRIG":
            table = {"kind": "delay", "start": self._crossing(), "stop": self._crossing_after("TARG")}
        else:
            raise self.card.refuse("not known here", got=f"'{self.last:.40}'")
        if self.words:
            raise self.card.refuse("not known here", got=f"'{' '.join(self.words):.40}'")
        return table

    def _crossing_after(self, word: str) -> Table:
        if self._take() != word:
            raise self.card.refuse(f"{word} is missing", got=f"'{self.last:.40}'")
        return self._crossing()

    def _crossing(self) -> Table:
        table = self._signal()
        self._is("VAL")
        if self.words[:1] and self.words[0][:2].upper() == "V(":
            other = self._signal()
            if "minus" in table or "minus" in other:
                raise self.card.refuse("a difference that crosses a voltage")
            table |= {"minus": other["probe"], "level": 0.0}
        else:
            table["level"] = self._number()
        while self.words and self.words[0].upper() in ("TD", *EDGES):
            word = self._take()
            if word == "TD":
                table["after"] = self._number()
            else:
                table |= {"edge": EDGES[word], "count": 0 if self._is("LAST") else round(self._number())}
        return table

    def _span(self) -> Table:
        table: Table = {}
        while self.words and self.words[0].upper() in ("FROM", "TO", "TD"):
            key = "stop" if self._take() == "TO" else "start"
            table[key] = self._number()
        return table

    def _signal(self) -> Table:
        """A voltage, or the difference of two."""
        self._take()
        nodes = self.last[2:-1].replace(",", " ").replace(":", ".").split()
        if self.last[:2].upper() != "V(" or not 1 <= len(nodes) <= 2:
            raise self.card.refuse("not of voltages of nodes", got=f"'{self.last:.40}'")
        first, *second = (self.net.node(node) for node in nodes)
        second = [node for node in second if node != REFERENCE]
        known = self.net.degrees()
        for node in (first, *second):
            if node not in known or node == REFERENCE:
                raise self.card.refuse("no waves reach that node", got=f"'{node:.40}'")
        return {"probe": first} | ({"minus": second[0]} if second else {})

    def _take(self) -> str:
        """Return the next word in capitals; `last` keeps its spelling."""
        if not self.words:
            raise self.card.refuse("not whole")
        self.last = self.words.pop(0)
        return self.last.upper()

    def _is(self, word: str) -> bool:
        """Whether the next word is this one; if so, take it."""
        return self.words[:1] != [] and self.words[0].upper() == word and self._take() == word

    def _number(self) -> float:
        self._take()
        return self.card.value(self.last)


Tables = dict[str, Any]


class StepCard(NamedTuple):
    """Parameter of one .step, its values in the syntax of `tline sweep`, and two of them."""

    name: str
    values: str
    samples: tuple[str, str]


def with_first_values(cards: list[Card]) -> list[Card]:
    """The cards, and the first value of each parameter that is stepped and defined nowhere."""
    defined = {name for card in cards for name in _defined(card)}
    steps = [(card, step) for card in cards if (step := _step(card)) and "param" in map(str.lower, card.words[:2])]
    missing = {step.name: card._replace(name=".param", words=[step.name, "=", step.samples[0]]) for card, step in steps}
    return [*cards, *(card for name, card in missing.items() if name not in defined)]


def note_steps(cards: list[Card], found: Findings, file: str, tables: Callable[[list[Card]], Tables]) -> None:
    """Note the sweep command equivalent to all .step cards, and the cards without an equivalent."""
    varied = []
    for card in cards:
        if card.name.lower() != STEP:
            continue
        step = _step(card)
        path = _path(cards, step, tables) if step else ""
        if step and path:
            varied.append((card, f"--vary {quote(f'{path}={step.values}')}"))
        else:
            found.note(card.where, "skipped: make a run for each value")
    if varied:
        command = " ".join(["tline sweep", quote(file), *(option for _, option in varied)])
        found.note(varied[0][0].where, f"skipped: {command}")


def _step(card: Card) -> StepCard | None:
    """Read a .step card; None for other cards, and for values that a sweep cannot express."""
    words = [word for word in card.words if word.lower() not in ("lin", "param")] if card.name.lower() == STEP else []
    ratio = RATIOS.get(words[0].lower()) if words else None
    name, *given = words[1:] if ratio else words or [""]
    try:
        if given[:1] and given[0].lower() == "list":
            values = [repr(card.value(word)) for word in given[1:]]
            return StepCard(name.lower(), ", ".join(values), (values[0], values[-1])) if len(values) > 1 else None
        first, last, by = map(card.value, given)
        steps = (log(last / first, ratio) if ratio else (last - first)) * (by if ratio else 1 / by) + 1e-9
    except (InputError, ValueError, ArithmeticError):
        return None
    if not 1 <= steps < MOST_VALUES:  # nor if it is no number
        return None
    count = floor(steps)
    end = first * ratio ** (count / by) if ratio else first + count * by
    return StepCard(name.lower(), f"{first!r}:{end!r}:{count + 1}{':log' * bool(ratio)}", (repr(first), repr(end)))


def _path(cards: list[Card], step: StepCard, tables: Callable[[list[Card]], Tables]) -> str:
    """Path of the only value in the scene, unchanged, of a .step card; empty if there is none."""
    try:
        first, second = (tables([_with(card, step.name, value) for card in cards]) for value in step.samples)
    except InputError:
        return ""
    found = list(_differences(first, second, ()))
    wanted = tuple(map(float, step.samples))
    if len(found) != 1 or found[0][1:] != wanted:
        return ""
    return ".".join(key if BARE.fullmatch(key) else f'"{key}"' for key in found[0][0])


def _with(card: Card, name: str, value: str) -> Card:
    """Replace the value that a card gives to a parameter, or to the element of that name."""
    if name in _defined(card):
        words = list(card.words)
        words[[word.lower() for word in words].index(name) + 2] = value
        return card._replace(words=words)
    if card.name.lower() == name and card.kind in "RLCVI" and len(card.words) == 3:
        return card._replace(words=[*card.words[:2], value])
    return card


def _defined(card: Card) -> list[str]:
    """The parameters that a card gives values."""
    return [word.lower() for word in card.words[::3]] if card.name.lower() in PARAMETERS else []


def _differences(first: Any, second: Any, path: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Any, Any]]:
    """Yield the paths at which two nested tables differ, with both values."""
    if isinstance(first, dict) and isinstance(second, dict) and first.keys() == second.keys():
        for key in first:
            yield from _differences(first[key], second[key], (*path, key))
    elif first != second:
        yield path, first, second
