"""Whatever is asked about passivity is answered, or refused in a sentence: never a fault, never an abort."""

import shlex
from random import Random

import pytest
from click.testing import CliRunner

from passivity import ExpressionError, StateSpace, check_bounded_real, check_positive_real
from tests.random_expressions import question, state_space
from tline.cli.main import main


@pytest.mark.parametrize("seed", range(25))
def test_every_question_has_an_answer(seed):
    arguments = question(Random(seed))
    result = CliRunner().invoke(main, ["passivity", *arguments])
    assert result.exit_code in (0, 1, 2, 3), shlex.join(arguments) + result.stderr
    assert result.exit_code != 2 or result.stderr.count("\n") == 1


@pytest.mark.parametrize("seed", range(12))
def test_every_state_space_has_an_answer(seed):
    entries = state_space(Random(seed))
    try:
        system = StateSpace.from_entries(*entries)
    except ExpressionError:
        return
    assert check_positive_real(system).why
    assert check_bounded_real(system).why
