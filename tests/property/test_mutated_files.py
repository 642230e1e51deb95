"""Files with words and lines torn out, doubled and moved; `python tests/attack.py decks` takes thousands."""

import pytest
from mutated_files import DECKS, DIALECTS, IBIS, TOUCHSTONE, mutated, outcome

NUMBER, MANY = 300, 40


@pytest.mark.parametrize("name", DECKS | DIALECTS)
def test_a_whole_deck_is_read(name, tmp_path):
    assert outcome((DECKS | DIALECTS)[name], tmp_path) == "read"


def test_torn_decks_are_read_or_refused_in_a_sentence(tmp_path):
    found = [outcome(mutated(seed)[1], tmp_path) for seed in range(-NUMBER, NUMBER)]
    assert {*found} == {"read", "refused"}
    assert found.count("read") > MANY


@pytest.mark.parametrize("files", [IBIS, TOUCHSTONE])
def test_torn_models_and_samples_are_read_or_refused_in_a_sentence(files, tmp_path):
    found = [outcome(text, tmp_path, name) for name, text in (mutated(seed, files) for seed in range(NUMBER // 3))]
    assert {*found} <= {"read", "refused"}
    assert "refused" in found


@pytest.mark.parametrize("seed", [74693])
def test_decks_that_were_faults_once(seed, tmp_path):
    assert outcome(mutated(seed)[1], tmp_path) == "refused"
