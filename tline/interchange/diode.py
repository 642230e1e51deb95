"""Diodes in SPICE netlists: an exponential, by saturation current and emission coefficient."""

from typing import Any

from tline.interchange.deck import Card
from tline.interchange.spice_names import Names
from tline.scene.characteristic import Diode, DiodeLink

KEYS = {"is": "saturation", "n": "emission"}
DEFAULTS = {"saturation": 1e-14, "emission": 1.0}  # of SPICE
NOMINAL = 300.15  # K
NEGLECTED = {"rs", "cjo", "cj0", "tt", "ikf", "ibv", "isr"}  # of a real diode; here they must be zero


def diode(model: Card) -> dict[str, Any]:
    """The table of a diode, without its nodes.

    Raises
    ------
    InputError
        Naming the model: it is no diode, or more than an exponential.
    """
    kind, words = "".join(model.words[1:2]), model.words[2:]
    if kind.lower() != "d":
        raise model.refuse("not a diode", "D", f"'{kind}'")
    table: dict[str, Any] = {"kind": "diode"} | DEFAULTS
    for key, equals, value in zip(words[::3], words[1::3], words[2::3], strict=False):
        name, number = key.lower(), model.value(value) if equals == "=" else 1.0
        if equals != "=" or (name not in KEYS and (name not in NEGLECTED or number)):
            raise model.refuse("more than an exponential", "IS and N", f"'{key}'")
        if name in KEYS:
            table[KEYS[name]] = number
    if len(words) % 3:
        raise model.refuse("not a list of parameters", "name = value", f"'{words[-1]}'")
    return table


def diode_cards(element: Diode | DiodeLink, name: str, nodes: list[str], names: Names) -> list[str]:
    """The element and its model; its temperature is part of the emission coefficient."""
    card, model = names.element("D", name), names.element("M", name)
    emission = float(element.emission) * float(element.temperature) / NOMINAL
    return [f"{card} {' '.join(nodes)} {model}", f".model {model} D(IS={float(element.saturation)!r} N={emission!r})"]
