"""Valves of water networks as links of scenes."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import pi, sqrt
from typing import Any

from tline.interchange.water_network import LEAST_DROP, TRICKLE, WIDE_OPEN, Valve, WaterNetwork, listed
from tline.scene.heights import GRAVITY
from tline.scene.valve import open_loss, opening_of, shares

KEEPS = {"PRV": "downstream", "PSV": "upstream", "FCV": "flow"}
WIDE = 3.0  # times the bore of the pipes beside it: no valve's
FLAT = 1e-6  # share by which a head that is added falls with the flow
TRAVELS = {  # globes regulate, and butterflies throttle
    "PRV": "globe", "PSV": "globe", "PBV": "globe", "FCV": "globe", "TCV": "butterfly", "GPV": "butterfly",
}  # fmt: skip


def with_bores(network: WaterNetwork, notes: list[str]) -> list[tuple[str, Valve]]:
    """The valves by name; where files give a bore that no valve has, with that of the pipes beside it."""
    beside: dict[str, float] = {}
    for pipe in network.pipes.values():
        for node in pipe.nodes:
            beside[node] = max(beside.get(node, 0.0), pipe.diameter)
    found, changed = [], []
    for name, valve in network.valves.items():
        usual = max(beside.get(node, 0.0) for node in valve.nodes)
        if usual and valve.diameter > WIDE * usual and not valve.travel:
            changed.append(name)
            valve = replace(valve, diameter=usual)
        found.append((name, valve))
    if changed:
        notes.append(f"valves: much wider than the pipes beside them, and taken as wide as these: {listed(changed)}")
    return found


def is_shut(valve: Valve) -> bool:
    """Whether a valve holds a head and lets nothing pass."""
    return abs(valve.flow) <= TRICKLE and abs(valve.drop) > LEAST_DROP


def valve_link(name: str, valve: Valve, density: float, notes: list[str]) -> dict[str, Any]:
    """Return a valve at the opening that gives its loss at the operating point.

    If that is less than the loss of such a valve wide open, its loss is smaller in proportion all along its travel. A
    positional valve has that of the file. One that keeps a pressure or a flow goes on to keep it, in the usual time at
    any loss.
    """
    if valve.flow * valve.drop < 0 and abs(valve.flow) > TRICKLE and abs(valve.drop) > LEAST_DROP:
        return _adding(name, valve, density * GRAVITY, notes)
    kind = TRAVELS[valve.kind]
    loss, speed = valve.loss or open_loss(kind, valve.diameter), abs(valve.flow) / (pi / 4 * valve.diameter**2)
    opening = 0.0 if is_shut(valve) or not valve.share else opening_of(valve.travel, valve.share)
    if abs(valve.flow) > TRICKLE:
        per_head = 2 * GRAVITY / speed**2
        lost = max(abs(valve.drop), WIDE_OPEN) * per_head
        loss = lost * valve.share**2 if valve.travel else min(lost, loss)
        opening = opening_of(valve.travel or shares(kind, loss), sqrt(loss / lost))
    if valve.active and 0 < opening < 1:
        regulates = _regulates(valve, opening, density * GRAVITY)
    else:
        regulates = {"kind": "orifice"}
    return regulates | {
        "nodes": list(valve.nodes),
        "loss_coefficient": loss,
        "diameter": valve.diameter,
        "density": density,
        "opening": opening,
        "characteristic": [[*point] for point in valve.travel] or kind,
    }


def _regulates(valve: Valve, opening: float, weight: float) -> dict[str, Any]:
    """Quantity that a valve keeps; pressures at it change by at most twice its loss for a share of its opening."""
    keeps, per_opening = KEEPS[valve.kind], 2 / opening
    band = {"flow_band": valve.flow * per_opening} if keeps == "flow" else {"band": weight * valve.drop * per_opening}
    return {"kind": "regulating valve", "keeps": keeps} | {key: float(f"{x:.3g}") for key, x in band.items()}


def regulators(links: Mapping[str, Any]) -> Iterator[str]:
    """A note on valves that regulate."""
    names = [name for name, link in links.items() if link["kind"] == "regulating valve"]
    if names:
        keeps = "keep what they keep at the operating point, and are back there in some 10 s after a change"
        yield f"valves: {keeps}; give them the time_constant, band and stroke_time that they have: {listed(names)}"


def _adding(name: str, valve: Valve, weight: float, notes: list[str]) -> dict[str, Any]:
    """Pump in place of a pressure breaker against whose setting water flows: EPANET lets it add head."""
    rise, flow = abs(valve.drop), abs(valve.flow)
    says = f"water flows through it backward, and EPANET lets it add {rise:.4g} m of head, as no valve can"
    notes.append(f"valve '{name}': {says}; a pump of that head stands for it, so check the network")
    one, two = valve.nodes if valve.flow > 0 else reversed(valve.nodes)
    return {"kind": "pump", "nodes": [one, two], "curve": [[0.0, weight * rise * (1 + FLAT)], [flow, weight * rise]]}


def put_gate(tables: dict[str, Any], pipe: str, end: str, more: Mapping[str, Any]) -> str:
    """Put a gate valve, with these keys, before the second end of a pipe, and give the node between them."""
    node, loss = gate_of(pipe), float(f"{open_loss('gate', more['diameter']):.3g}")
    valve = {"kind": "orifice", "nodes": [node, end], "loss_coefficient": loss, "characteristic": "gate"}
    tables.setdefault("links", {})[node] = {**valve, **more}
    return node


def gate_of(pipe: str) -> str:
    """Node before the valve that is put at the second end of a pipe, and its name."""
    return f"{pipe}:gate"


def guesses(links: Mapping[str, Any]) -> Iterator[str]:
    """Notes on assumed travels, which no file gives."""
    for kind in sorted({*TRAVELS.values()}):
        names = [name for name, link in links.items() if link.get("characteristic") == kind]
        if names:
            guess = f"that of a {kind} valve is a guess; give them the characteristic that they have"
            yield f"how valves lose on their way from open to shut: {guess}: {listed(names)}"
