"""Whether runs to a tolerance keep what they tell: `python -m benchmarks.tolerance [SEEDS [FIRST]]`.

Random scenes of every kind, at three tolerances each, against far narrower slabs that are looked at where they end.
"""

import sys
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from kept import Kept, kept
from random_kinks import KINDS, random_kinks

from tline.errors import InputError

MEASURES = "inside", "over", "extreme"
TOLERANCES = 1e-3, 1e-5, 1e-7
FINER = 64  # times, that slabs are narrower in a second look at what seems to be outside: kinks blur the first one
FACTOR = 2  # times what was told, or asked and said to be met


def outside(found: Kept) -> bool:
    """Whether more is wrong than was told."""
    return found.inside > FACTOR or found.extreme > 1 or (found.met and found.over > FACTOR)


def main(seeds: int = 20, first: int = 0) -> None:
    """Try so many seeds from a first one on, and print what is found."""
    counts: Counter[str] = Counter()
    worst = dict.fromkeys(MEASURES, (0.0, ""))
    for seed in range(first, first + seeds):
        for kind in KINDS:
            for tol in TOLERANCES:
                case = f"seed {seed}, {kind}, {tol:.0e}"
                try:
                    found = kept(random_kinks(seed, kind), tol)
                    if outside(found):
                        again = kept(random_kinks(seed, kind), tol, FINER)
                        lower = {name: min(getattr(found, name), getattr(again, name)) for name in MEASURES}
                        found = found._replace(**lower)
                except InputError as error:
                    counts[f"refused: {error.problem}"] += 1
                    continue
                counts["pairs"] += 1
                counts["met"] += found.met
                counts["broken"] += outside(found)
                if outside(found):
                    print(f"{case}: {found}", flush=True)
                for name in worst:
                    value = getattr(found, name)
                    if name != "over" or found.met:
                        worst[name] = max(worst[name], (float(value), case))
    print(f"seeds {first} to {first + seeds - 1}:", ", ".join(f"{count} {what}" for what, count in counts.items()))
    print("largest error at any instant over what was told: {:.2f} ({})".format(*worst["inside"]))
    print("largest error at any instant over a tolerance said to be met: {:.2f} ({})".format(*worst["over"]))
    print("largest error of a printed extreme over its own ±: {:.2f} ({})".format(*worst["extreme"]))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
