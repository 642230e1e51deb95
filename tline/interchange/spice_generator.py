"""The signal generator of gnucap, which sources take their pulses from, as the pulses of other dialects."""

from tline.interchange.deck import Card
from tline.interchange.findings import Findings

COMMANDS = (".gen", ".generator")
SETTINGS = {  # its defaults, s and V
    "frequency": 0.0, "amplitude": 1.0, "phase": 0.0, "max": 1.0, "min": 0.0, "offset": 0.0, "initial": 0.0,
    "rise": 1e-12, "fall": 1e-12, "delay": 0.0, "width": 0.0, "period": 0.0,
}  # fmt: skip


def with_generator(cards: list[Card], found: Findings) -> list[Card]:
    """The cards, with a PULSE in place of each ``generator(SCALE)``."""
    settings = dict(SETTINGS)
    for card in cards:
        if card.name.lower() in COMMANDS:
            with found.gathered():
                settings |= _settings(card)
    plain = [card for card in cards if card.name.lower() not in COMMANDS]
    return [_pulsed(card, settings, found) for card in plain]


def _settings(card: Card) -> dict[str, float]:
    """What a command sets; words may be cut short."""
    given = {}
    for word, values in card.assigned(0)[1].items():
        names = [name for name in SETTINGS if name.startswith(word)]
        if not names or len(values) != 1:
            raise card.refuse("not a setting of the generator", ", ".join(SETTINGS), f"'{word:.40}'")
        given[names[0]] = card.value(values[0])
    return given


def _pulsed(card: Card, settings: dict[str, float], found: Findings) -> Card:
    words = card.words
    if card.kind not in "VI" or len(words) < 3 or words[2].lower() not in ("gen", "generator"):
        return card
    with found.gathered():
        low, high = (settings["amplitude"] * settings[key] + settings["offset"] for key in ("min", "max"))
        if settings["frequency"] or settings["initial"] != low or len(words) > 4:
            raise card.refuse("a generator of other than pulses from its initial value", "frequency 0, initial = min")
        scale = card.value(words[3]) if len(words) > 3 else 1.0
        times = [settings[key] for key in ("delay", "rise", "fall", "width", "period")]
        return card._replace(words=[*words[:2], "PULSE", *map(repr, (scale * low, scale * high, *times))])
    return card._replace(words=[*words[:2], "0"])
