"""Compiled units that are kept on disk are never stale, are used while they may be, and are never in the way."""

import importlib
import os
import pickle
import sys
from hashlib import sha256
from importlib.machinery import ModuleSpec
from zipfile import ZipFile

import pytest
from compiled_package import CALL, FILES, Package

from tline.compiled import compiler, object_code
from tline.compiled.stamp import sources_of
from tline.errors import NotKeptWarning

EDITS = [  # file, what is edited, the answer to x = 3, y = 1 then, and what is compiled; it is 161 before
    ("constants", "4.0", "5.0", 201.0, ["answer"]),
    ("shared", "10.0 * FOUR", "10.5 - FOUR", 27.0, ["answer"]),
    ("inner", "2.0 * x", "3.0 * x", 241.0, ["answer"]),
    ("called", "-= 1.0", "+= 1.0", 163.0, ["less"]),
    ("unit", "WEIGHT * grow", "0.5 * grow", 3.0, ["answer"]),
    ("structures", "    x: float\n    y: float\n", "    y: float\n    x: float\n", 161.0, ["less", "answer"]),
]


@pytest.fixture
def package(tmp_path, monkeypatch):
    made, compile_unit = Package(tmp_path), compiler.compile_unit
    (tmp_path / "call").write_text(CALL)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # which Python itself may believe for as long as a second
    monkeypatch.setattr(object_code, "_said", set())
    monkeypatch.syspath_prepend(str(tmp_path))

    def compile_and_tell(code, *arguments):
        made.compiled.append(code.__name__)
        return compile_unit(code, *arguments)

    monkeypatch.setattr(compiler, "compile_unit", compile_and_tell)
    cached = (object_code._folder, object_code._processor, object_code._is_for_this_processor)
    for each in cached:
        each.cache_clear()
    yield made
    for each in cached:
        each.cache_clear()


def test_code_that_comes_with_the_program_is_used_where_it_fits(package, tmp_path, monkeypatch):
    """By whatever numba it was made; not if the source is other, numba is asked for other code, or it cannot run."""
    assert package.answer() == (161.0, ["less", "answer"])
    shipped = tmp_path / "shipped"
    (tmp_path / "cache").rename(shipped)
    for path in shipped.glob("*.unit"):
        path.rename(path.with_name(path.name.rpartition("-")[0] + ".unit"))
    monkeypatch.setattr(object_code, "SHIPPED", shipped)
    monkeypatch.setattr(object_code, "_versions", lambda: "another numba")
    monkeypatch.setattr("tline.compiled.unit.keep", lambda *_: None)

    def asked():
        object_code._is_for_this_processor.cache_clear()
        return package.answer()

    assert asked() == (161.0, [])
    package.edit("called", "-= 1.0", "+= 1.0")
    assert asked() == (163.0, ["less"])
    with monkeypatch.context() as other:
        other.setenv("NUMBA_OPT", "2")
        assert asked() == (163.0, ["less", "answer"])
    monkeypatch.setattr(object_code, "BASELINE", {object_code.platform.machine(): {"a feature of no processor"}})
    assert asked() == (163.0, ["less", "answer"])


def test_an_edit_of_any_file_that_a_unit_is_made_of_is_seen(package):
    """And edited back, the old answer comes again; what is called by its address is compiled alone."""
    assert package.answer() == (161.0, ["less", "answer"])
    for name, old, new, then, compiled in EDITS:
        package.edit(name, old, new)
        assert package.answer() == (then, compiled), name
        package.edit(name, new, old)
        assert package.answer() == (161.0, compiled), name
    assert package.answer() == (161.0, [])


def test_what_means_the_same_is_not_compiled_again(package):
    package.answer()
    kept = package.kept()
    package.edit("constants", '"""Numbers."""', '"""Numbers that\n\nfrom elsewhere import more of them."""')
    package.edit("inner", '"""Larger."""', "# larger")
    package.edit("called", "-= 1.0", "-= (  # all of it\n            1.0)")
    package.edit("unit", "\n@unit", "\n\n\n@unit")
    os.utime(package.folder / "structures.py", (1.0, 1.0))
    (package.folder / "other.py").write_text("from made import unit\n")
    package.edit("__init__", "", "from made import other\n")  # nothing imports that
    assert package.answer() == (161.0, [])
    assert package.kept() == kept


def test_what_is_loaded_counts_and_not_what_an_upgrade_writes_meanwhile(package):
    """A process goes on with the constant it has loaded; what it compiles is not taken for the new one's."""
    loaded = package.load()
    package.edit("constants", "4.0", "5.0")
    assert package.ask(loaded)[0] == 161.0
    assert package.answer() == (201.0, ["answer"])


