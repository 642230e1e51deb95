"""Scenes from SPICE netlists in the dialects of ngspice, LTspice, HSPICE, Xyce and gnucap."""

from pathlib import Path
from typing import Any

import numpy as np

from tline.errors import InputError, SceneError
from tline.interchange.deck import OVER_FREQUENCY, Card, Findings, read_deck
from tline.interchange.elements import merge_shorts, take
from tline.interchange.netlist import (
    REFERENCE,
    Netlist,
    check_size,
    connected,
    folded,
    with_links,
    with_open_ends,
    without_idle_stores,
)
from tline.interchange.schematic import read_schematic
from tline.interchange.spice_commands import (
    MEASURE,
    SHOWN,
    STEP,
    measures,
    nodes_measured,
    nodes_shown,
    note_steps,
    skip,
    transient,
    values_at_begin,
    with_first_values,
)
from tline.interchange.spice_impedance import add_coupled, couplings, names_coupled
from tline.interchange.spice_linear import with_linear_sources
from tline.interchange.spice_source import Transient, with_generator
from tline.interchange.subcircuits import opened
from tline.scene.file import SCHEMATIC, scene_from
from tline.scene.scene import Scene
from tline.words.wording import nearest, place

ANY = Transient(0.0, 1.0, True)  # in place of a run that is not given, so that other mistakes are found


def read_spice(path: str | Path) -> tuple[Scene, tuple[str, ...]]:
    """Scene of a SPICE netlist, and notes on parts left out or interpreted.

    Each element becomes one of the scene, under its name: T, O, Y, P and W lines, R, L, C and D loads and links, V and
    I sources, E, F, G, H and K two-ports, U resistors and capacitors. R between a source and one other element is its
    resistance. ``.tran`` says the end time, and the state at its begin: that of rest with UIC or where all sources are
    zero, else the steady state. The nodes of ``.print``, ``.plot``, ``.save`` and ``.probe`` are probes; without these
    all ends of lines are. ``.measure`` becomes a measure. Files are included from the netlist's own folder only.

    Parameters
    ----------
    path : str or Path
        The netlist, in UTF-8, UTF-16 or Latin-1; of LTspice also the schematic, .asc.

    Returns
    -------
    Scene, tuple of str

    Raises
    ------
    InputError
        The file cannot be read; SceneError with all mistakes, each naming line and element.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder, "cable.cir")
    ...     _ = file.write_text("cable\\nV1 s 0 1\\nR1 s a 25\\nT1 a 0 b 0 Z0=50 TD=1n\\nR2 b 0 100\\n.tran 1p 9n uic")
    ...     scene, notes = read_spice(file)
    >>> scene.lines["T1"].parameters.z0, scene.sources["V1"].resistance, scene.loads["R2"].at, notes
    (50.0, 25.0, 'b', ())
    """
    found = Findings()
    deck = (read_schematic if Path(path).suffix.lower() == SCHEMATIC else read_deck)(path, found)
    cards = with_first_values(deck.cards)
    table, net = _read(cards, deck.title, Path(path), found)
    scene = _scene(table, net)
    file = Path(path).stem + ".toml"
    note_steps(cards, found, file, lambda changed: _read(changed, deck.title, Path(path), Findings())[0])
    return scene, tuple(found.notes)


def _read(raw: list[Card], title: str, path: Path, found: Findings) -> tuple[dict[str, Any], Netlist]:
    """The scene's tables, and the netlist that they are from."""
    cards = with_generator(opened(raw, found), found)
    commands: dict[str, list[Card]] = {name: [] for name in (".tran", ".model", ".ic", *OVER_FREQUENCY)}
    for card in cards:
        commands.get(card.name.lower(), []).append(card)
    frequencies = [card for name in OVER_FREQUENCY for card in commands[name]]
    tran = transient(commands[".tran"], frequencies, str(path), found)
    models = {card.words[0].lower(): card for card in commands[".model"] if card.words}
    cards = with_linear_sources(cards, found, (tran or ANY).end)
    net = Netlist(found, tran or ANY, models, path.parent)
    shown = []
    for card in cards:
        name = card.name.lower()
        if name in SHOWN:
            shown += nodes_shown(card, found)
        elif card.kind == "." and name not in (*commands, *MEASURE, STEP):
            with found.gathered():
                skip(card, found, any(each.kind == "D" or " tc" in each.text.lower() for each in cards))
    _take(net, [card for card in cards if card.kind != "."], commands[".ic"])
    found.check()
    dropped = connected(net) if net.tables["lines"] else set()
    table = {
        "title": title,
        "medium": "electrical",
        "t_end": net.tran.end,
        "start": "rest" if net.tran.uic or net.quiet else "steady",
    }
    table["measures"] = measures((card for card in cards if card.name.lower() in MEASURE), net)
    with found.gathered():
        table["probes"] = _probes(net, shown, nodes_measured(table["measures"]), dropped)
    found.check()
    _add_unused_line(net, str(path))
    folded(net, {probe["at"] for probe in table["probes"].values()})
    without_idle_stores(net)
    with_open_ends(net)
    with_links(net)
    check_size(net, str(path))
    return {key: value for key, value in (table | net.tables).items() if value != {}}, net


