"""`tline passivity` of structures: `let`, any functions, files of proofs and witnesses."""

import json

import pytest
from click.testing import CliRunner

from tline.cli.passivity import passivity
from tline.errors import InputError


def run(*args):
    return CliRunner().invoke(passivity, list(args))


@pytest.mark.parametrize(("text", "exit_code"), [("line(50, T*s, Z2)", 0), ("line(50, T*s, Z2) - 1", 1)])
def test_what_is_written_is_verified(tmp_path, text, exit_code):
    file = str(tmp_path / "evidence.json")
    told = run(text, "--param", "Z2 positive real", "--param", "T > 0", "--certificate", file)
    assert told.exit_code == exit_code
    assert told.output.endswith(f"wrote {file}\n")
    again = run("--verify", file)
    assert (again.exit_code, again.output.startswith("holds: ")) == (0, True)


def test_a_forged_proof_is_refused(tmp_path):
    file = tmp_path / "proof.json"
    run("1 + Z2", "--param", "Z2 pr", "--certificate", str(file))
    proof = json.loads(file.read_text())
    proof["root"][0] = "-1"
    file.write_text(json.dumps(proof))
    told = run("--verify", str(file))
    assert (told.exit_code, told.output.startswith("does not hold: the end")) == (1, True)


def test_what_a_file_says_of_itself_is_not_believed(tmp_path):
    file = tmp_path / "proof.json"
    run("1 + Z2", "--param", "Z2 pr", "--certificate", str(file))
    file.write_text(json.dumps(json.loads(file.read_text()) | {"statement": "Z2 - 1 is positive real"}))
    told = run("--verify", str(file))
    assert (told.exit_code, told.output) == (0, "holds: 1 + Z2 is positive real, Z2 being positive real\n")


def test_the_chain_for_any_load_is_printed_step_by_step():
    told = run("Z2", "--kind", "chain", "--param", "Z2 positive real", "--param", "z0 > 0", "--param", "T >= 0")
    assert told.exit_code == 0
    assert [told.output.count(f"({x}) ") for x in "abcd"] == [1] * 4
    assert "[divide by 1 + H1]" in told.output


def test_one_question_is_needed():
    assert isinstance(run().exception, InputError)
