"""What can be asked about passivity, what is answered, and what is refused in one sentence."""

import json
from fractions import Fraction

import numpy as np
import pytest
from scipy import signal

from passivity import ExpressionError, SampledResponse, Status, is_bounded_real, is_positive_real
from tline import ElectricalLine, InputError

control = pytest.importorskip("control")
skrf = pytest.importorskip("skrf")
BAND = skrf.Frequency(1, 10, 11, "ghz")
PROVED = {
    "text": "25 + s",
    "number": 0.5,
    "numpy number": np.float64(3),
    "fraction": Fraction(1, 3),
    "coefficients": ([1, 0], [2, 1]),
    "arrays": (np.array([1.0, 0]), np.array([2, 1])),
    "rows of an array": np.array([[1, 0], [2, 1]]),
    "lti": signal.lti([1, 0], [2, 1]),
    "zeros and poles": signal.lti([-1.0], [-2.0], 1.0),
    "scipy's states": signal.StateSpace([[-1]], [[1]], [[1]], [[0]]),
    "control's transfer function": control.tf([1], [1, 1]),
    "control's states": control.ss([[-1]], [[1]], [[1]], [[0]]),
    "matrices": ([[-1]], [[1]], [[1]], [[0]]),
    "coefficients in z": ([1, 1], [1, -1], 0.1),
    "matrices of discrete time": ([[0.5]], [[1]], [[1]], [[2]], True),
    "dlti": signal.dlti([1, 1], [1, -1]),
    "control's discrete states": control.ss([[0.5]], [[1]], [[1]], [[2]], 0.1),
    "discrete descriptor system": ([[2, 0], [0, 0]], [[1, 0], [0, 1]], [[1], [0]], [[1, 0]], [[2]], True),
    "descriptor system": ([[2, 0], [0, 0]], [[0, 1], [1, 3]], [[1], [0]], [[1, 0]], [[0]]),
    "line": ElectricalLine(z0="50 ohm", delay="5 ns"),
}


@pytest.mark.parametrize("what", PROVED.values(), ids=PROVED)
def test_what_is_taken(what):
    verdict = is_positive_real(what)
    assert verdict.proved
    assert "proved" in str(verdict)
    assert verdict.to_dict()["status"] == json.loads(json.dumps(verdict.to_dict()))["status"] == "proved"


def test_discrete_time_is_told():
    verdict = is_positive_real(control.tf([1, 3], [1, 0], True))
    assert "positive real for |z| > 1: refuted" in str(verdict)
    assert "Re Z(e^jθ) < 0 for 1.9106 < θ <= π" in str(verdict)
    assert "at θ = 3.14159 rad" in str(verdict)
    told = verdict.to_dict()["witness"]
    assert told["variable"] == "z"
    assert Fraction(told["re"]) ** 2 + Fraction(told["im"]) ** 2 > 1
    assert is_positive_real("z + 2", values={"z": 1}).in_s is None
    with pytest.raises(ExpressionError, match="parameter z: no value and no assumption"):
        is_positive_real("z + s")


def test_samples_can_only_refute():
    line = skrf.media.DefinedGammaZ0(BAND, z0=50).line(10, "mm")
    assert is_positive_real(line).status is is_bounded_real(line).status is Status.NO_VIOLATION
    line.s = line.s * 1.5
    assert is_positive_real(line).refuted
    assert is_positive_real(SampledResponse([1.0, 2.0], [3.0, -4.0], "Z")).refuted
    with pytest.raises(ExpressionError, match="samples of Z, expected samples of S"):
        is_bounded_real(SampledResponse([1.0], [3.0], "Z"))


@pytest.mark.parametrize("what", [None, [], [1, 2, 3], ("a", "b"), {}, True, int, 1j, object(), np.eye(3), b"s"])
def test_what_is_refused(what):
    with pytest.raises(ExpressionError, match="not a function of s, expected text, a number"):
        is_positive_real(what)


def test_other_refusals():
    with pytest.raises(ExpressionError, match="budget: not a multiple"):
        is_positive_real("s", budget=0)
    with pytest.raises(ExpressionError, match="says nothing about a function without names"):
        is_positive_real(3, ["R > 0"])
    with pytest.raises(ExpressionError, match="parameter s: s is the Laplace variable"):
        is_positive_real("s + R", values={"R": 1, "s": 2})
    with pytest.raises(ExpressionError, match="assumption: not an assumption"):
        is_positive_real("s + R", [None])  # pyright: ignore[reportArgumentType]
    with pytest.raises(ExpressionError) as refused:
        is_positive_real((np.eye(2), np.eye(2), np.eye(2)))
    assert "\n" not in str(refused.value)
    with pytest.raises(InputError, match="a length"):
        is_positive_real(ElectricalLine(z0=50, wave_speed="20 cm/ns"))


def test_a_larger_budget_decides_more():
    text = "(s + 1 - exp(-s)/3)/(s + 3 + exp(-2*s)/(1 + s)) + 1/10"
    assert is_positive_real(text, budget=1e-9).status is Status.UNDECIDED
    assert is_positive_real(text, budget=4).proved


@pytest.mark.parametrize(
    ("what", "name", "axis"),
    [
        ("exp(-s)/2", "|H(jω)|", "ω  [rad/s]"),
        ("1.5/z^2", "|H(e^jθ)|", "θ of z = exp(jθ)  [rad]"),
        (([[-1, 2], [-2, -1]], np.eye(2), np.eye(2), np.zeros((2, 2))), "singular values of S", "ω  [rad/s]"),
        (signal.dlti([[0.5]], [[1]], [[1]], [[0]]), "singular values of S", "θ of z = exp(jθ)  [rad]"),
    ],
)
def test_pictures_tell_what_is_drawn(what, name, axis):
    """The curve reaches the largest gain, and the witness is marked."""
    verdict = is_bounded_real(what)
    axes = verdict.plot().axes[-1]
    assert axes.get_ylabel() == name
    assert axes.get_xlabel().endswith(axis)
    curve = next(line for line in axes.lines if name in str(line.get_label()))
    assert max(curve.get_ydata()) == pytest.approx(verdict.margins.reflection.value, rel=1e-4)
    marks = [line for line in verdict.plot().axes[0].lines if "witness" in str(line.get_label())]
    assert len(marks) == verdict.refuted


def test_pictures_and_notebooks():
    assert "<img" in is_positive_real("(s + 2)/(s^2 + s + 1)")._repr_html_()
    shown = is_positive_real("tanh(s) + Z2", ["Z2 positive real"])._repr_html_()
    assert "proved" in shown
    assert "<img" not in shown
    with pytest.raises(ExpressionError, match="plot: too large or too small to be drawn"):
        is_bounded_real(([["-1e400"]], [["1e400"]], [["1e-200"]], [["1/2"]])).plot()
    with pytest.raises(ExpressionError, match="there is no picture of this"):
        is_positive_real("tanh(s) + Z2", ["Z2 positive real"]).plot()


def test_long_proofs_take_one_screen():
    lets = "".join(f"let q{k + 1} = line(50, {k + 1}*s, q{k}); " for k in range(60))
    verdict = is_positive_real(f"let q0 = 25 + s; {lets} q60")
    assert len(str(verdict).splitlines()) <= 40
    assert "more steps" in str(verdict)
