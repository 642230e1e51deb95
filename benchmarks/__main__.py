"""All pages of measurements, one benchmark after the other: ``python -m benchmarks [NAME…]``; hours if all of them."""

import sys

from benchmarks.harness import ROOT, spent

PAGES = (
    "time_to_answer",
    "cheapest_grid",
    "sweeps",
    "networks",
    "circuits",
    "channels",
    "passivity",
    "systems",
    "friction",
    "mutants",
)

if __name__ == "__main__":
    for name in sys.argv[1:] or PAGES:
        print(spent([sys.executable, "-W", "ignore", "-m", f"benchmarks.{name}"], limit=36_000).said, flush=True)
    print(f"written below {ROOT / 'docs'}")
