"""Structures that compiled code reads and writes by reference."""

from typing import NamedTuple

import numpy as np
import pytest

from tline.compiled.structure import Floats, Floats2, pack
from tline.compiled.unit import function, unit


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
