"""Parameters of laws moved by SciPy, from force with 1 % noise; `python tests/attack.py identification` has more."""

import numpy as np
import pytest
from identified import TIMES, VELOCITY, random_law, record

from friction import MODELS, Dahl, InputError, Karnopp, LuGre, Sine, identify, prescribe


@pytest.mark.parametrize(("name", "seed"), [*((name, 7) for name in MODELS), ("tanh", (31, 5, 2001))])
def test_parameters_are_found(name, seed):
    """Beyond four deviations lies one estimate in 16,000; noise is 1 % of the largest force, and no more is left.

    The starts that miss the last one by least end where its friction has no viscous part.
    """
    rng = np.random.default_rng(seed)
    law = random_law(name, rng)
    force = record(law, rng)
    found = identify(TIMES, force, velocity=VELOCITY, models=(name,))
    best = found.fits[name]
    for key, value in best.parameters.items():
        assert abs(value - getattr(law, key)) < 4.0 * best.deviations[key], key
        assert found.interval(key)[0] < value < found.interval(key)[1]
        assert best.deviations[key] < 0.15 * value
    assert best.rms == pytest.approx(0.01 * np.abs(force).max(), rel=0.15)  # the largest force has noise as well
    assert best.foretold == pytest.approx(best.rms, rel=0.02)
    assert best.vague == []
    assert abs(found.correlation) < 0.1


def test_the_law_is_chosen_by_what_it_foretells():
    """Dahl is LuGre without peak and damping: both foretell alike, and the simpler one is taken."""
    rng = np.random.default_rng(8)
    force = record(Dahl(F_c=0.8, sigma0=2000.0), rng)
    found = identify(TIMES, force, velocity=VELOCITY, models=("coulomb", "lugre", "dahl"))
    assert found.chosen == "dahl"
    assert found.fits["lugre"].foretold == pytest.approx(found.fits["dahl"].foretold, rel=0.01)
    assert np.isnan(found.fits["coulomb"].foretold)


def test_places_do_as_well():
    """The place of the same motion in closed form, with noise of 1e-5 of the stroke, which the spline takes away."""
    rng, law = np.random.default_rng(9), Karnopp(1.0, 1.4, 0.8, 0.01)
    a, b, c = 0.4 * np.pi, 0.6 * np.pi, 3.4 * np.pi
    place = 0.03 * (np.sin(a * TIMES) / a - np.sin(b * TIMES) / b) - 0.004 / c * np.cos(c * TIMES)
    noisy = place + 1e-5 * np.ptp(place) * rng.normal(size=TIMES.size)
    found = identify(TIMES, record(law, rng), position=noisy, models=("karnopp",))
    for key, value in found.fits["karnopp"].parameters.items():
        assert value == pytest.approx(getattr(law, key), rel=0.1), key
    assert np.abs(found.v - VELOCITY).max() < 0.02 * np.abs(VELOCITY).max()


def test_what_the_data_do_not_tell_is_told():
    """Without a fall of friction v_s has no effect; viscous friction and F_c are one number at one speed."""
    rng, times = np.random.default_rng(10), np.linspace(0.0, 4.0, 401)
    steady = np.where(times % 2.0 < 1.0, 0.02, -0.02) + 1e-9 * rng.normal(size=times.size)
    force = 1.0 * np.sign(steady) + 0.01 * rng.normal(size=times.size)
    found = identify(times, force, velocity=steady, models=("coulomb",))
    assert found.fits["coulomb"].vague or np.isnan(found.fits["coulomb"].deviations["F_v"])
    run = prescribe(Dahl(), velocity=Sine(0.05, 1.0), t_end=4.0, times=times)
    noisy = run.F_f + 0.01 * rng.normal(size=times.size)
    slow = identify(times, noisy, velocity=run.v, models=("lugre",)).fits["lugre"]
    assert any("v_s" in names for names in slow.vague) or np.isnan(slow.deviations["F_s"])


def test_a_law_that_leaves_something_out_says_so():
    rng = np.random.default_rng(11)
    run = prescribe(LuGre(), velocity=Sine(0.05, 1.0), t_end=4.0)
    force = run.F_f + 0.01 * rng.normal(size=run.t.size)
    found = identify(run.t, force, velocity=run.v, models=("coulomb",))
    assert "what is left is not noise" in str(found)


T, F, V = np.linspace(0.0, 1.0, 60), np.sin(np.linspace(0.0, 9.0, 60)), np.cos(np.linspace(0.0, 9.0, 60))


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"t": T[::-1]}, r"t\[1\]: time does not rise"),
        ({"t": T[:20], "force": F[:20], "velocity": V[:20]}, "t: too few samples, expected 50 to 100,000, got 20"),
        ({"force": F[:-1]}, "force: not as long as t, expected 60 samples, got 59"),
        (
            {"force": np.where(T > 0.5, np.nan, F)},
            r"force\[30\]: a gap, expected a number for each sample, got 30 without",
        ),
        ({"force": np.ones(60)}, "force: constant"),
        ({"velocity": np.zeros(60)}, "velocity: constant, expected a motion"),
        ({"velocity": ["a"] * 60}, "velocity: not numbers"),
        ({"position": V}, "motion: not one, expected velocity or position"),
        ({"models": ("stribeck",)}, "models: unknown"),
        ({"models": ()}, "models: none"),
        ({"folds": 1}, "folds: not a number of blocks"),
    ],
)
def test_bad_records(given, sentence):
    with pytest.raises(InputError, match=f"^{sentence}"):
        identify(**({"t": T, "force": F, "velocity": V} | given))
