"""Random scenes in which things move beside laws that kink: python -m benchmarks.events FROM TO [stores].

Against bounces; with `stores` beside vessels, tanks, cavities, pumps and regulating valves, against fixed orders.
Prints each seed that is more than three times as wrong as told while it says that its tolerance is met, each at which
two methods disagree, and how many of all say so. A thousand seeds take some ten minutes.
"""

import sys
import warnings
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

from random_events import ROUNDING, random_events
from random_stores import excess, random_stores

from tline.errors import InputError
from tline.solver.simulate import simulate

TOLERANCES, INSTANTS, SILENT = (1e-3, 1e-4, 1e-6), 120, 1e-8
ROUGHER = 1e-2, 1e-3, 1e-4


def most_wrong(seed: int) -> tuple[str, float]:
    """What a run says, and the largest error at any end over what it tells, or over the tolerance if that is less."""
    scene, tol = random_events(seed), TOLERANCES[seed % 3]
    result = simulate(scene.scene, tol=tol)
    assert result.accuracy is not None
    t = np.sort(np.random.default_rng(0).uniform(0, scene.t_end, INSTANTS))
    exact, worst = scene.exact(t), 0.0
    largest = max(np.abs(u).max() for u, _ in exact.values())
    for name, (u, y) in exact.items():
        seen, told, z0 = result.probes[name].at(t), result.accuracy.inside.get(name), result.probes[name].record.z0
        for found, true, error, size in zip(
            (seen.u, seen.y), (u, y), (told.u, told.y) if told else (tol, tol), (1, z0), strict=True
        ):
            amplitude = np.abs(true).max()
            if size * amplitude > SILENT * largest:
                off = np.abs(found - true).max() - ROUNDING[scene.joined is not None] * largest / size
                worst = max(worst, off / (min(error, tol) * amplitude))
    return "met" if result.accuracy.met else result.accuracy.limit, worst


def beside_stores(seed: int) -> tuple[str, float]:
    """The same where a run at a fixed order is the reference."""
    result = simulate(random_stores(seed), tol=ROUGHER[seed % 3])
    assert result.accuracy is not None
    return "met" if result.accuracy.met else result.accuracy.limit, excess(result)


def main(first: int, after: int, kind: str = "") -> None:
    warnings.simplefilter("ignore")
    counted: dict[str, int] = {"met": 0, "wrong": 0, "disagree": 0, "not met": 0, "ends": 0}
    for seed in range(first, after):
        try:
            said, worst = beside_stores(seed) if kind == "stores" else most_wrong(seed)
        except InputError as error:
            counted["ends"] += 1
            print(seed, error, flush=True)
            continue
        counted["met" if said == "met" else "disagree" if said.startswith("two methods") else "not met"] += 1
        if said == "met" and worst > 3:
            counted["wrong"] += 1
            print(seed, f"{worst:.2g} times what is told", flush=True)
        elif said.startswith("two methods"):
            print(seed, said, f"({worst:.2g} times what is told)", flush=True)
    print(f"seeds {first} to {after - 1}:", ", ".join(f"{word} {number}" for word, number in counted.items()))


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), *sys.argv[3:4])
