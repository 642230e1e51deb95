"""Compiled code that is kept on disk is never stale, is used while it may be, and never in the way."""

import ast
import importlib
import os
import pickle
import subprocess
import sys
import warnings
from importlib.machinery import ModuleSpec
from pathlib import Path
from zipfile import ZipFile

import numba
import pytest
from numba.core import caching, config

from tline import compiled
from tline.errors import NotKeptWarning
from tline.sources import are_unchanged, digests, sources_of

ROOT = Path(__file__).parents[2]
FILES = {
    "constants": '"""Numbers."""\nFOUR = 4.0\nlater = 0\n',
    "shared": "from made.constants import (\n    FOUR,\n)\n\nWEIGHT = 10.0 * FOUR\n",
    "inlined": """
from tline.compiled import njit

@njit(inline="always")
def grow(x):
    \"\"\"Larger.\"\"\"
    return 2.0 * x
""",
    "linked": """
from tline.compiled import njit

@njit(no_cpython_wrapper=True)
def less(x):
    return x - 1.0
""",
    "address": """
from numba import types
from numba.extending import intrinsic

@intrinsic
def difference(_, one, other):
    def call(context, builder, _, values):
        return builder.fsub(values[0], values[1])
    return types.float64(types.float64, types.float64), call
""",
    "unit": """
import sys
from made import address as by_address
from made.inlined import grow
from made.linked import less
from made.shared import WEIGHT
from tline.compiled import njit

difference = by_address.difference

@njit(error_model="numpy")
def answer(pair):
    return WEIGHT * grow(less(pair.x)) + difference(pair.x, pair.y)
""",
    "tuples": "from typing import NamedTuple\n\nclass Pair(NamedTuple):\n    x: float\n    y: float\n",
}
EDITS = [  # file, what is edited, and the answer to x = 3, y = 1 then; it is 162 before
    ("constants", "4.0", "5.0", 202.0),
    ("shared", "10.0 * FOUR", "10.5 - FOUR", 28.0),
    ("inlined", "2.0 * x", "3.0 * x", 242.0),
    ("linked", "x - 1.0", "x - 0.0", 242.0),
    ("address", "values[0], values[1]", "values[1], values[0]", 158.0),
    ("unit", "WEIGHT * grow", "0.5 * grow", 4.0),
    ("tuples", "    x: float\n    y: float\n", "    y: float\n    x: float\n", 162.0),
]


class Package:
    """A package in a folder of its own, imported anew each time as a new process does."""

    def __init__(self, folder):
        self.folder = folder / "made"
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

    def answer(self):
        """What the unit says, and whether it compiled for that."""
        unit = self.load()
        value = unit.answer(importlib.import_module("made.tuples").Pair(x=3.0, y=1.0))
        return value, bool(sum(unit.answer.stats.cache_misses.values()))

    def kept(self):
        return sorted(self.folder.parent.glob("cache/**/*.*"))


@pytest.fixture
def package(tmp_path, monkeypatch):
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # which Python itself may believe for as long as a second
    monkeypatch.setattr(compiled, "_said", set())
    monkeypatch.syspath_prepend(str(tmp_path))
    return Package(tmp_path)


def test_an_edit_of_any_file_that_code_is_made_of_is_seen(package):
    """And edited back, the old answer comes again."""
    assert package.answer() == (162.0, True)
    for name, old, new, then in EDITS:
        assert package.answer()[0] == 162.0
        package.edit(name, old, new)
        assert package.answer() == (then, True), name
        package.edit(name, new, old)
    package.answer()
    assert package.answer() == (162.0, False)


def test_what_means_the_same_is_not_compiled_again(package):
    package.answer()
    kept = package.kept()
    package.edit("constants", '"""Numbers."""', '"""Numbers that\n\nfrom elsewhere import more of them."""')
    package.edit("inlined", '"""Larger."""', "# larger")
    package.edit("linked", "x - 1.0", "(x  # all of it\n            - 1.0)")
    package.edit("unit", "\n@njit", "\n\n\n@njit")
    os.utime(package.folder / "address.py", (1.0, 1.0))
    assert package.answer() == (162.0, False)
    assert package.kept() == kept


def test_files_that_are_not_imported_do_not_count(package):
    package.answer()
    (package.folder / "other.py").write_text("from made import unit\n")
    package.edit("__init__", "", "from made import other\n")
    assert package.answer() == (162.0, False)


def test_what_is_loaded_counts_and_not_what_an_upgrade_writes_meanwhile(package):
    """A process goes on with the constant it has loaded; what it compiles is not taken for the new one's."""
    unit = package.load()
    package.edit("constants", "4.0", "5.0")
    pair = importlib.import_module("made.tuples").Pair
    assert unit.answer(pair(x=3.0, y=1.0)) == 162.0
    assert package.answer() == (202.0, True)


