"""Compiled units: what each is made of, the parts of numba that they lean on, and structures by reference."""

import ast
import json
from functools import cache
from pathlib import Path
from random import Random
from typing import NamedTuple

import numpy as np
import pytest
from llvmlite import binding as llvm
from numba.core.codegen import JITCodeLibrary
from numba.core.registry import cpu_target

from tline.cli.warm_up import found
from tline.compiled import compiler, object_code
from tline.compiled.stamp import are_unchanged, digests
from tline.compiled.structure import Floats, Floats2, pack
from tline.compiled.unit import function, unit

ROOT = Path(__file__).parents[2]


def file_of(module):
    path = ROOT / module.replace(".", "/")
    return next((each for each in (path.with_suffix(".py"), path / "__init__.py") if each.exists()), None)


@cache
def imported(module):
    """Modules of ours that a module imports at top level, by the syntax tree of its file."""
    found = set()
    for node in ast.parse(file_of(module).read_text()).body:
        if isinstance(node, ast.ImportFrom) and node.module.partition(".")[0] in (module.partition(".")[0], "tline"):
            inner = [f"{node.module}.{alias.name}" for alias in node.names]
            found |= {each if file_of(each) else node.module for each in inner}
    return found


def followed(*modules):
    """Modules, and all of ours that they import."""
    reached, waiting = set(), {*modules}
    while waiting:
        reached |= waiting
        waiting = set().union(*map(imported, waiting)) - reached
    return reached


OURS = dict(found())


@pytest.mark.parametrize("where", OURS, ids=".".join)
def test_ours_are_made_of_what_they_import(where):
    """An edit of any file that a unit's module imports is an edit of the unit; so is one of how units are compiled."""
    sources = OURS[where].sources
    assert sources.keys() == followed(where[0], *object_code.COMPILING)
    then = json.loads(json.dumps(digests(sources)))
    assert are_unchanged(sources, then)
    for name in Random(where[1]).sample(sorted(sources), 5):  # other units have the rest
        edited = type(sources[name])(name, "", sources[name].text + "\nEDITED = 1\n")
        assert not are_unchanged(sources | {name: edited}, then)


def test_numba_is_what_it_was():
    """The parts of numba that units lean on; a failure here says what a new version of numba has changed."""
    overridden = {name for kind in (compiler._Part, compiler._Whole) for name in vars(kind) if name[:2] != "__"}
    leaned_on = {"_finalize_dynamic_globals", "_get_compiled_object", "get_pointer_to_function", *overridden}
    assert leaned_on - {"_names", "long_loops"} <= {*dir(JITCodeLibrary)}
    codegen = cpu_target.target_context.codegen()
    assert issubclass(type(codegen)._library_class, JITCodeLibrary)
    assert {"_data_layout", "_tm", "set_env"} <= {*dir(codegen)}
    passes = llvm.create_pass_builder(codegen._tm, llvm.create_pipeline_tuning_options(2)).getModulePassManager()
    assert hasattr(passes, "run")


class Row(NamedTuple):
    scale: float
    values: Floats


@pytest.mark.parametrize(
    "wrong", [np.zeros(3, int), np.zeros((3, 1)), np.zeros(6)[::2], np.zeros(3, np.float32)], ids=str
)
def test_an_array_of_another_kind_is_refused(wrong):
    with pytest.raises(
        TypeError, match=r"Row\.values: a contiguous array of 1 dimensions of float64 is needed, not arr"
    ):
        pack(Row(1.0, wrong))


def test_units_say_what_they_cannot_be():
    class Named(NamedTuple):
        name: str

    def half(n: int) -> float:
        return n / 2

    with pytest.raises(TypeError, match=r"Named\.name: compiled code cannot read <class 'str'>"):
        pack(Named("x"))
    with pytest.raises(TypeError, match=r"half returns float64, not an integer"):
        unit(half)(1)


class Table(NamedTuple):
    row: Row
    values: Floats2
    n: int


def test_structures_are_read_and_written_by_reference_and_inner_functions_run_as_python_too():
    @function
    def total(values):
        found = 0.0
        for value in values:
            found += value
        return found

    @unit
    def fill(table: Table, factor: float) -> int:
        for i in range(table.n):
            table.row.values[i] = factor * table.row.scale * total(table.values[i])
        return table.values.shape[0] + table.values.size

    table = Table(Row(2.0, np.zeros(2)), np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]), 2)
    assert fill(pack(table), 10.0) == 8
    assert table.row.values.tolist() == [20.0 * total(table.values[i]) for i in range(2)] == [120.0, 300.0]
