"""Whatever is given out shows itself as text, plain data and pictures, in a fresh notebook without a magic line."""

import base64
import importlib
import io
import json

import nbformat
import numpy as np
import pytest
from matplotlib.figure import Figure
from nbclient import NotebookClient
from PIL import Image

import tline as tl
from tline.presentation import SCREEN, Presentation, plain
from tline.signal.crosstalk import crosstalk

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


def drives_run():
    torque = tl.drives.Torque.step(0.1)
    return tl.drives.simulate(tl.drives.CoupledDrives(), torque, torque, t_end=2.0, step=0.01)


def identified():
    t = np.linspace(0.0, 10.0, 200)
    return tl.friction.identify(t, np.tanh(5 * np.sin(t)), velocity=np.sin(t), models=["coulomb"])


def sized():
    return tl.design.vessel(tl.examples["air_vessel"], at="vessel", lowest="2 bar", highest="7 bar")


def samples():
    f = np.linspace(0.0, 1.0, 9)
    return tl.passivity.SampledResponse(f, 1 / (1 + 2j * np.pi * f), "Z")


DRAWN = {
    "run of a scene": lambda: tl.simulate(tl.examples["cable_mismatch"]),
    "sweep": lambda: tl.sweep(tl.examples["cable_rc"], {"lines.cable.z0": "40 ohm:60 ohm:3"}),
    "grid of two": lambda: tl.sweep(
        tl.examples["cable_rc"], {"lines.cable.z0": [40, 50], "loads.receiver.resistance": [50, 100]}
    ),
    "sample": lambda: tl.sweep(tl.examples["cable_rc"], {"lines.cable.z0": "normal(50 ohm, 2 ohm)"}, sample="latin:9"),
    "operation": lambda: tl.operate(tl.examples["town"], close="ease@1s", t_end="3 s"),
    "size": sized,
    "reflections": lambda: tl.signal.reflectometry(tl.examples["coax_fault"], "near", "5 ns"),
    "eye": lambda: tl.signal.eye(tl.examples["tdr"], "far", "0.8 ns", "0.2 ns", "00101110"),
    "statistical eye": lambda: tl.signal.statistical_eye(
        tl.signal.pulse_response(tl.examples["tdr"], "far", "0.8 ns", "0.2 ns", tol=1e-3)
    ),
    "crosstalk": lambda: crosstalk(tl.examples["coupled_pair"]),
    "answer over frequency": lambda: tl.frequency.respond(tl.examples["cable_rlc"]),
    "S-parameters": lambda: tl.frequency.scattering_parameters(tl.examples["cable_rlc"], ["near", "far"]),
    "transfer function with delays": lambda: tl.frequency.DelaySystem(tl.examples["cable_rlc"], "far"),
    "load lines": lambda: tl.signal.bergeron(tl.examples["load_lines"]),
    "friction": lambda: tl.friction.simulate(tl.friction.Karnopp(), tl.friction.Testbench(tl.friction.Ramp(0.5))),
    "chatter": lambda: tl.friction.simulate(tl.friction.Coulomb(), tl.friction.Testbench(), 10.0, "euler", h=0.01),
    "prescribed": lambda: tl.friction.prescribe(tl.friction.Tanh(), velocity=tl.friction.Sine(1.0, 0.25)),
    "fit of friction": identified,
    "drives": drives_run,
    "design": lambda: tl.drives.design(tl.drives.CoupledDrives()),
    "transfer function": lambda: tl.drives.CoupledDrives().transfer("w1", "T1"),
    "verdict": lambda: tl.passivity.check_positive_real("(s+2)/(s^2+s+1)"),
    "samples": lambda: tl.passivity.check_samples(samples()),
    "nearest": lambda: tl.passivity.nearest(samples(), 1),
    "fit": lambda: tl.passivity.fit(samples(), 1),
    "exercise": lambda: tl.exercise("2a"),
}
TOLD = {
    "state space": lambda: tl.drives.CoupledDrives().state_space(),
    "sensitivities": lambda: tl.drives.sensitivities(tl.drives.design(tl.drives.CoupledDrives())),
    "pipe": lambda: tl.HydraulicLine(radius="10 cm", wave_speed=1500, density=980),
    "cable": lambda: tl.ElectricalLine(wave_speed=3e8, z0=300),
    "separation": lambda: tl.design.separation(tl.examples["column_separation"].with_changes(t_end="0.02 s")),
    "verdict of symbols": lambda: tl.passivity.is_positive_real("R + s*L", ["R > 0", "L > 0"]),
    "verdict of a line": lambda: tl.passivity.check_line("50 + s", z0=50, delay=1),
}


@pytest.mark.parametrize("make", (DRAWN | TOLD).values(), ids=DRAWN | TOLD)
def test_what_is_given_out_shows_itself(make):
    found = make()
    text = str(found)
    assert 1 <= len(text.splitlines()) <= SCREEN + 1 or isinstance(found, tl.Operation)  # which is printed whole
    assert json.loads(json.dumps(found.to_dict())) == found.to_dict()
    shown = found._repr_html_()
    assert shown.startswith("<pre>")
    if make in TOLD.values():
        return
    axes = Figure().subplots()
    assert found.plot(axes) is axes
    assert axes.has_data()
    assert found.plot().axes
    with pytest.raises(tl.InputError, match="ax: not matplotlib axes, expected Axes"):
        found.plot(3)  # pyright: ignore[reportArgumentType]
    assert 'src="data:image/png;base64,' in shown


def test_what_draws_or_lists_itself_does_so_as_all_do():
    for package in ("tline", "passivity", "friction", "drives", "tline.signal", "tline.frequency", "tline.design"):
        module = importlib.import_module(package)
        for name in module.__all__:
            found = getattr(module, name)
            if isinstance(found, type) and {"plot", "to_dict"} & {*dir(found)} and found is not tl.Scene:
                assert issubclass(found, Presentation), f"{package}.{name}"


def test_long_texts_are_cut_and_escaped():
    class Long(Presentation):
        def text_lines(self):
            return [f"a < {k}" for k in range(100)]

    assert str(Long()).splitlines()[-1] == "and 60 more lines"
    assert Long()._repr_html_().startswith("<pre>a &lt; 0\n")


def test_what_no_number_is_becomes_none():
    assert plain([float("nan"), 1j, range(2), {1: float("-inf")}]) == [None, [0.0, 1.0], [0, 1], {"1": None}]
