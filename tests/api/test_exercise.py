"""The exercise by its letters: every one answered, checked, drawn, and the same on the command line as in Python."""

import json
import pickle

import command_line
import pytest
from command_line import assert_refused
from matplotlib.figure import Figure
from matplotlib.image import imread

import tline as tl
from drives import Belt, CoupledDrives, Spool
from tline.exercises.answer import Answer, Step, letters

LETTERS = [
    *("1" + each for each in "abcde"),
    "2a",
    "2b",
    *("3" + each for each in "abcd"),
    *("4" + x for x in "abcdefgh"),
]
DRAWN = {"1a", "1b", "1c", "1d", "1e", "2a", "2b", "3a", "3b", "3c", "3d", "4g", "4h"}
CODED = {"4b", "4c", "4e", "4f", "4g", "4h"}


@pytest.fixture(scope="module")
def answers():
    return {letter: tl.exercise(letter) for letter in LETTERS}


def run(command):
    return command_line.run(f"exercise {command}")


def test_all_letters_are_answered(answers):
    assert [*letters()] == LETTERS
    for letter, answer in answers.items():
        text = "\n".join(answer.text_lines())
        assert text.startswith(f"({letter}) ")
        assert "{" not in text, text
        assert answer.paragraphs
        assert answer.question
        assert pickle.loads(pickle.dumps(answer)).to_dict() == answer.to_dict()
        assert json.loads(json.dumps(answer.to_dict()))["letter"] == letter


def test_steps_of_lines_and_passivity_are_checked_and_hold(answers):
    checked = {letter: [step.holds for step in answers[letter].steps] for letter in LETTERS if letter[0] in "23"}
    assert all(False not in each for each in checked.values())
    assert {letter: each.count(True) for letter, each in checked.items()} == {
        "2a": 3, "2b": 4, "3a": 5, "3b": 2, "3c": 11, "3d": 4
    }  # fmt: skip
    assert answers["3d"].steps[-1].reason.startswith("all of it at once: proved")


def test_a_wrong_step_would_be_seen(answers):
    from tline.exercises.answer import _step

    assert _step("z0 = c·L/2", "", left="(L/C)/(1/(L*C))", right="L^2/4").holds is False
    wrong = Answer(**vars(answers["2b"]) | {"steps": (Step("z0 = c/L", "a slip", False),)})
    assert "DOES NOT HOLD: a slip" in str(wrong)


def test_numbers_are_those_that_are_kept(answers):
    found = {letter: answer.numbers for letter, answer in answers.items()}
    assert found["1b"]["v_slow"] == 16
    assert found["1b"]["v_fast"] == pytest.approx(90.25, rel=1e-13)
    assert found["1c"]["creep"] == pytest.approx(0.5 * (2 - (6**0.5 - 2)), rel=1e-3)  # v = -1 + t + t²/4 reaches -1/2
    assert found["1c"]["chatter"] > 20
    assert found["1d"]["v"] == pytest.approx(13.963289889871819, rel=1e-12)
    assert found["1e"]["v_stiff"] == pytest.approx(13.964028, abs=1e-6)
    assert (found["1a"]["changes_slow"], found["1a"]["expected_slow"]) == (100, 100)
    assert found["1a"]["crossed"] < 1e-9
    assert found["2a"]["bulk_modulus"] == pytest.approx(2.205e9)
    assert found["2a"]["z0"] == pytest.approx(4.68e7, rel=1e-3)
    assert found["2b"]["capacitance"] == pytest.approx(1 / 9e10)
    assert found["2b"]["inductance"] == pytest.approx(1e-6)
    assert found["4d"]["k_p"] == pytest.approx(100)
    assert found["4d"]["pole_of_the_wrong_sign"].real == pytest.approx(150 + 24500**0.5, rel=1e-15)  # s² - 300 s - 2000
    assert found["4g"]["claimed"] == pytest.approx(500**0.5)
    assert (found["4g"]["natural"], found["4g"]["peak"], found["4g"]["starts"]) == (20, None, -180)
    assert list(found["4h"]["relative_gain"]) == [0.5] * 3
    assert found["4h"]["controlled"].endswith("the belt has 1 m/s and 5.00001 N at 2 s.")


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("4d", "the belt has a pole at 306.525 rad/s"),
        ("4d --angle '30 deg'", "F1 = 1.15470054 N and F2 = 1.15470054 N; the model's pulley has 1.15470054 N"),
        ("4g", "With these numbers there is no peak"),
        ("4g", "2 of its eigenvalues are exactly 0"),
        ("4g --friction '0.1 N m s, 0 N m s'", "Here it starts at -90°"),
        ("4g --friction '0.001 N m s'", "a peak at 19.8"),
        ("4g --friction '0 N m s' --belt-damping '0 N s/m'", "a peak at 20 rad/s, without bound"),
        ("4h --radius '10 cm, 5 cm'", "T2 = 1.06667·(τ_f + τ_v)/2 − 0.03·F"),
        ("4h --friction '0 N m s' --belt-damping '0 N s/m'", "no PI controller of this rule"),
        ("4f --inertia '1e-3 kg m^2, 2e-3 kg m^2'", "drive2(J = 0.002, B = 0.1, r = 0.1)"),
        ("3C", "[checked: divide by 1 + H1]"),
        ("", "3c  From the reflection at side 1 to the input admittance, and equation (11)"),
    ],
)
def test_answers(command, words):
    result = run(command)
    assert words in " ".join(result.output.split()) or words in result.output
    assert (result.exit_code, result.stderr) == (0, "")


