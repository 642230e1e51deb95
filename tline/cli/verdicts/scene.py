"""The loads of a scene, and what active ones do to it."""

from typing import Any

from tline.cli.verdicts.answer import Answer, Asked
from tline.wording import place


def answer(file: str, asked: Asked) -> Answer:
    """Check every load of a scene; for active ones find how the scene's waves grow."""
    from tline.scene.file import read_scene
    from tline.scene.rational_load import Impedance
    from tline.scene.touchstone import Touchstone
    from tline.solver.description.active import active_loads, controlled_sources
    from tline.solver.description.description import describe
    from tline.solver.stability.growth import growth_sentence

    asked.refuse("scenes", "kind", "parameters", "z0", "delay", "within", "error", "nearest")
    scene = read_scene(file, confined=asked.confined)
    sources = controlled_sources(scene)
    active = active_loads(scene)
    tested = [name for name, load in scene.loads.items() if isinstance(load, Impedance)]
    told: dict[str, Any] = {
        "status": "refuted" if active or sources else "proved",
        "loads": {name: "refuted" if name in active else "proved" for name in scene.loads},
    }
    lines = [f"all loads positive real: {'refuted' if active else 'proved'}"]
    lines += [f"  {place('links', name)}: a controlled source, which may feed waves" for name in sources]
    measured = {name: load for name, load in scene.loads.items() if isinstance(load, Touchstone)}
    lines += [f"  {place('loads', name)}: proved, {load.model.why}" for name, load in measured.items()]
    rest = len(scene.loads) - len(tested) - len(measured)
    if rest:
        lines.append(f"  {rest} with nothing but R, L, C, reservoirs and switches, passive by construction")
    lines += [f"  {place('loads', name)}: {'refuted' if name in active else 'proved'}" for name in tested]
    if active or sources:
        told["growth"] = growth_sentence(describe(scene))
        lines.append(f"  {told['growth']}")
    return Answer(told["status"], lines, told)
