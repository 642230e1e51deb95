"""Laws, circuits and lines compute what they say, and refuse what they cannot."""

import math
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from flint import acb

from tline.errors import InputError
from tline.loss import (
    ConstantLoss,
    DielectricLoss,
    EarthReturn,
    Foster,
    LaminarFriction,
    LossyLine,
    RoundWire,
    SkinEffect,
    Sum,
    TurbulentFriction,
    hagen_poiseuille,
    kelvin_voigt_wall,
    realise,
    smooth_pipe_resistance,
    tabulated,
)
from tline.loss.line import Losses
from tline.scene.file import read_scene
from tline.solver.description.lines import Fit, Line, circuits_of
from tline.study.reference.lossy import lossy_response

WATER = {"density": 998.0, "viscosity": 1e-3, "radius": 0.011}
LAWS = {
    "constant": ConstantLoss(20, 250e-9),
    "skin": SkinEffect(5, 1e-3) + ConstantLoss(0, 250e-9),
    "wire": RoundWire(0.5e-3, 5.8e7),
    "dielectric": DielectricLoss(1e-10, 0.02, 1e9, (1e4, 1e12)),
    "earth": EarthReturn(10, 100),
    "laminar": LaminarFriction(**WATER),
    "turbulent": TurbulentFriction(**WATER, reynolds=5e4),
    "wall": kelvin_voigt_wall(1.2e-11, 0.025, 6e-3, [(1e-10, 0.05), (1.1e-10, 0.5)]),
}
CABLE = LossyLine(ConstantLoss(20, 250e-9), ConstantLoss(0, 100e-12), 0.2)


@pytest.mark.parametrize("name", LAWS)
def test_doubles_agree_with_balls(name):
    points = np.array([1e-3, 2.0, 3e4 + 1j, 1e-6j, 5j, 1e4j, 2e9j, 1e8 + 1e10j, -3e3 + 4e3j])
    exact = [complex(LAWS[name].at_precision(s, 30)) for s in points.tolist()]
    np.testing.assert_allclose(LAWS[name].at(points), exact, rtol=2e-14)  # a few roundings


@pytest.mark.parametrize("name", LAWS)
def test_balls_have_the_digits_asked(name):
    value, finer = (LAWS[name].at_precision(acb(7, 11), digits) for digits in (25, 80))
    assert value.rel_accuracy_bits() >= 25 * math.log2(10)
    assert value.overlaps(finer)


@pytest.mark.parametrize("name", LAWS)
def test_loss_and_storage_are_the_limits(name):
    law = LAWS[name]
    assert law.at(0) == law.loss
    far = 1e60
    assert complex(law.at_precision(far, 20)).real / far == pytest.approx(law.storage, rel=1e-12, abs=1e-30)


def test_sums_add():
    a, b = ConstantLoss(3, 2.0), SkinEffect(1, 0.5)
    assert (a + b).at(2j) == a.at(2j) + b.at(2j)
    assert ((a + b).loss, (a + b).storage) == (4, 2)


def test_quotient_of_bessel_functions_beyond_what_scipy_computes():
    tiny, huge = LaminarFriction(**WATER).at([1e-12j, 1e24j])
    assert tiny.real == pytest.approx(LaminarFriction(**WATER).loss, rel=1e-14)
    exact = complex(LaminarFriction(**WATER).at_precision(1e24j, 20))
    assert abs(huge - exact) < 1e-15 * abs(exact)


