"""Examples of all elements and waveforms for the scene reference, each read as part of a scene before it is shown."""

import re
import shutil
import tempfile
import tomllib
from pathlib import Path

from tline.scene.element import Between
from tline.scene.elements import ELEMENTS
from tline.scene.file import scene_from

LINES = {
    "hydraulic": {"pipe": {"nodes": ["near", "far"], "z0": 1e7, "delay": 1}},
    "electrical": {"cable": {"nodes": ["near", "far"], "z0": 50, "delay": 1}},
}
LOAD, LINK = '[loads.x]\nat = "far"', '[links.x]\nnodes = ["near", "far"]'
MEASURED = [Path(__file__).parents[1] / "scenes" / name for name in ("antenna.s1p", "filter.s2p", "memory.ibs")]
SWITCH = "[IBIS Ver] 5.0\n[Model] CROSSBAR\nModel_type Series_switch\n[On]\n[R Series] 5\n[Off]\n[R Series] 1M\n"
EXAMPLES = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))


def example(model: str) -> str:
    """Return the example of a model, checked: read as part of a scene, without a mistake."""
    texts = {name: (medium, text) for medium, known in EXAMPLES.items() for name, text in known.items()}
    between = {name for name, own in ELEMENTS.items() if issubclass(own, Between)}
    heads = {name: LINK if name in between else LOAD for name in ELEMENTS}
    texts |= {name: (own.medium, f"{heads[name]}\n{own.example}") for name, own in ELEMENTS.items()}
    medium, text = texts[model if model in texts else model.removesuffix("Link")]
    if model not in texts:
        text = re.sub(r"\[loads\.\w+\].*\nat = .*", LINK, text, count=1)
    scene = {
        "medium": medium,
        "t_end": "20 ns",
        "lines": LINES[medium],
        "probes": {at: {"at": at} for at in ("near", "far")},
    }
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "measured.csv").write_text("0, 0\n1e-9, 1\n", encoding="utf-8")
        Path(folder, "switch.ibs").write_text(SWITCH, encoding="utf-8")
        for file in MEASURED:
            shutil.copy(file, folder)
        Path(folder, "cable.csv").write_text("0, 0.1, 2.5e-7\n1e6, 0.1, 2.5e-7\n1e9, 0.1, 2.5e-7\n", encoding="utf-8")
        scene_from(scene | tomllib.loads(text), folder)
    return text
