"""The loads and links of a scene, the circuits that they make, and what active ones do to it."""

from typing import TYPE_CHECKING, Any

from tline.cli.verdicts.answer import Answer, Asked
from tline.cli.verdicts.expression import written
from tline.words.wording import place

if TYPE_CHECKING:
    from tline.solver.description.passive import CircuitVerdict

MOST_NODES = 6  # that are named of a circuit


def answer(file: str, asked: Asked) -> Answer:
    """Check every load, impedance and circuit of a scene; for active ones find how the scene's waves grow."""
    from passivity import is_positive_real
    from tline.interchange.any_file import read as read_any
    from tline.scene.rational import Impedance
    from tline.scene.touchstone import Touchstone
    from tline.solver.description.description import describe
    from tline.solver.description.passive import (
        active_impedances,
        controlled_sources,
        laws_not_through_the_origin,
        passive_circuits,
    )
    from tline.solver.description.power import taken_power
    from tline.solver.stability.growth import growth_sentence

    asked.refuse("scenes", "kind", "parameters", "z0", "delay", "within", "error", "nearest")
    scene = read_any(file, confined=asked.confined)
    sources, active = controlled_sources(scene), active_impedances(scene)
    tested = {at: place(*at) for at, element in scene.placed if isinstance(element, Impedance)}
    verdicts = {at: "refuted" if where in active else "proved" for at, where in tested.items()}
    suspect = {*active, *(place("links", name) for name in sources)}
    circuits = passive_circuits(scene, suspect)
    whole = is_positive_real(taken_power(scene, circuits))
    told: dict[str, Any] = {
        "status": whole.status.value,
        "statement": whole.statement,
        "proof": whole.proof,
        "loads": {name: verdicts.get(("loads", name), "proved") for name in scene.loads},
        "links": {name: verdict for (part, name), verdict in verdicts.items() if part == "links"},
    }
    told["circuits"] = [_told(circuit) for circuit in circuits]
    told["laws"] = laws_not_through_the_origin(scene)
    what = "loads and impedances between nodes" if told["links"] else "loads"
    lines = [f"all {what} positive real: {'refuted' if active else 'proved'}"]
    lines += [f"  {place('links', name)}: a controlled source, which may feed waves" for name in sources]
    measured = {name: load for name, load in scene.loads.items() if isinstance(load, Touchstone)}
    lines += [f"  {place('loads', name)}: proved, {load.model.why}" for name, load in measured.items()]
    laws = scene.laws
    rest = sum(("loads", name) not in {*tested, *laws} and name not in measured for name in scene.loads)
    if rest:
        lines.append(f"  {rest} with nothing but R, L, C, reservoirs and switches, passive by construction")
    lines += [f"  {where}: {verdicts[at]}" for at, where in tested.items()]
    lines += [f"  {where}: {sentence}" for where, sentence in told["laws"].items()]
    if through := len(laws) - len(told["laws"]):
        lines.append(f"  {through} that rise through the origin, or store, passive by construction")
    for circuit in circuits:
        lines += [f"  {_named(circuit)}: {circuit.status.value}", f"    because {circuit.why}"]
    if active or sources:
        told["growth"] = growth_sentence(describe(scene))
        lines.append(f"  {told['growth']}")
    if whole.proof:
        lines.append(f"{whole.statement}: proved in {len(whole.proof['steps'])} steps")
    return Answer(told["status"], lines + written(whole, asked), told)


def _told(circuit: "CircuitVerdict") -> dict[str, Any]:
    told = {"nodes": circuit.nodes, "status": circuit.status.value, "why": circuit.why, "ports": circuit.ports}
    if circuit.scattering is None:
        return told
    rows = [[str(entry) for entry in row] for row in circuit.scattering.rows]
    return told | {"z0": str(circuit.z0), "scattering": rows}


def _named(circuit: "CircuitVerdict") -> str:
    more = len(circuit.nodes) - MOST_NODES
    nodes = ", ".join(map(repr, circuit.nodes[:MOST_NODES])) + (f" and {more} more" if more > 0 else "")
    ports = f", {len(circuit.ports)} port{'s' * (len(circuit.ports) > 1)}" if circuit.scattering else ""
    return f"circuit at node{'s' * (len(circuit.nodes) > 1)} {nodes}{ports}"