def test_points_on_the_cut_and_bad_digits_are_refused():
    law = SkinEffect(1, 1)
    with pytest.raises(InputError, match=r"off the negative real axis, got \(-1\+0j\)"):
        law.at([1j, -1])
    with pytest.raises(InputError, match="off the negative real axis, got"):
        law.at(complex("nan"))
    with pytest.raises(InputError, match="digits: not in range, expected 1 to 1000, got 0"):
        law.at_precision(1j, 0)
    with pytest.raises(InputError, match="no 20 digits there"):
        law.at_precision(acb(acb("1 +/- 0.1").real), 20)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: ConstantLoss(-1, 1), "loss: negative or no number, expected a finite number from 0 on, got -1"),
        (lambda: ConstantLoss(1, math.inf), "storage: negative or no number"),
        (lambda: SkinEffect(0, 0), "resistance_or_surface: not positive"),
        (lambda: EarthReturn(10, -1), "resistivity: not positive, expected a finite number above 0, got -1"),
        (lambda: RoundWire(0, 5e7), "radius: not positive, expected a finite number above 0, got 0"),
        (
            lambda: DielectricLoss(1e-10, 0.02, 1e3, (1e4, 1e12)),
            "frequency: not inside the band, expected between 10000",
        ),
        (lambda: DielectricLoss(1e-10, 0.3, 1e5, (1e4, 1e12)), "loss_tangent: too much for so wide a band"),
        (lambda: LaminarFriction(1000, math.nan, 0.01), "viscosity: not positive"),
        (lambda: TurbulentFriction(**WATER, reynolds=1500), "reynolds: out of range, expected 2000 to 1e+08, got 1500"),
        (lambda: smooth_pipe_resistance(**WATER, reynolds=3e3), "reynolds: out of range, expected 4000 to 1e+08"),
        (lambda: kelvin_voigt_wall(1e-11, 0.02, 6e-3, []), "creep: no element"),
        (lambda: kelvin_voigt_wall(1e-11, 0.02, 6e-3, [(1e-10, -1)]), "creep[0].time: not positive"),
        (lambda: Foster(0, 0, [1, 2], [1]), "rates: not one for each strength, expected (2,), got (1,)"),
        (lambda: Foster(0, 0, [1, -2], [1, 1]), "strengths[1]: not positive"),
        (lambda: realise(SkinEffect(0, 1), (10, 1), 1e-3), "band: not from low to high"),
        (lambda: realise(SkinEffect(0, 1), (0, 1), 1e-3), "low: not positive"),
        (lambda: realise(SkinEffect(0, 1), (1, 10), 1e-14), "tolerance: out of range"),
        (lambda: LossyLine(ConstantLoss(1, 1), ConstantLoss(1), 1), "shunt: has no storage"),
        (lambda: LossyLine(ConstantLoss(0, 0), ConstantLoss(0, 1), 1), "series: no impedance at all"),
        (lambda: LossyLine(ConstantLoss(1, 1), ConstantLoss(0, 1), -2), "length: not positive"),
    ],
)
def test_bad_parameters_are_refused_in_a_sentence(make, says):
    with pytest.raises(InputError) as refusal:
        make()
    assert str(refusal.value).startswith(says)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"times": []}, "times: none or not above 0"),
        ({"times": [0]}, "times: none or not above 0"),
        ({"times": [1.0]}, "times: too many passages, expected at most 1e-06 s, got 1 s"),
        ({"position": 0.3}, "position: not on the line, expected 0 to 0.2 m, got 0.3"),
        ({"source": math.inf}, "source: no passive resistance"),
        ({"load": -1}, "load: no passive resistance"),
        ({"digits": 101}, "digits: not in range, expected 1 to 100, got 101"),
    ],
)
def test_bad_questions_are_refused_in_a_sentence(change, says):
    with pytest.raises(InputError) as refusal:
        lossy_response(**{"line": CABLE, "times": [1e-9], "position": 0.2, "source": 50, "load": 50} | change)
    assert str(refusal.value).startswith(says)


def test_nothing_arrives_before_the_front():
    found = lossy_response(CABLE, [0.5e-9, 0.999e-9], 0.2, source=50, load=50)
    assert found.u == found.y == (0, 0)


def test_a_circuit_needs_no_more_terms_than_it_has():
    law = LAWS["wall"]
    found = realise(law, (0.01, 100), 1e-9)
    np.testing.assert_allclose(found.circuit.rates, np.sort(law.rates), rtol=1e-9)
    for law in (ConstantLoss(2, 3), ConstantLoss(0)):
        assert len(realise(law, (1, 10), 1e-9).circuit.rates) == 0


def test_a_table_can_be_realised_with_fewer_terms():
    f = np.geomspace(1e4, 1e9, 60)
    z = LAWS["wire"].at(2j * np.pi * f)
    table = tabulated(f, z.real, z.imag / (2 * np.pi * f), 1e-3)
    found = realise(table, (1e4, 1e9), 1e-3)
    assert len(found.circuit.rates) < len(table.rates)
    assert found.verdict.status == "proved"


def test_a_realisation_says_how_far_it_is_off():
    found = realise(LAWS["laminar"], (0.01, 1e3), 1e-3)
    f = np.geomspace(0.01, 1e3, 777)
    assert found.errors(f).max() == pytest.approx(found.error, rel=0.02)  # other frequencies, between the same peaks
    assert found.errors([1e7, 1e-7]).max() < 1e-3  # storage and loss are exact


def test_a_tolerance_out_of_reach_is_refused(monkeypatch):
    monkeypatch.setattr(import_module("tline.loss.realise"), "MOST_TERMS", 6)
    with pytest.raises(
        InputError, match="tolerance: not reached with 6 terms, expected a larger one or a narrower band"
    ):
        realise(SkinEffect(0, 1), (1e-3, 1e9), 1e-6)


def test_a_table_that_is_passive_is_taken_and_one_that_is_not_is_refused():
    f = np.concatenate([[0], np.geomspace(1e3, 1e9, 40)])
    z = LAWS["skin"].at(2j * np.pi * f)
    inductance = np.concatenate([[350e-9], z.imag[1:] / (2 * np.pi * f[1:])])
    law = tabulated(f, z.real, inductance, 1e-3)
    between = 2j * np.pi * np.geomspace(2e3, 5e8, 31)
    assert np.abs(law.at(between) / LAWS["skin"].at(between) - 1).max() < 1e-3
    with pytest.raises(InputError, match=r"no passive law comes closer than .* to the row at"):
        tabulated(f, z.real, np.full_like(f, 250e-9), 1e-3)  # resistance that rises, inductance that does not fall
    with pytest.raises(InputError, match="no passive law"):
        tabulated([1, 2, 3], [1, 5, 1], [1, 1, 1], 1e-3)


