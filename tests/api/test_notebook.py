"""A fresh notebook: one import, no magic line, and every picture is there as a PNG."""

import base64
import io

import nbformat
import pytest
from nbclient import NotebookClient
from PIL import Image

CELLS = [
    """\
import tline as tl
scene = tl.examples["cable_rc"]
scene""",
    """\
result = tl.simulate(scene)
result.plot()""",
    "result.plot_waves(line='cable')",
    """\
prepared = tl.prepare(scene)
tl.plot({c: prepared.run({"loads.receiver.capacitance": c}) for c in ("2 pF", "4 pF", "8 pF")}, probes=["far"])""",
    """\
swept = tl.sweep(scene, {"lines.cable.z0": "normal(50 ohm, 2 ohm)"}, sample="latin:100")
swept.plot()""",
    "result",
]


@pytest.fixture(scope="module")
def outputs():
    """What each cell shows, by kind of content."""
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in CELLS])
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    notebook.metadata["kernelspec"] = kernel
    done = NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
    return [cell.outputs for cell in done.cells]


def test_it_is_short():
    lines = "\n".join(CELLS).splitlines()
    assert len(lines) <= 12
    assert sum("import" in line for line in lines) == 1


def test_the_scene_is_drawn(outputs):
    (shown,) = outputs[0]
    html = shown.data["text/html"]
    assert picture(html.split("base64,")[1].split('"')[0]).size[0] > 600


@pytest.mark.parametrize("cell", [1, 2, 3, 4])
def test_figures_appear_as_png(cell, outputs):
    (shown,) = outputs[cell]
    seen = picture(shown.data["image/png"])
    assert seen.size[0] > 1000
    assert len(seen.convert("RGB").getcolors(1 << 24)) > 50  # something is drawn
    assert "<Figure" not in shown.data.get("text/html", "")


def test_a_result_is_a_screen_of_text(outputs):
    (shown,) = outputs[5]
    text = shown.data["text/plain"]
    assert "1e-06 asked and met" in text
    assert len(text.splitlines()) < 25


def picture(text):
    return Image.open(io.BytesIO(base64.b64decode(text)))
