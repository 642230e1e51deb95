"""What a SPICE netlist asks for: the end time by .tran, nodes by .print and the like, values at the begin by .ic."""

import re
from collections.abc import Iterable, Iterator

from tline.errors import InputError
from tline.interchange.deck import Card
from tline.interchange.findings import Findings
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


def transient(cards: list[Card], frequencies: list[Card], path: str, found: Findings) -> Transient | None:
    """What the first .tran of a netlist says, or without one the first .ac."""
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
    if len(card.words) not in (4, 5) or card.words[0].lower() not in ("dec", "oct", "lin"):
        raise card.refuse("not a range of frequencies", ".ac dec POINTS FROM TO", f"'{' '.join(card.words):.40}'")
    points, low, high = map(card.value, card.words[1:4])
    if not 0 <= low <= high or min(points, high) <= 0:
        raise card.refuse(
            "its frequencies are not in order", "FROM 0 or more, TO not below it", f"{low:g}, {high:g} Hz"
        )
    low = low or high / points
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
    """The nodes that a card asks for, each with the card; what else it asks for is noted."""
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
