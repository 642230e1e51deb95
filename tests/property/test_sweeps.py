"""Any path of any scene may vary, and what a sweep keeps is what runs one by one give."""

from collections.abc import Iterator
from pathlib import Path
from random import Random

import numpy as np
import pytest

import tline as tl
from tline.scene.quantity import Quantity
from tline.solver.result.dense_output import extremes
from tline.words.wording import place

pytestmark = pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
SCENES = Path(__file__).parents[2] / "scenes"
ALL = sorted(path.stem for path in SCENES.glob("*.toml"))
# seconds each
SLOW = {"coax_fault", "column_separation", "lossy_cable", "lossy_pair", "stripline_eye", "tabulated_cable", "town"}
SECTIONS = "lines", "sources", "loads", "links"
TOL = 1e-3


def quantities(scene: tl.Scene) -> dict[str, float]:
    """All numbers of elements, waveforms and lists of parameters included, by path."""
    found = {"t_end": float(scene.t_end)}
    for section in SECTIONS:
        for name, element in getattr(scene, section).items():
            if (section, name) not in scene.parts and (section != "lines" or name not in scene.delay_lines):
                found |= dict(_numbers(element, element.table(), (section, name)))
    return found


def _numbers(element: object, table: dict, at: tuple[str, ...]) -> Iterator[tuple[str, float]]:
    for key, typed in table.items():
        value = getattr(element, key, getattr(element, f"{key}_", None))
        if isinstance(typed, dict):
            yield from _numbers(value, typed, (*at, key))
        elif isinstance(value, Quantity) and 0 < value < np.inf:
            yield place(*at, key), float(value)


def close(scene: tl.Scene, found: tl.Sweep, run: int, values: dict) -> None:
    """What was kept of a run is, within the tolerances of both, what a simulation of the changed scene gives."""
    alone = tl.simulate(scene.change(values), tol=TOL)
    assert alone.accuracy is not None
    for k, (name, probe) in enumerate(alone.probes.items()):
        (low, _), (high, _) = extremes(probe, "gauge_pressure")
        error = alone.accuracy.estimates[name].worst + alone.accuracy.blurred[name].worst + 2 * found["estimate"][run]
        bound = 2 * error * np.abs(probe.u).max() + 1e-12 * max(abs(low), abs(high))
        np.testing.assert_allclose([found["lowest"][run, k], found["highest"][run, k]], [low, high], rtol=0, atol=bound)


@pytest.mark.parametrize("name", ALL)
def test_any_path_may_vary(name):
    """A run for each of some paths, whose value is 2 % larger than in the scene; all others are those of the scene."""
    scene, rng = tl.read(SCENES / f"{name}.toml"), Random(name)
    if name in SLOW:
        scene = scene.change({"t_end": scene.t_end / 4})
    known = quantities(scene)
    assert len(known) > 1
    paths = rng.sample([*known], min(2, len(known)))
    vary = {path: [known[path] * (1.02 if path == other else 1.0) for other in paths] for path in paths}
    found = tl.sweep(scene, vary, sample="list", tol=None if name in SLOW else TOL, active=True)
    assert found.done.all()
    for sentence in found.errors.values():
        assert sentence.startswith(("lines", "sources", "loads", "links", "probes")), sentence
    run = int(rng.choice(found.good))
    if name not in SLOW:
        close(scene, found, run, {path: values[run] for path, values in vary.items()})


def test_instants_and_functions_are_those_of_results():
    scene = tl.read(SCENES / "valve_closure.toml")
    t = [0.5, 1.0, 5.5]

    def volume(result):
        return float(np.trapezoid(result.probes["valve"].y, result.t))

    found = tl.sweep(scene, {"loads.valve.kv": [100, 200]}, keep=[t, volume], tol=1e-6)
    for k, kv in enumerate((100, 200)):
        result = tl.simulate(scene.change({"loads.valve.kv": kv}), tol=1e-6)
        seen = result.probes["valve"].at(t)
        np.testing.assert_allclose(found["u"][k, 0], seen.u, rtol=0, atol=1e-5 * np.abs(seen.u).max())
        np.testing.assert_allclose(found["y"][k, 0], seen.y, rtol=0, atol=1e-5 * np.abs(seen.y).max())
        assert found["volume"][k] == pytest.approx(volume(result), rel=1e-2)  # a sum over slabs, whose widths differ
