"""Decks of other programs, imported, beside ngspice.

The decks have the structure of the examples for transmission lines of ngspice, Xyce and gnucap that have no
transistors. TXL lines of ngspice, whose error no step lessens, are LTRA lines there; of its CPL lines, which are made
alike, there is no other kind.
"""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tline.solver.result.result import Result
from tline.study.programs import ngspice

DECKS, INSTANTS = Path(__file__).parent / "decks", 2000
DIALECT = ((r"(?m)^#.*$", ""), (r"(?is)\n\.modify.*", ""), (r"\bz=", "z0="), (r"(?is)\.control.*?\.endc", ""),
           (r"(?im)^y(.*)$", r"oy\1"), (r"(?im)^(\.model\s+\w+\s+)txl(.*?)length", r"\1ltra rel=1 \2len"),
           (r"(?im)^\.(tran?|print|plot|measure|list|width|step|stat|options?|end)\b.*(\n\+.*)*$", ""))  # fmt: skip


def in_ngspice(deck: Path, ours: Result, steps: int) -> dict[str, NDArray]:
    """Waves of a deck, with so many steps at least."""
    title, *lines = deck.read_text(encoding="latin-1").splitlines()
    text = "\n" + "\n".join(lines) + "\n"
    for pattern, new in DIALECT:
        text = re.sub(pattern, new, text)
    end = float(ours.scene.t_end)
    saved = ".save " + " ".join(f"v({probe})" for probe in ours.probes)
    options = ".options acct reltol=1e-5 abstol=1e-14 vntol=1e-8 gmin=1e-15"
    run = f".tran {end / steps!r} {end!r} 0 {end / steps!r}"
    return ngspice.transient("\n".join(["* " + title, text, options, saved, run, ".end", ""]))[0]


def distance(ours: Result, theirs: dict[str, NDArray]) -> float:
    """Largest difference of a probe, relative to the largest voltage."""
    t = theirs["time"]
    chosen = np.unique(np.linspace(1, len(t) - 2, INSTANTS).astype(int))
    amplitude = max(float(np.abs(probe.u).max()) for probe in ours.probes.values())
    return max(
        float(np.abs(theirs[f"v({key.lower()})"][chosen] - probe.at(t[chosen]).u).max()) / amplitude
        for key, probe in ours.probes.items()
    )


def change(finer: dict[str, NDArray], coarser: dict[str, NDArray]) -> float:
    """Largest difference of two runs, relative to the largest voltage."""
    waves = [key for key in finer if key.startswith("v(")]
    amplitude = max(float(np.abs(finer[key]).max()) for key in waves)
    at = coarser["time"]
    moved = [np.abs(np.interp(at, finer["time"], finer[key]) - coarser[key]).max() for key in waves]
    return float(max(moved)) / amplitude
