"""What is left of a netlist for a scene: parts that waves reach, sources with their resistances, open ends."""

from tline.interchange.netlist import REFERENCE, Netlist


def connected(net: Netlist) -> set[str]:
    """Drop what no line reaches, such as a supply of transistors that are not there; the nodes that go with it."""
    neighbours: dict[str, set[str]] = {}
    for _, _, nodes in net.terminals():
        own = [node for node in nodes if node != REFERENCE]
        for node in own:
            neighbours.setdefault(node, set()).update(own)
    reached: set[str] = set()
    waiting = [node for section, _, nodes in net.terminals() if section == "lines" for node in nodes]
    while waiting:
        node = waiting.pop()
        if node not in reached:
            reached.add(node)
            waiting += neighbours.get(node, ())
    for section, name, nodes in list(net.terminals()):
        if not reached.intersection(nodes) and REFERENCE not in nodes[:1]:
            del net.tables[section][name]
            net.found.note(net.cards[section, name].where, "skipped, for it is connected to no line")
    return neighbours.keys() - reached


def without_idle_capacitors(net: Netlist) -> None:
    """Drop capacitors beside ideal voltages against the reference: no voltage depends on them."""
    ideal = [s for s in net.tables["sources"].values() if s["kind"] == "voltage" and "resistance" not in s]
    held = {source.get("at") for source in ideal}
    for name, load in list(net.tables["loads"].items()):
        if load["at"] in held and load["kind"] == "capacitor":
            del net.tables["loads"][name]
            net.found.note(net.cards["loads", name].where, "skipped, for it stands beside an ideal voltage")


def folded(net: Netlist, probed: set[str]) -> None:
    """Let a resistor behind a source of voltage, where nothing else is, be the source's resistance."""
    degrees = net.degrees()
    links = {node: name for name, link in net.tables["links"].items() for node in link["nodes"]}
    for table in net.tables["sources"].values():
        first = table.get("at") or table["nodes"][0]
        name = links.get(first, "")
        link = net.tables["links"].get(name, {})
        if degrees[first] != 2 or first in probed or link.get("kind") != "resistor" or table["kind"] != "voltage":
            continue
        one, other = link["nodes"]
        beyond = other if one == first else one
        if beyond in table.get("nodes", ()):
            continue
        if "at" in table:
            table["at"] = beyond
        else:
            table["nodes"] = [beyond, table["nodes"][1]]
        table["resistance"] = table.get("resistance", 0.0) + link["resistance"]
        del net.tables["links"][name]


def with_open_ends(net: Netlist) -> None:
    """Let ends of links and sources at which nothing else is be open."""
    ends = {node for section, _, nodes in net.terminals() if section == "lines" for node in nodes}
    degrees = net.degrees()
    for section, name, nodes in list(net.terminals()):
        for node in nodes if section in ("links", "sources") else ():
            if degrees[node] == 1 and node not in ends:
                net.add("loads", net.cards[section, name], {"at": node, "kind": "open"}, f"{node} (open)")
