"""Energy in random lumped circuits between lines: python -m benchmarks.circuits_energy --count 10000.

Random waves are left to themselves: for 40 slabs in each circuit, and in networks of lines with rows of laws between
them until they are 1e-13 of their start. With --write the table goes into docs/circuits.md.
"""

import argparse
import re
import sys
import time
from collections import Counter
from pathlib import Path

from tline.errors import InputError

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT / "tests"))

from circuit_energy import largest_growth  # noqa: E402
from random_chains import fade, random_chains  # noqa: E402
from random_circuits import random_circuit  # noqa: E402

PAGE, SLABS, EVERY = ROOT / "docs" / "circuits.md", 40, 1000


def of_circuit(seed: int) -> float:
    """Largest growth of the energy in one with linear elements and laws."""
    return largest_growth(random_circuit(seed, 1 + seed % 8), seed, SLABS)


def with_vessels(seed: int) -> float:
    """The same with vessels, tanks and vapour cavities."""
    return largest_growth(random_circuit(seed, 1 + seed % 8, vessels=True), seed, SLABS)


def of_chains(seed: int) -> float:
    """What is left of the waves in a network with rows of laws."""
    return fade(random_chains(seed, 1 + seed % 16), seed)


KINDS = {  # and how many of each, in shares of the count
    "linear elements and laws: largest growth of the energy in a slab": (of_circuit, 1.0),
    "with vessels, tanks and vapour: the same": (with_vessels, 0.05),
    "rows of laws: what is left of the waves, at most": (of_chains, 0.1),
}


def row(name: str, first: int, count: int) -> str:
    """A line of the table."""
    found, largest, started = Counter(), 0.0, time.perf_counter()
    for seed in range(first, first + count):
        try:
            largest = max(largest, KINDS[name][0](seed))
            found["run"] += 1
        except InputError as error:
            found["no flow" if "no flow" in str(error) or "grow" in str(error) else "refused"] += 1
            print(f"{seed}: {error}", flush=True)
        if (seed - first + 1) % EVERY == 0:
            print(
                f"{seed - first + 1} in {time.perf_counter() - started:.0f} s: {dict(found)}, {largest:.1e}", flush=True
            )
    return f"| {name} | {found['run']} | {found['refused']} | {found['no flow']} | {largest:.0e} |"


HEAD = """| random circuits | run | refused | without a flow | |
|---|---:|---:|---:|---:|"""

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--write", action="store_true", help="into docs/circuits.md")
    given = parser.parse_args()
    rows = [HEAD]
    for name in KINDS:
        rows.append(row(name, given.first, max(int(given.count * KINDS[name][1]), 1)))
        print(rows[-1], flush=True)
    if given.write:
        page = PAGE.read_text(encoding="utf-8")
        table = "\n".join(rows)
        page = re.sub(r"(<!-- energy -->\n).*?(\n<!-- end of energy -->)", rf"\g<1>{table}\g<2>", page, flags=re.DOTALL)
        PAGE.write_text(page, encoding="utf-8")