def test_the_folder_does_not_grow(package):
    package.answer()
    kept = package.kept()
    for _ in range(3):
        package.edit("constants", "later = ", "later = 1")
        package.edit("unit", "\n@njit", "\n\n@njit")
        assert package.answer()[1]
    assert package.kept() == kept
    package.edit("unit", "return WEIGHT", "return 1 * WEIGHT")  # of the old signature nothing is left
    package.edit("tuples", "    y: float\n", "    y: int\n")
    package.load().answer(importlib.import_module("made.tuples").Pair(x=3.0, y=1))
    assert len([path for path in package.kept() if "answer" in path.name]) == 1


@pytest.mark.parametrize("part", ["numba", "llvmlite"])
def test_another_version_of_the_compiler_compiles_anew(package, monkeypatch, part):
    package.answer()
    monkeypatch.setattr(compiled, "VERSIONS", compiled.VERSIONS.replace(part.encode(), b"another " + part.encode()))
    assert package.answer() == (162.0, True)


@pytest.mark.parametrize(("setting", "value"), [("CPU_NAME", "generic"), ("BOUNDSCHECK", 1)])
def test_other_processors_and_settings_have_code_of_their_own(package, monkeypatch, setting, value):
    package.answer()
    with monkeypatch.context() as patch:
        patch.setattr(config, setting, value)
        if setting == "CPU_NAME":
            patch.setattr("numba.core.codegen.JITCPUCodegen._get_host_cpu_name", lambda self: value)
        assert package.answer() == (162.0, True)
        assert package.answer() == (162.0, False)
    assert package.answer() == (162.0, False)


def test_broken_files_are_compiled_anew(package):
    package.answer()
    for cut in (0, 20, 300, -1):
        for path in package.kept():
            path.write_bytes(path.read_bytes()[:cut])
        assert package.answer() == (162.0, True)
    for path in package.kept():
        content = bytearray(path.read_bytes())
        content[-100] ^= 1
        path.write_bytes(content)
    assert package.answer() == (162.0, True)
    assert package.answer() == (162.0, False)


def test_what_names_a_class_that_is_gone_is_compiled_anew(package):
    package.answer()
    package.edit("tuples", "class Pair", "class Duo")
    package.edit("tuples", "    y: float\n", "    y: float\n\nPair = Duo\n")
    assert package.answer() == (162.0, True)


def nowhere(monkeypatch, package):
    """Leave no folder to write in: a regular file stands wherever one would be made (root may write anywhere else)."""
    blocked = package.folder.parent / "blocked"
    blocked.write_text("a file")
    (package.folder / "__pycache__").write_text("a file")
    monkeypatch.setattr(config, "CACHE_DIR", str(blocked / "numba"))
    monkeypatch.setenv("HOME", str(blocked))
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked / "cache"))


def test_without_a_folder_to_write_in_it_runs_and_says_so_once(package, monkeypatch):
    nowhere(monkeypatch, package)
    with pytest.raises(RuntimeError, match="no locator available"):  # what numba's own cache does here
        caching.FunctionCache(package.load("linked").less.py_func)
    with pytest.warns(NotKeptWarning, match="no folder for it can be written, expected NUMBA_CACHE_DIR to") as said:
        assert [package.answer(), package.answer()] == [(162.0, True)] * 2
    assert len(said) == 1
    assert package.kept() == []


def test_a_folder_that_vanishes_is_made_again(package):
    package.answer()
    unit = package.load()
    for path in package.kept():
        path.unlink()
    (package.folder.parent / "cache").rename(package.folder.parent / "gone")
    assert unit.answer(importlib.import_module("made.tuples").Pair(x=3.0, y=1.0)) == 162.0
    assert package.answer() == (162.0, False)


def test_a_full_disk_is_no_error(package):
    """Files may not grow beyond 1000 bytes in that process."""
    code = (
        "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000));"
        "from made.unit import answer; from made.tuples import Pair; print(answer(Pair(3.0, 1.0)))"
    )
    done = process(package, code)
    assert done.stdout == "162.0\n"
    assert done.stderr.count("NotKeptWarning") == 1
    assert "file too large" in done.stderr
    assert [path for path in package.kept() if path.is_file()] == []


