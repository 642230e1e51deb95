"""Errors of all four packages are one family, and survive what process pools do to them."""

import copy
import pickle
import subprocess
import sys

import pytest

import drives
import friction
from passivity.errors import ExpressionError
from tline.errors import ActiveError, InputError, SceneError

ERRORS = [
    InputError("lines.pipe.radius", "too small", "more than 0 m", "-1 m"),
    InputError("", "no lines"),
    ActiveError("loads.end", "is active", "passive elements"),
    ExpressionError("column 3", "not a number", got="x"),
    SceneError([InputError("a", "wrong", "right", "left"), InputError("b", "wrong too")]),
]


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda error: pickle.loads(pickle.dumps(error))])
def test_errors_survive_copies_and_pickle(error, copied):
    found = copied(error)
    assert type(found) is type(error)
    assert str(found) == str(error)
    assert (found.where, found.problem, found.expected, found.got) == (
        error.where,
        error.problem,
        error.expected,
        error.got,
    )
    if isinstance(error, SceneError):
        assert [str(mistake) for mistake in found.mistakes] == [str(mistake) for mistake in error.mistakes]


def test_the_four_packages_have_one_base():
    assert friction.InputError is drives.InputError is InputError
    assert issubclass(ExpressionError, InputError)


def test_the_ground_floor_loads_nothing_else():
    code = "import sys, tline.errors, tline.units; print(*sorted(m for m in sys.modules if m.startswith('tline')))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["tline", "tline.errors", "tline.lazy", "tline.units"]