def test_the_folder_does_not_grow(package):
    package.answer()
    kept = package.kept()
    assert len(kept) == 2
    package.edit("structures", "    y: float\n", "    y: float\n    z: float = 0.0\n")
    package.edit("structures", "    law: int\n    out: Floats\n", "    law: int = 0\n    out: Floats = None\n")
    assert package.answer() == (161.0, ["less", "answer"])
    assert package.kept() == kept


@pytest.mark.parametrize("part", ["numba", "llvmlite"])
def test_another_version_of_the_compiler_compiles_anew(package, monkeypatch, part):
    package.answer()
    versions = object_code._versions().replace(part, f"another {part}")
    monkeypatch.setattr(object_code, "_versions", lambda: versions)
    assert package.answer() == (161.0, ["less", "answer"])


@pytest.mark.parametrize(
    ("setting", "value"),
    [
        ("NUMBA_OPT", "1"),
        ("NUMBA_BOUNDSCHECK", "1"),
        ("NUMBA_CPU_NAME", "generic"),
        ("NUMBA_CPU_FEATURES", ""),
        ("NUMBA_ENABLE_AVX", "0"),
        ("NUMBA_EXTEND_VARIABLE_LIFETIMES", "1"),
        ("processor", ""),
        ("file", ""),
    ],
)
def test_other_processors_and_settings_have_code_of_their_own(package, monkeypatch, setting, value):
    package.answer()
    with monkeypatch.context() as patch:
        patch.setenv(setting, value)
        if setting == "file":  # of numba's settings, in the folder where the program runs
            patch.chdir(package.folder)
            (package.folder / ".numba_config.yaml").write_text("loop_vectorize: 1\n")
        if setting == "processor":
            patch.setattr("llvmlite.binding.get_host_cpu_name", lambda: "generic")
        object_code._processor.cache_clear()
        assert package.answer() == (161.0, ["less", "answer"])
        assert package.answer() == (161.0, [])
    object_code._processor.cache_clear()
    assert package.answer() == (161.0, [])


def test_settings_that_do_not_change_code_share_it(package, monkeypatch):
    package.answer()
    monkeypatch.setenv("NUMBA_NUM_THREADS", "1")
    object_code._processor.cache_clear()
    assert package.answer() == (161.0, [])


def test_broken_and_foreign_files_are_compiled_anew(package):
    package.answer()
    (whole,) = (path for path in package.kept() if "answer" in path.name)
    content = whole.read_bytes()
    flipped = bytearray(content)
    flipped[-100] ^= 1
    for told in (b"", b"null", b"[]", b"{}", b'{"versions": 1}', b"\x80\x05N."):
        headed = sha256(told + b"\n").hexdigest().encode() + b"\n" + told + b"\n"
        for wrong in (headed, told):
            whole.write_bytes(wrong)
            assert package.answer() == (161.0, ["answer"])
    for wrong in (content[:20], content[:300], content[:-1], flipped, b"#!/bin/sh\n"):
        whole.write_bytes(wrong)
        assert package.answer() == (161.0, ["answer"])
        assert package.answer() == (161.0, [])


class Command:
    """What runs a command when it is unpickled."""

    def __init__(self, command):
        self.command = command

    def __reduce__(self):
        return os.system, (self.command,)


def test_what_a_stranger_puts_there_does_not_run(package):
    """Whatever file it takes its place of, at whatever place in it."""
    package.answer()
    ran = package.folder.parent / "ran"
    hostile = pickle.dumps(Command(f"touch {ran}"))
    made = package.load()
    for unit in (made.answer, importlib.import_module("made.called").less):
        path = object_code.path_of(unit)
        content = path.read_bytes()
        for end in [0, *(k + 1 for k, byte in enumerate(content) if byte == ord("\n"))][:20]:
            path.write_bytes(content[:end] + hostile)
            assert object_code.load(unit) is None
    assert not ran.exists()


def test_a_file_that_another_user_can_have_written_is_replaced(package):
    package.answer()
    path = next(path for path in package.kept() if "answer" in path.name)
    path.chmod(0o664)
    with pytest.warns(NotKeptWarning, match="compiled code is not read, but compiled anew: other users .*answer"):
        assert package.answer() == (161.0, ["answer"])
    assert path.stat().st_mode & 0o777 == 0o644
    assert package.answer() == (161.0, [])


def test_a_folder_that_others_may_write_is_neither_read_nor_written(package):
    """As /tmp, where what a stranger puts under the name of a file that is not there yet would be read."""
    package.answer()
    kept = package.kept()
    kept[0].parent.chmod(0o1777)
    for path in kept[:1]:
        path.unlink()
    with pytest.warns(
        NotKeptWarning, match="not (read|kept).*other users may write to .*cache, expected a fol"
    ) as said:
        assert package.answer() == (161.0, ["less", "answer"])
    assert len(said) == 1
    assert package.kept() == kept[1:]


