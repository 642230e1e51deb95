"""Whether tolerances hold wherever a user looks: `python -m benchmarks.whole_curve [SEEDS [FIRST [KIND,…]]]`.

Random scenes of every kind in `tests/curve_cases.py`, each at tolerances from 1e-3 to 1e-10, at random instants and at
the printed extremes, against solutions from outside the solver. Runs that take long end the row of their scene.
"""

import sys
from collections import Counter
from pathlib import Path
from time import perf_counter

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from curve_cases import FACTOR, LOSSLESS, LOSSY, Found, found

from tline.errors import InputError

TOLERANCES = [10.0**-k for k in range(3, 11)]
LONG = 60.0  # s
MEASURES = {
    "over": "largest error over a tolerance said to be met",
    "beyond": "largest error over what was told",
    "extreme": "largest error of a printed extreme over its own ±",
}


def main(seeds: int = 5, first: int = 0, *, kinds: str = "") -> None:
    """Try so many seeds of each kind from a first one on, and print what is found."""
    counts: Counter[str] = Counter()
    worst = dict.fromkeys(MEASURES, (0.0, ""))
    for name, make in (LOSSLESS | LOSSY).items():
        if kinds and name not in kinds.split(","):
            continue
        for seed in range(first, first + seeds):
            case = make(np.random.default_rng([seed, sum(map(ord, name))]))
            for tol in TOLERANCES:
                begin, which = perf_counter(), f"{name}, seed {seed}, {tol:.0e}"
                try:
                    seen = found(case, tol, seed)
                except InputError as error:
                    counts[f"refused: {error.problem}"] += 1
                    continue
                counts.update({"pairs": 1, "met": int(seen.met), f"beyond {FACTOR:g}": int(seen.outside)})
                if seen.outside:
                    print(f"{which}: {seen}", flush=True)
                worst = {key: _larger(worst[key], seen, key, which) for key in worst}
                if perf_counter() - begin > LONG:
                    break
    print(", ".join(f"{count} {what}" for what, count in counts.items()))
    for key, text in MEASURES.items():
        print("{}: {:.2f} ({})".format(text, *worst[key]))


def _larger(worst: tuple[float, str], seen: Found, key: str, which: str) -> tuple[float, str]:
    value = float(getattr(seen, key))
    return max(worst, (value, which)) if seen.met else worst


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]), kinds="".join(sys.argv[3:4]))
