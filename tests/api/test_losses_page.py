"""The table in docs/losses.md is the one that its generator makes."""

import re
import runpy
from pathlib import Path

from tline.loss import realise

ROOT = Path(__file__).parents[2]


def test_the_numbers_of_terms_shown_for_1e_4_are_those_found():
    page = (ROOT / "docs" / "losses.md").read_text(encoding="utf-8")
    cases = runpy.run_path(str(ROOT / "docs" / "generate_losses.py"))["CASES"]
    for name, (law, _, low) in cases.items():
        (shown,) = re.findall(rf"^\| {re.escape(name)} \| [^|]+ \| (\d+) /", page, re.MULTILINE)
        assert len(realise(law, (low, 1e5 * low), 1e-4).circuit.rates) == int(shown), name
