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

from tline.errors import InputError, NoFlowError

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT / "tests"))

from circuit_energy import largest_growth  # noqa: E402
from random_chains import fade, random_chains  # noqa: E402
from random_circuits import random_circuit  # noqa: E402

PAGE, SLABS, EVERY = ROOT / "docs" / "circuits.md", 40, 1000
DIVIDED = {1: "run", 4: "in 4", 16: "in 16"}  # parts of the slab


def growth(table: dict, seed: int) -> float:
    """Largest growth of the energy in a slab."""
    return largest_growth(table, seed, SLABS)


KINDS = {  # circuits, what is measured, and how many, in shares of the count
    "linear elements and laws: largest growth of the energy in a slab": (
        lambda seed: random_circuit(seed, 1 + seed % 8),
        growth,
        1.0,
    ),
    "with vessels, tanks and vapour: the same": (
        lambda seed: random_circuit(seed, 1 + seed % 8, vessels=True),
        growth,
        0.05,
    ),
    "rows of laws: what is left of the waves, at most": (lambda seed: random_chains(seed, 1 + seed % 16), fade, 0.1),
}


def measured(name: str, seed: int) -> tuple[str, float]:
    """What became of a circuit, whose slab is divided where no flow is found, as runs do it; and what is measured."""
    make, measure, _ = KINDS[name]
    for parts, told in DIVIDED.items():
        table = make(seed)
        table["solver"]["slab"] /= parts
        try:
            return told, measure(table, seed)
        except NoFlowError as error:
            print(f"{seed}, slab in {parts}: {error}", flush=True)
        except InputError as error:
            print(f"{seed}: {error}", flush=True)
            return "refused", 0.0
    return "no flow", 0.0


def row(name: str, first: int, count: int) -> str:
    """A line of the table."""
    found, largest, started = Counter(), 0.0, time.perf_counter()
    for seed in range(first, first + count):
        told, value = measured(name, seed)
        found[told] += 1
        largest = max(largest, value)
        if (seed - first + 1) % EVERY == 0:
            print(
                f"{seed - first + 1} in {time.perf_counter() - started:.0f} s: {dict(found)}, {largest:.1e}", flush=True
            )
    counts = " | ".join(f"{found[told]}" for told in (*DIVIDED.values(), "refused", "no flow"))
    return f"| {name} | {counts} | {largest:.0e} |"


HEAD = """| random circuits | run | slab in 4 | in 16 | refused | without a flow | |
|---|---:|---:|---:|---:|---:|---:|"""

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--write", action="store_true", help="into docs/circuits.md")
    given = parser.parse_args()
    rows = [HEAD]
    for name in KINDS:
        rows.append(row(name, given.first, max(int(given.count * KINDS[name][2]), 1)))
        print(rows[-1], flush=True)
    if given.write:
        page = PAGE.read_text(encoding="utf-8")
        table = "\n".join(rows)
        page = re.sub(r"(<!-- energy -->\n).*?(\n<!-- end of energy -->)", rf"\g<1>{table}\g<2>", page, flags=re.DOTALL)
        PAGE.write_text(page, encoding="utf-8")
