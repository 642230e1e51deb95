"""Numbers beyond all measure, asked in ways that once ended the process: an answer, or a sentence."""

import json

import pytest
from click.testing import CliRunner

from tline.cli.main import main

HUGE = [
    ("sech(1e400)", (0, 3)),
    ("1-coth(1e308)", (1, 3)),
    ("s*exp(1e30)", (0,)),
    ("csch(coth(4 pF))", (0,)),
    ("s + exp(-1e10)", (0,)),
    ("exp(exp(100))*s", (0, 2, 3)),
    ("1/(s + exp(-1e30))", (0, 3)),
    ("sqrt(exp(1e9) + s)", (0, 3)),
    ("log(exp(1e9)) + s", (0, 3)),
    ("exp(-1e308*s)", (1,)),
    ("((exp(-s) + 2)^200)^200", (1, 2, 3)),
    ("1/(1e308)^40+1", (0,)),
    ("(1e308)^200^2", (2,)),
    ("((1e308 + s)^200)^2", (2,)),
    ("1e400*s^2 + 1e-400*s + 1", (1,)),
    ("[1e308, s; s, 1e308]", (1,)),
    ("[(1e308)^40, 0; 0, 1e-308*s]", (0,)),
    ("[10, s, s; (2e100)^-200, s*s, 1n; 9e300 - s, s, 9e50]", (1, 3)),
]


@pytest.mark.parametrize(("text", "statuses"), HUGE)
@pytest.mark.parametrize("options", [[], ["--json"]])
def test_huge_numbers_are_answered(text, statuses, options):
    result = CliRunner().invoke(main, ["passivity", text, *options])
    assert result.exit_code in statuses, result.output
    if options and result.exit_code != 2:
        assert json.loads(result.stdout)["status"]


@pytest.mark.parametrize(
    ("arguments", "statuses"),
    [
        (["R*s + 1", "--param", "R > (1e400)^60"], (0, 3)),
        (["s + R", "--param", "0 < R < 1e-400"], (0, 3)),
        (["(9 + R - 50*s)^40", "--param", "R > 0"], (1, 3)),
        (["1 + s", "--z0", "1e400"], (0,)),
        (["1 + s", "--z0", "1e400", "--delay", "1e-400"], (0,)),
        (["-s", "--z0", "1e-400", "--delay", "1e400"], (1,)),
        (["1 + s", "--within", "1e-400"], (0,)),
        (["R", "--param", "R=(1e400)^100"], (2,)),
    ],
)
def test_huge_parameters_are_answered(arguments, statuses):
    result = CliRunner().invoke(main, ["passivity", *arguments])
    assert result.exit_code in statuses, result.output


def test_a_count_of_pulses_beyond_doubles_is_refused():
    from tline.scene.waveform import Pulses

    with pytest.raises(ValueError, match="not a whole number in range, expected one of at most 2\\^53"):
        Pulses.model_validate({"high": 1, "width": 1e-9, "period": 3e-9, "count": 10**400})
