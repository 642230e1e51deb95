"""The loads and links of a scene, and what active ones do to it."""

from typing import Any

from tline.cli.verdicts.answer import Answer, Asked
from tline.wording import place


def answer(file: str, asked: Asked) -> Answer:
    """Check every load and impedance of a scene; for active ones find how the scene's waves grow."""
    from tline.scene.file import read_scene
    from tline.scene.rational import AnyImpedance
    from tline.scene.touchstone import Touchstone
    from tline.solver.description.active import active_impedances, controlled_sources
    from tline.solver.description.description import describe
    from tline.solver.stability.growth import growth_sentence

    asked.refuse("scenes", "kind", "parameters", "z0", "delay", "within", "error", "nearest")
    scene = read_scene(file, confined=asked.confined)
    sources, active = controlled_sources(scene), active_impedances(scene)
    tested = {at: place(*at) for at, element in scene.placed if isinstance(element, AnyImpedance)}
    verdicts = {at: "refuted" if where in active else "proved" for at, where in tested.items()}
    told: dict[str, Any] = {
        "status": "refuted" if active or sources else "proved",
        "loads": {name: verdicts.get(("loads", name), "proved") for name in scene.loads},
        "links": {name: verdict for (part, name), verdict in verdicts.items() if part == "links"},
    }
    what = "loads and impedances between nodes" if told["links"] else "loads"
    lines = [f"all {what} positive real: {'refuted' if active else 'proved'}"]
    lines += [f"  {place('links', name)}: a controlled source, which may feed waves" for name in sources]
    measured = {name: load for name, load in scene.loads.items() if isinstance(load, Touchstone)}
    lines += [f"  {place('loads', name)}: proved, {load.model.why}" for name, load in measured.items()]
    rest = sum(("loads", name) not in tested and name not in measured for name in scene.loads)
    if rest:
        lines.append(f"  {rest} with nothing but R, L, C, reservoirs and switches, passive by construction")
    lines += [f"  {where}: {verdicts[at]}" for at, where in tested.items()]
    if active or sources:
        told["growth"] = growth_sentence(describe(scene))
        lines.append(f"  {told['growth']}")
    return Answer(told["status"], lines, told)
