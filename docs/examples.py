"""An example of each element and waveform for the scene reference, each read as part of a scene before it is shown."""

import runpy
import shutil
import tempfile
import tomllib
from pathlib import Path

from tline.scene.elements import ELEMENTS
from tline.scene.file import scene_from

LINES = {
    "hydraulic": {"pipe": {"nodes": ["near", "far"], "z0": 1e7, "delay": 1}},
    "electrical": {"cable": {"nodes": ["near", "far"], "z0": 50, "delay": 1}},
}
MEASURED = [Path(__file__).parents[1] / "scenes" / name for name in ("antenna.s1p", "filter.s2p", "memory.ibs")]
HYDRAULIC, ELECTRICAL = (
    runpy.run_path(str(Path(__file__).parent / f"examples_{medium}.py"))[medium.upper()] for medium in LINES
)


def _own(model: str) -> tuple[str, str]:
    """Medium and example of an element that has its own."""
    element, link = ELEMENTS[model.removesuffix("Link")], model.endswith("Link")
    stands = '[links.x]\nnodes = ["near", "far"]\n' if link else '[loads.x]\nat = "far"\n'
    return element.medium, stands + element.example


def example(model: str) -> str:
    """The example of a model, checked: read as part of a scene, without a mistake."""
    if model.removesuffix("Link") in ELEMENTS:
        medium, text = _own(model)
    else:
        medium, text = ("hydraulic", HYDRAULIC[model]) if model in HYDRAULIC else ("electrical", ELECTRICAL[model])
    scene = {
        "medium": medium,
        "t_end": "20 ns",
        "lines": LINES[medium],
        "probes": {at: {"at": at} for at in ("near", "far")},
    }
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "measured.csv").write_text("0, 0\n1e-9, 1\n", encoding="utf-8")
        for file in MEASURED:
            shutil.copy(file, folder)
        Path(folder, "cable.csv").write_text("0, 0.1, 2.5e-7\n1e6, 0.1, 2.5e-7\n1e9, 0.1, 2.5e-7\n", encoding="utf-8")
        scene_from(scene | tomllib.loads(text), folder)
    return text