def _take(net: Netlist, elements: list[Card], begin: list[Card]) -> None:
    """Take all elements, each under a name of its own."""
    named: dict[str, Card] = {}
    for card in elements:
        with net.found.gathered():
            if named.setdefault(card.name.lower(), card) is not card:
                raise card.refuse("named twice", "another name")
    sensed = {card.words[2].lower() for card in elements if card.kind in "FH" and len(card.words) > 2}
    net.sensed = {key: f"{named[key].name}.i" for key in sensed if key in named and named[key].kind == "V"}
    net.coupled = set(names_coupled(elements))
    merge_shorts(elements, net)
    with net.found.gathered():
        net.initial = {net.node(name).lower(): given for name, given in values_at_begin(begin).items()}
        for card, value in net.initial.values():
            if value and not net.tran.uic:
                raise card.refuse("voltages at t = 0 without UIC in .tran", "UIC, or .nodeset", f"{value:g}")
    pairs = []
    for card in named.values():
        with net.found.gathered(), np.errstate(all="ignore"):
            if card.kind == "K":
                pairs += couplings(card)
            else:
                _take_one(card, net)
    add_coupled(pairs, net)


def _take_one(card: Card, net: Netlist) -> None:
    """Take an element into the netlist; refuse values out of the range of numbers."""
    try:
        take(card, net)
    except (ArithmeticError, np.linalg.LinAlgError) as error:
        raise card.refuse("its values are out of range", "moderate ones", str(error)) from None


def _add_unused_line(net: Netlist, path: str) -> None:
    """Add an unconnected line if the netlist has none, since a scene needs one."""
    if not net.tables["lines"]:
        net.found.note(path, "no line has an inductance; a scene needs a line, so one that joins nothing is added")
        net.tables["lines"]["unused"] = {"nodes": ["unused 1", "unused 2"], "z0": 50.0, "delay": net.tran.end}


def _probes(
    net: Netlist, shown: list[tuple[Card, str]], measured: list[str], dropped: set[str]
) -> dict[str, dict[str, Any]]:
    """Probes at the nodes that are asked for, or at all ends of lines; where lines meet, on the first of them."""
    ends: dict[str, str] = {}
    for name, line in net.tables["lines"].items():
        for node in line.get("nodes") or [*line["nodes1"], *line["nodes2"]]:
            ends.setdefault(node, name)
    known = net.degrees()
    nodes = []
    for card, name in shown:
        node = net.node(name)
        if node in known and node != REFERENCE:
            nodes.append(node)
        elif node == REFERENCE or node in dropped:
            net.found.note(card.where, f"v({name}) is skipped, for no waves reach that node")
        else:
            net.found.mistakes.append(card.refuse("no such node", nearest(name, sorted(known)), f"'{name:.40}'"))
    nodes = nodes or list(ends) or [node for node in known if node != REFERENCE and "." not in node]
    return {node: {"at": node} | ({"line": ends[node]} if node in ends else {}) for node in [*nodes, *measured]}


def _scene(table: dict[str, Any], net: Netlist) -> Scene:
    """Make the scene; errors name the line of the netlist from which they come."""
    try:
        return scene_from(table)
    except SceneError as error:
        raise SceneError([_traced(mistake, net) for mistake in error.mistakes]) from None


def _traced(mistake: InputError, net: Netlist) -> InputError:
    for (section, name), card in net.cards.items():
        inside = place(section, name)
        if mistake.where == inside or mistake.where.startswith((inside + ".", inside + "[")):
            rest = mistake.where[len(inside) :].lstrip(".")
            problem = f"{rest}: {mistake.problem}" if rest else mistake.problem
            return InputError(card.where, problem, mistake.expected, mistake.got)
    return mistake