def test_whatever_the_umask_others_may_not_write_what_is_kept(package):
    before = os.umask(0)
    try:
        package.answer()
    finally:
        os.umask(before)
    assert package.answer() == (161.0, [])
    assert {path.stat().st_mode & 0o777 for path in package.kept()} == {0o644}


def test_a_folder_beside_the_program_that_others_may_write_is_passed_over(package, monkeypatch):
    """As where the umask lets the group write; there is the user's own cache."""
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    monkeypatch.setenv("XDG_CACHE_HOME", str(package.folder.parent / "cache"))
    (package.folder / "__pycache__").mkdir()
    (package.folder / "__pycache__").chmod(0o775)
    assert package.answer() == (161.0, ["less", "answer"])
    assert {path.parent for path in package.kept()} == {package.folder.parent / "cache" / "tline"}
    assert package.answer() == (161.0, [])


def test_a_symbol_that_is_nowhere_is_left_to_the_compiler(package, monkeypatch):
    package.answer()
    monkeypatch.setattr(object_code, "_is_found", lambda symbol: symbol not in ("exp", "tanh"))
    assert package.answer() == (161.0, ["answer"])


def test_without_a_folder_to_write_in_it_runs_and_says_so_once(package, monkeypatch):
    """A regular file stands wherever a folder would be made (root may write anywhere else)."""
    blocked = package.folder.parent / "blocked"
    blocked.write_text("a file")
    (package.folder / "__pycache__").write_text("a file")
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    monkeypatch.setenv("HOME", str(blocked))
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked / "cache"))
    with pytest.warns(NotKeptWarning, match="no folder for it can be written, expected NUMBA_CACHE_DIR to") as said:
        assert [package.answer(), package.answer()] == [(161.0, ["less", "answer"])] * 2
    assert len(said) == 1
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(blocked / "cache"))
    object_code._folder.cache_clear()
    object_code._said.clear()
    with pytest.warns(NotKeptWarning, match="it cannot be written into .*cache, got not a directory"):
        assert package.answer() == (161.0, ["less", "answer"])


def test_a_folder_that_vanishes_is_made_again(package):
    package.answer()
    loaded = package.load()
    (package.folder.parent / "cache").rename(package.folder.parent / "gone")
    assert package.ask(loaded) == (161.0, ["less", "answer"])
    assert package.answer() == (161.0, [])


def test_a_full_disk_is_no_error(package):
    """Files may not grow beyond 1000 bytes in that process."""
    limit = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))\n"
    (package.folder.parent / "call").write_text(limit + CALL)
    said, warned = package.process().communicate()
    assert said == f"{(161.0).hex()} True\n"
    assert warned.count("NotKeptWarning") == 1
    assert "file too large" in warned
    assert package.kept() == []


def test_processes_that_start_at_once_do_not_disturb_each_other(package):
    """On a stale cache; afterwards kept code gives the same bits in a process without numba."""
    package.answer()
    package.edit("constants", "4.0", "5.1")
    at_once = [each.communicate() for each in [package.process() for _ in range(3)]]
    said, warned = package.process().communicate()
    number, _, numba = said.partition(" ")
    assert float.fromhex(number) == pytest.approx(205.0)
    assert (numba, warned) == ("False\n", "")
    assert at_once == [(f"{number} True\n", "")] * 3


def test_what_is_made_within_functions_or_from_text_is_not_kept(package):
    """What they enclose is not in any file."""
    made = "\ndef plus(a):\n    @unit\n    def add(n: int) -> int:\n        return n + a\n    return add\n"
    package.edit("inner", "import function\n", f"import function, unit\n{made}")
    plus = package.load("inner").plus
    assert (plus(1)(1), plus(2)(1)) == (2, 3)
    exec("@unit\ndef same(n: int) -> int:\n    return n\n", plus.__globals__)
    assert plus.__globals__["same"](3) == 3
    assert package.kept() == []


def test_modules_in_an_archive_are_kept_as_well(package, monkeypatch):
    archive = package.folder.parent / "made.zip"
    with ZipFile(archive, "w") as file:
        for path in package.folder.glob("*.py"):
            file.write(path, f"made/{path.name}")
    monkeypatch.syspath_prepend(str(archive))
    assert package.answer() == (161.0, ["less", "answer"])
    assert package.answer() == (161.0, [])
    assert str(archive) in sys.modules["made.unit"].__spec__.origin


def test_a_module_is_read_from_its_file_where_its_loader_cannot_tell(package):
    """As those that pytest loads."""
    module = package.load("inner")
    module.__spec__ = ModuleSpec("made.inner", None, origin=str(package.folder / "inner.py"))
    assert sources_of("made.inner")["made.inner"].text == FILES["inner"]
    assert sources_of("sys") is None
    assert sources_of("no.such.module") is None
