"""Diodes in SPICE netlists: an exponential, by saturation current and emission coefficient."""

from typing import Any

from tline.interchange.deck import Card
from tline.interchange.findings import Findings

KEYS = {"is": "saturation", "n": "emission", "js": "saturation"}
DEFAULTS = {"saturation": 1e-14, "emission": 1.0}  # of SPICE
NOMINAL = 300.15  # K
ZERO = {"cjo", "cj0", "cj", "tt", "ikf", "ik", "isr", "jsw", "cjp", "cjsw"}  # of a real diode; here they must be zero
OF_THESE = {  # no matter where those are zero, or at one temperature
    "vj", "pb", "m", "mj", "fc", "eg", "xti", "tnom", "tref", "kf", "af", "nr", "level", "php", "mjsw", "fcs", "bv",
    "ibv", "nbv", "trs", "trs1", "trs2", "tcv", "mfg", "type", "iave", "vpk",
}  # fmt: skip


def diode(model: Card, found: Findings) -> tuple[dict[str, Any], float]:
    """The table of a diode, without its nodes, and the resistance in series with it, ohm."""
    plain, given = model.of_kind("D").assigned(2)
    table: dict[str, Any] = {"kind": "diode"} | DEFAULTS
    series = 0.0
    for key in plain:
        raise model.refuse("not a list of parameters", "name = value", f"'{key:.40}'")
    for name, words in given.items():
        if name in ("mfg", "type"):
            continue
        if len(words) != 1:
            raise model.refuse("not a list of parameters", "name = value", f"'{name:.40}'")
        number = model.value(words[0])
        if name in KEYS:
            table[KEYS[name]] = number
        elif name == "rs":
            series = number
        elif name in ("bv", "vb"):
            found.note(model.where, f"the breakdown at {number:g} V is left out")
        elif name not in OF_THESE and (name not in ZERO or number):
            problem = "more than an exponential and a resistance"
            raise model.refuse(problem, f"IS, N and RS; {name.upper():.40} zero", f"'{name:.40}'")
    if series < 0:
        raise model.refuse("its RS is below zero", "0 or more", f"{series:g}")
    return table, series