@pytest.mark.parametrize(
    ("table", "says"),
    [
        (([1, 2], [1, 1], [1]), "table: shape"),
        (([1, 1], [1, 1], [1, 1]), "frequencies: not ascending"),
        (([0], [1], [1]), "frequencies: not ascending"),
        (([1, 2], [1, -1], [1, 1]), "table[1]: bad row"),
        (([1, 2], [1, math.nan], [1, 1]), "table[1]: bad row"),
    ],
)
def test_bad_tables_are_refused(table, says):
    with pytest.raises(InputError) as refusal:
        tabulated(*table, 1e-3)
    assert str(refusal.value).startswith(says)


def test_the_distortionless_case_is_recognised():
    assert LossyLine(ConstantLoss(2, 1), ConstantLoss(0.5, 0.25), 3).distortionless
    assert LossyLine(ConstantLoss(0.3, 0.1), ConstantLoss(0.6, 0.2), 3).distortionless  # to rounding
    assert LossyLine(ConstantLoss(0, 1), ConstantLoss(0, 1), 3).distortionless
    assert not CABLE.distortionless
    assert not LossyLine(LAWS["skin"], ConstantLoss(0, 1e-10), 3).distortionless


def test_a_chain_at_zero_frequency_is_a_resistance():
    np.testing.assert_allclose(CABLE.chain(0), [[1, 4], [0, 1]])
    assert CABLE.zc(0) == np.inf
    assert CABLE.input_impedance(0, 46) == 50
    assert CABLE.input_impedance(0, np.inf) == np.inf
    assert hagen_poiseuille(1000, 1e-3, 0.01).loss == pytest.approx(8e-3 / (math.pi * 1e-8))


def test_input_impedance_of_long_lines_does_not_overflow():
    long = LossyLine(ConstantLoss(20, 250e-9), ConstantLoss(0, 100e-12), 1e6)
    assert long.input_impedance(1e10j, 3) == pytest.approx(complex(long.zc(1e10j)), rel=1e-14)


@pytest.mark.parametrize("load", [0, 75, 30 - 20j])
def test_input_impedance_follows_from_the_chain_matrix(load):
    s = np.array([1e8j, 3e9j, 1e9 + 1e9j])
    (a, b), (c, d) = np.moveaxis(CABLE.chain(s), 0, -1)
    np.testing.assert_allclose(CABLE.input_impedance(s, load), (a * load + b) / (c * load + d), rtol=1e-13)


@pytest.mark.parametrize("file", ["pipe_friction.toml", "lossy_cable.toml", "town.toml"])
def test_scenes_with_losses_that_say_the_same_are_equal(file):
    path = Path(__file__).parents[2] / "scenes" / file
    assert read_scene(path) == read_scene(path)
    lines = read_scene(path).lines.values()
    assert {line.losses.exact for line in lines if line.losses} == {line.losses.exact for line in lines if line.losses}


def test_laws_are_equal_by_what_they_are_made_of():
    assert SkinEffect(0, 1e-3) + ConstantLoss(1, 2) == SkinEffect(0, 1e-3) + ConstantLoss(1, 2)
    one, other = Foster(0.3, 0, [1, 2], [3, 4]), Foster(0.3, 0, [1, 2], [3, 4])
    assert one.verdict.proved
    assert one == other
    assert hash(one) == hash(other)
    assert one != Foster(0.3, 0, [1, 2], [3, 5])
    assert ConstantLoss(0, 1) != Foster(0, 1, [], [])


def test_many_laws_that_differ_by_scale_share_circuits_as_good_as_their_own():
    """Friction of twelve pipes of other widths, within the tolerance of the law itself in the whole band."""
    fit = Fit(low=0.01, high=100.0, tolerance=1e-5, fastest=1e4)
    radii = np.geomspace(0.05, 0.6, 12)
    laws = [Sum(ConstantLoss(1e3, 0.0), TurbulentFriction(1000, 1e-3, r, 1e5)) for r in radii]
    pairs = [LossyLine(law, ConstantLoss(0.0, 1e-9), 100.0) for law in laws]
    lines = {f"p{k}": Line(("a", "b"), 1e6, 1.0, Losses(pair)) for k, pair in enumerate(pairs)}
    found = circuits_of(lines, fit)
    s = 2j * np.pi * np.geomspace(fit.low, fit.high, 333)
    for law, each in zip(laws, found.values(), strict=True):
        error = np.abs(each.series.at(s) / law.at(s) - 1).max()
        assert error <= 1.05 * each.error
        assert each.error <= fit.tolerance
    assert len({each.series.rates.size for each in found.values()}) < len(laws)
