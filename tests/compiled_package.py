"""A package of compiled units in a folder of its own, made and edited by tests."""

import importlib
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from tline.compiled.structure import pack

ROOT = Path(__file__).parents[1]
HEAD = "from made.structures import Pair\nfrom tline.compiled.unit import function, unit\n\n"
FILES = {
    "constants": '"""Numbers."""\nFOUR = 4.0\nlater = 0\n',
    "shared": "from made.constants import (\n    FOUR,\n)\n\nWEIGHT = 10.0 * FOUR\n",
    "inner": 'from tline.compiled.unit import function\n\n@function\ndef grow(x):\n    """Larger."""\n    return 2.0 * x\n',  # noqa: E501
    "structures": """
from typing import NamedTuple
from tline.compiled.structure import Floats

class Pair(NamedTuple):
    x: float
    y: float
    law: int
    out: Floats
""",
    "called": HEAD + "@unit\ndef less(pair: Pair) -> int:\n    pair.out[0] -= 1.0\n    return 0\n",
    "unit": f"""
from math import exp, tanh
from made.inner import grow
from made.shared import WEIGHT
from tline.compiled.unit import invoke
{HEAD}
@unit
def answer(pair: Pair, n: int) -> int:
    pair.out[0] = WEIGHT * grow(pair.x - 1.0) + (pair.x - pair.y) + exp(-1e3 * pair.x) * tanh(pair.y)
    invoke(pair.law, (pair,))
    return n
""",
}
CALL = """
import sys
import numpy as np
from made.called import less
from made.structures import Pair
from made.unit import answer
from tline.compiled.structure import pack
out = np.zeros(1)
answer(pack(Pair(3.0, 1.0, less.address, out)), 1)
print(out[0].hex(), "numba" in sys.modules)
"""


class Package:
    """A package in a folder of its own, imported anew each time as a new process does."""

    def __init__(self, folder):
        self.folder, self.compiled = folder / "made", []
        self.folder.mkdir()
        for name, text in {"__init__": "", **FILES}.items():
            (self.folder / f"{name}.py").write_text(text)

    def edit(self, name, old, new):
        path = self.folder / f"{name}.py"
        assert old in path.read_text()
        path.write_text(path.read_text().replace(old, new))

    def load(self, name="unit"):
        importlib.invalidate_caches()
        for module in [each for each in sys.modules if each.partition(".")[0] == "made"]:
            del sys.modules[module]
        return importlib.import_module(f"made.{name}")

    def ask(self, made):
        """What a loaded unit says, and what was compiled for that."""
        out, called, structures = np.zeros(1), *map(importlib.import_module, ("made.called", "made.structures"))
        assert made.answer(pack(structures.Pair(x=3.0, y=1.0, law=called.less.address, out=out)), 7) == 7
        compiled, self.compiled[:] = [*self.compiled], []
        return out[0], compiled

    def answer(self):
        return self.ask(self.load())

    def kept(self):
        return sorted(path for path in self.folder.parent.glob("cache/**/*.*") if path.is_file())

    def process(self):
        """The answer of another process."""
        own = {"PYTHONPATH": f"{self.folder.parent}{os.pathsep}{ROOT}", "PYTHONDONTWRITEBYTECODE": "1"}
        folder = self.folder.parent
        own |= os.environ | own | {"NUMBA_CACHE_DIR": str(folder / "cache")}
        call, pipe = [sys.executable, "-c", (folder / "call").read_text()], subprocess.PIPE
        return subprocess.Popen(call, env=own, cwd=folder, stdout=pipe, stderr=pipe, text=True)