def process(package, code, wait=True):
    environment = os.environ | {
        "PYTHONPATH": f"{package.folder.parent}{os.pathsep}{ROOT}",
        "NUMBA_CACHE_DIR": str(package.folder.parent / "cache"),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    started = subprocess.Popen(
        [sys.executable, "-c", code],
        env=environment,
        cwd=package.folder.parent,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    if not wait:
        return started
    stdout, stderr = started.communicate()
    return subprocess.CompletedProcess(code, started.returncode, stdout, stderr)


def test_processes_that_start_at_once_do_not_disturb_each_other(package):
    """On a stale cache, with two signatures each of which is the first of some process."""
    package.answer()
    package.edit("constants", "4.0", "5.0")
    code = "from made.linked import less; from made.unit import answer; from made.tuples import Pair; print([{}])"
    call = "answer(Pair({0}, {1})), answer(Pair({1}, {0}))"
    pairs = [("3.0", "1"), ("1", "3.0"), ("3.0", "1")]
    started = [process(package, code.format(call.format(*pair)), wait=False) for pair in pairs]
    found = [each.communicate() for each in started]
    assert [text for _, text in found] == ["", "", ""]
    for (one, other), (text, _) in zip(pairs, found, strict=True):
        expected = {("3.0", "1"): 202.0, ("1", "3.0"): -2.0}
        assert ast.literal_eval(text) == [expected[one, other], expected[other, one]]
    unit = package.load()
    pair = importlib.import_module("made.tuples").Pair
    assert (unit.answer(pair(3.0, 1)), unit.answer(pair(1, 3.0))) == (202.0, -2.0)
    assert not unit.answer.stats.cache_misses


def test_code_of_others_has_the_cache_of_numba(package):
    path = package.folder / "theirs.py"
    path.write_text("from numba import njit\n\n@njit(cache=True)\ndef theirs(x):\n    return x\n")
    cache = package.load("theirs").theirs._cache
    assert type(cache) is caching.FunctionCache
    assert not any(each.__module__.startswith("tline") for each in caching.CacheImpl._locator_classes)
    assert isinstance(package.load().answer._cache, compiled.UnitCache)


def test_functions_within_functions_are_not_kept(package):
    """What they enclose is not in any file, nor is what is made from a text."""
    text = FILES["linked"] + "\ndef plus(a):\n    @njit()\n    def add(x):\n        return x + a\n    return add\n"
    (package.folder / "linked.py").write_text(text)
    plus = package.load("linked").plus
    assert (plus(1)(1), plus(2)(1)) == (2, 3)
    exec("@njit()\ndef same(x):\n    return x\n", plus.__globals__)
    assert plus.__globals__["same"](3) == 3
    assert package.kept() == []


OURS = {  # a cheap function of each module that has compiled ones
    "tline.study.reference.grid": "arriving",
    "tline.study.baseline.loops": "inside",
}


def test_all_modules_with_compiled_functions_are_known_here():
    folders = [ROOT / name for name in ("tline", "friction", "drives", "passivity")]
    found = [path for folder in folders for path in folder.rglob("*.py") if "\n@njit(" in path.read_text()]
    assert {".".join(path.relative_to(ROOT).with_suffix("").parts) for path in found} == set(OURS)


@pytest.mark.parametrize("unit", OURS)
def test_ours_are_made_of_what_they_import(unit):
    """An edit of any file that a module imports, read by the syntax tree and followed, is an edit of its functions."""
    module = importlib.import_module(unit)
    function = getattr(module, OURS[unit])
    sources = function._cache._sources
    assert sources.keys() == followed(unit)
    kept = pickle.loads(pickle.dumps(digests(sources)))
    assert are_unchanged(sources, kept)
    for name, source in sources.items():
        edited = type(source)(name, "", source.text + "\nEDITED = 1\n")
        assert not are_unchanged(sources | {name: edited}, kept)


def followed(module):
    found, waiting = set(), [module]
    while waiting:
        name = waiting.pop()
        found.add(name)
        tree = ast.parse((ROOT / name.replace(".", "/")).with_suffix(".py").read_text())
        imports = [node.module for node in tree.body if isinstance(node, ast.ImportFrom)]
        ours = {each for each in imports if each.partition(".")[0] in ("tline", "friction")}
        waiting += ours - found
    return found


def test_a_module_is_read_from_its_file_where_its_loader_cannot_tell(package):
    """As those that pytest loads."""
    module = package.load("linked")
    module.__spec__ = ModuleSpec("made.linked", None, origin=str(package.folder / "linked.py"))
    assert sources_of("made.linked")["made.linked"].text == FILES["linked"]


def test_modules_in_an_archive_are_kept_as_well(package, monkeypatch):
    archive = package.folder.parent / "made.zip"
    with ZipFile(archive, "w") as file:
        for path in package.folder.glob("*.py"):
            file.write(path, f"made/{path.name}")
    monkeypatch.setenv("XDG_CACHE_HOME", str(package.folder.parent / "cache"))
    monkeypatch.syspath_prepend(str(archive))
    assert package.answer() == (162.0, True)
    assert package.answer() == (162.0, False)
    assert str(archive) in sys.modules["made.unit"].__spec__.origin


def test_a_module_whose_source_cannot_be_read_is_not_kept():
    assert sources_of("sys") is None
    assert sources_of("no.such.module") is None


def test_numba_is_what_it_was(package):
    """The parts of numba that the cache leans on; a failure here says what a new version of numba has changed."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cache = package.load().answer._cache
        package.answer()
    assert isinstance(cache._numba, caching.CompileResultCacheImpl)
    assert isinstance(numba.njit(lambda x: x)._cache, caching.NullCache)
    cache.flush()
    assert [path for path in package.kept() if "answer" in path.name] == []
    cache.disable()
    assert cache.load_overload((numba.float64,), numba.core.registry.cpu_target.target_context) is None