@pytest.mark.parametrize(
    ("command", "sentence"),
    [
        ("5a", "exercise: no such letter, expected one of '1a'"),
        ("1a --radius '1 m'", "drives: exercise 1a has none, expected a letter from 4a to 4h"),
        ("--radius '1 m'", "--radius: nothing to use it, expected a letter from 4a to 4h"),
        ("4a --plot out.png", "exercise 4a: has no figure"),
        ("--plot out.png", "--plot: nothing to write, expected a letter that asks for it"),
        ("3a --modelica out.mo", "--modelica: nothing to write, expected a letter that asks for it"),
        ("4b --modelica nowhere/out.mo", "nowhere/out.mo: cannot be written"),
        ("1a --plot out.gif", "--plot: unknown kind of file"),
        ("2a --figures file/inside", "--figures: cannot be made"),
    ],
)
def test_mistakes(command, sentence, folder):
    (folder / "file").write_text("", encoding="utf-8")
    assert_refused(f"exercise {command}", sentence)


def test_figures_show_something(answers):
    assert {letter for letter, answer in answers.items() if answer.has_figure} == DRAWN
    for letter in sorted(DRAWN):
        axes = Figure().subplots()
        assert answers[letter].plot(axes) is axes
        assert axes.lines
        assert len(answers[letter].plot().axes) > 1
    assert "data:image/png" in answers["2a"]._repr_html_()
    assert "package CoupledDrives" in answers["4b"]._repr_html_()
    with pytest.raises(tl.InputError, match="exercise 4b: has no figure"):
        answers["4b"].plot()


def test_files_are_written(folder, answers):
    assert {letter for letter, answer in answers.items() if answer.modelica} == CODED
    assert run("4f --modelica drives.mo").output.endswith("wrote drives.mo\n")
    assert (folder / "drives.mo").read_text(encoding="utf-8") == answers["4f"].modelica
    assert "wrote new/3b.png" in run("3b --figures new/").output.replace("\\", "/")
    assert imread(folder / "new" / "3b.png")[..., :3].std() > 0.05


def test_other_drives():
    unequal = CoupledDrives(Spool(2e-3, 0.1, 0.05))
    undamped = CoupledDrives(Spool(1e-3, 0, 0.1), Spool(1e-3, 0, 0.1), Belt(50, 0), Belt(50, 0))
    for drives in (unequal, undamped, CoupledDrives(right_belt=Belt(70, 0))):
        for letter in (each for each in LETTERS if each[0] == "4"):
            assert "{" not in "".join(tl.exercise(letter, drives).paragraphs)
    assert not tl.exercise("4h", unequal).modelica  # its decoupler is for spools alike
    assert "an undamped belt has no such model" in "".join(tl.exercise("4g", undamped).remarks)
