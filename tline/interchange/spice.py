"""Scenes from SPICE netlists: lines, sources behind resistances, R, L and C, and multiports, to the reference."""

from pathlib import Path
from typing import Any

from tline.errors import InputError
from tline.interchange.branches import Branch, as_load, reduced
from tline.interchange.elements import Netlist, SourceCard
from tline.interchange.spice_source import Waveform, waveforms
from tline.scene.file import scene_from
from tline.scene.scene import Scene

Tables = dict[str, dict[str, Any]]
KINDS = {"V": "voltage", "I": "current"}


def read_spice(path: str | Path) -> Scene:
    """Read a scene from a SPICE netlist.

    T, O and W elements are lines; R in series with V is the resistance of a source; networks of R, L and C between a
    line's end and the reference are loads, D a load or a link; K, E and G are links. ``.tran`` says the end time, and
    the state at its begin: that of rest with UIC, the steady state without. The nodes of ``.print``, ``.plot``,
    ``.save`` and ``.probe`` are probes; without these all ends of lines are.

    Parameters
    ----------
    path : str or Path
        The netlist, in UTF-8.

    Raises
    ------
    InputError
        The file cannot be read; or naming the line and the element that no scene has. SceneError with all mistakes of
        the scene.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder, "cable.cir")
    ...     _ = file.write_text("cable\\nV1 s 0 1\\nR1 s a 25\\nT1 a 0 b 0 Z0=50 TD=1n\\nR2 b 0 100\\n.tran 1p 9n uic")
    ...     scene = read_spice(file)
    >>> scene.lines["T1"].parameters.z0, scene.sources["V1"].resistance, scene.loads["R2"].at
    (50.0, 25.0, 'b')
    """
    return scene_from(_tables(Netlist(path)))


def _tables(netlist: Netlist) -> dict[str, Any]:
    """The scene as a file holds it."""
    held = _held(netlist)
    driven: Tables = {}  # sources, and links that are driven elsewhere
    groups: dict[str, list[Branch]] = {}  # side by side, to the reference
    for branch in reduced(netlist.branches, {"0", *netlist.joined, *held}):
        inner = [node for node in branch.nodes if node != "0"]
        if len(inner) == 1 and inner[0] in netlist.joined:
            groups.setdefault(inner[0], []).append(branch)
        else:
            driven |= _behind(netlist, branch, held)
    for drive in netlist.drives:
        driven |= _ideal(netlist, drive, {name.partition(" ")[0] for name in driven})
    loads = {k: v for node, branches in groups.items() for k, v in _loads(node, branches).items()}
    links = netlist.links | {name: table for name, table in driven.items() if "nodes" in table}
    return {
        "title": netlist.title,
        "medium": "electrical",
        "t_end": netlist.tran.end,
        "start": "rest" if netlist.tran.uic else "steady",
        "lines": netlist.lines,
        "sources": {name: table for name, table in driven.items() if "at" in table},
        "loads": loads | netlist.diodes,
        **({"links": links} if links else {}),
        "probes": _probes(netlist),
    }


def _held(netlist: Netlist) -> dict[str, SourceCard]:
    """Voltage sources by node."""
    held: dict[str, SourceCard] = {}
    for drive in netlist.drives:
        if drive.card.kind in "VE" and held.setdefault(drive.node, drive) is not drive:
            problem = f"node '{drive.node}' is already held by {held[drive.node].card.name}"
            raise drive.card.refuse(problem, "one voltage source at a node")
    return held


def _behind(netlist: Netlist, branch: Branch, held: dict[str, SourceCard]) -> Tables:
    """The source that a resistor between a voltage source and a line's end makes; nothing else may lie there."""
    first, second = sorted(branch.nodes, key=lambda node: node not in held)
    if first in held and second in netlist.joined and second not in held and branch.impedance.degree == 0:
        drive = held[first]
        name = drive.card.name if _is_only(netlist, first) else f"{drive.card.name} + {branch.name}"
        return _source(netlist, drive, name, second, float(branch.impedance.at_zero()))
    raise _no_place(netlist, branch)


def _no_place(netlist: Netlist, branch: Branch) -> InputError:
    """What is neither load nor resistance of a source."""
    card = netlist.cards[branch.names[0].lower()]
    which = f"with {', '.join(branch.names[1:6])} " if len(branch.names) > 1 else ""
    problem = f"{which}lies between nodes '{branch.nodes[0]}' and '{branch.nodes[1]}'"
    expected = "R, L and C from a line's end to 0, or R from a voltage source to a line's end"
    return card.refuse(problem, expected)


def _is_only(netlist: Netlist, node: str) -> bool:
    """Whether one element alone is at a node beside its source."""
    return node not in netlist.joined and sum(node in branch.nodes for branch in netlist.branches) == 1


def _ideal(netlist: Netlist, drive: SourceCard, used: set[str]) -> Tables:
    """A source at a line's end itself; one elsewhere must have been used behind its resistors."""
    if drive.node in netlist.joined:
        return _source(netlist, drive, drive.card.name, drive.node, None)
    if drive.card.name not in used:
        raise drive.card.refuse("drives no line", "a line's end, or a resistor to one, at its node", f"'{drive.node}'")
    return {}


def _source(netlist: Netlist, drive: SourceCard, name: str, at: str, resistance: float | None) -> Tables:
    """A source of a scene, or two that add up; or a link, if a voltage commands it."""
    if drive.control:
        nodes = [drive.control, at]
        link = {"kind": "controlled source", "nodes": nodes, "gain": drive.sign, "resistance": resistance or 0.0}
        return {name: link}
    words, kind = drive.card.words[2:], KINDS[drive.card.kind]
    parts = waveforms(drive.card, words, netlist.tran, drive.sign)
    if len(parts) == 1:
        return {name: _table(at, kind, parts[0], resistance)}
    if kind == "voltage":  # each behind twice the resistance, twice as high
        if resistance is None:
            raise drive.card.refuse("EXP that falls within the run, and no resistor behind it", "a resistor in series")
        parts, resistance = waveforms(drive.card, words, netlist.tran, 2 * drive.sign), 2 * resistance
    names = (name, f"{name} (fall)")
    return {key: _table(at, kind, part, resistance) for key, part in zip(names, parts, strict=True)}


def _table(at: str, kind: str, value: Waveform, resistance: float | None) -> dict[str, Any]:
    table = {"at": at, "kind": kind, "value": value}
    return table if resistance is None else table | {"resistance": resistance}


def _loads(node: str, branches: list[Branch]) -> Tables:
    """Loads at a node: its single R, L and C as one, the others each as it is."""
    single = [branch for branch in branches if len(branch.names) == 1]
    loads = {b.name: {"at": node} | as_load(b.impedance) for b in branches if len(b.names) > 1}
    if single:
        impedance = single[0].impedance
        for branch in single[1:]:
            impedance = impedance.parallel(branch.impedance).reduced()
        loads[" + ".join(branch.name for branch in single)] = {"at": node} | as_load(impedance)
    return loads


def _probes(netlist: Netlist) -> Tables:
    """Probes at the nodes that are asked for, or at all ends of lines; where lines meet, on the first of them."""
    for card, name in netlist.shown:
        if netlist.node(name) not in netlist.ends:
            raise card.refuse("no line ends at this node", "a node of a T element", f"'{name}'")
    nodes = [netlist.node(name) for _, name in netlist.shown] or list(netlist.ends)
    return {node: {"at": node, "line": netlist.ends[node]} for node in nodes}
