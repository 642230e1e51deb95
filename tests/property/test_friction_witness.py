"""The witness of friction: silent about runs of the contact given, not about those of another."""

import sys
from dataclasses import fields, replace

import numpy as np
import pytest
from click.testing import CliRunner

import friction
from friction import Coulomb, Karnopp, LuGre, Ramp, Sine, Spring, Status, Steps, Tanh, Testbench, simulate
from friction.result import COLUMNS
from friction.witness import doubt, windows
from tline.cli.main import main

LAWS = {
    "coulomb": Coulomb(F_v=0.1),
    "karnopp": Karnopp(v_s=0.4),
    "zone": Karnopp(v_s=0.4, delta=0.05),
    "lugre": LuGre(v_s=0.4, sigma1=5.0),
    "dahl": friction.Dahl(),
    "elasto-plastic": friction.ElastoPlastic(v_s=0.4, sigma1=5.0),
    "tanh": Tanh(v_s=0.4, epsilon=0.02),
}
T_END = 6.0
BENCH = Testbench(Sine(1.6, 0.4, offset=0.3), mass=1.2, v0=0.2, spring=Spring(0.7, 0.3))


def power(rng, low, high):
    return float(10.0 ** rng.uniform(low, high))


def random_law(rng, name):
    """With or without viscous friction and damping, weak or strong."""
    f_c = power(rng, -1, 1)
    f_s, f_v = f_c * rng.uniform(1.0, 1.6), float(rng.choice([0.0, 0.1]))
    stiffness = f_c * power(rng, 2, 5)
    bristles = {"sigma0": stiffness, "sigma1": float(rng.choice([0.0, 0.02])) * stiffness**0.5, "sigma2": f_v}
    curve = {"F_c": f_c, "F_s": f_s, "v_s": power(rng, -2, 1)}
    return {
        "coulomb": lambda: Coulomb(f_c, f_v),
        "karnopp": lambda: Karnopp(**curve, F_v=f_v),
        "zone": lambda: Karnopp(f_c, f_s, 0.0, power(rng, -1, 1), 0.01),
        "lugre": lambda: LuGre(**curve, **bristles),
        "dahl": lambda: friction.Dahl(f_c, stiffness),
        "elasto-plastic": lambda: friction.ElastoPlastic(
            **curve, **bristles, z_ba=rng.uniform(0.2, 0.95) * f_c / stiffness
        ),
        "tanh": lambda: Tanh(**curve, F_v=f_v, epsilon=power(rng, -3, -1)),
    }[name]()


def random_bench(rng, size, t_end):
    """A load between a tenth and three times what the contact holds."""
    load, corners = size * power(rng, -1, 0.5), int(rng.integers(1, 20))
    times = np.linspace(0.0, t_end, corners + 1)[:-1].tolist()
    values = rng.uniform(-load, load, corners).tolist()
    force = (
        Ramp(load / t_end, rng.uniform(-0.2, 0.2) * load),
        Sine(load, power(rng, -1, 1), rng.uniform(-0.2, 0.2) * load),
        Steps(times, values),
        friction.Table(times, values),
        Ramp(0.0),
    )[rng.integers(5)]
    pulled = isinstance(force, Ramp) and not force.slope
    spring = Spring(power(rng, 0, 2), load) if pulled or rng.random() < 0.3 else None
    return Testbench(force, power(rng, -1, 1), float(rng.choice([0.0, rng.uniform(-1.0, 1.0)])), spring)


@pytest.mark.parametrize("name", LAWS)
def test_nothing_is_said_of_what_is_right(name):
    heard = 0
    for seed in range(40):
        rng = np.random.default_rng([list(LAWS).index(name), seed])
        law, t_end = random_law(rng, name), power(rng, -1, 1)
        smooth = name not in ("coulomb", "karnopp", "zone")
        run = simulate(law, random_bench(rng, law.F_c, t_end), t_end, tol=power(rng, -9, -2) if smooth else None)
        assert run.doubt is None, seed
        heard += run.status is Status.DONE
    assert heard >= 30


def heard(law, bench):
    """A run, also at the instants at which it is heard."""
    times = np.union1d(np.linspace(0.0, T_END, 101), windows(law, bench, T_END))
    run = simulate(law, bench, T_END, times=times)
    assert run.status is Status.DONE
    return run


def said(name, run, bench=BENCH, **wrong):
    """What is said of a run that goes for one of this law on this bench."""
    columns = {column: getattr(run, column) for column in COLUMNS} | wrong
    at = np.searchsorted(run.t, windows(LAWS[name], bench, T_END))
    return doubt(LAWS[name], bench, columns, at, run.errors, [event.t for event in run.events])


@pytest.mark.parametrize("name", LAWS)
def test_one_per_cent_of_any_parameter_is_found(name):
    law = LAWS[name]
    assert said(name, heard(law, BENCH)) is None
    for field in (field for field in fields(law) if getattr(law, field.name)):
        assert said(name, heard(replace(law, **{field.name: 1.01 * getattr(law, field.name)}), BENCH)), field.name
    for other in (
        {"mass": 1.01 * BENCH.mass},
        {"v0": 1.01 * BENCH.v0},
        {"spring": Spring(0.707, 0.3)},
        {"spring": Spring(0.7, 0.303)},
        {"force": Sine(1.616, 0.4, offset=0.3)},
        {"force": Sine(1.6, 0.404, offset=0.3)},
        {"force": Sine(1.6, 0.4, offset=0.303)},
        {"force": Sine(1.6, 0.4, offset=0.3, phase=0.01)},
    ):
        assert said(name, heard(law, replace(BENCH, **other))), other


@pytest.mark.parametrize("name", LAWS)
def test_a_column_that_is_a_thousandth_off_is_found(name):
    run = heard(LAWS[name], BENCH)
    for column in ("x", "v", "F_a", "F_f", "W_a", "W_f", *(["z"] if run.z.any() else [])):
        assert said(name, run, **{column: 1.001 * getattr(run, column)}), column


def test_a_jump_that_is_lost_is_found():
    jump, none = (Testbench(Steps([0.0, 3.0], [2.0, last])) for last in (-1.0, 2.0))
    assert said("coulomb", heard(LAWS["coulomb"], none), bench=none) is None
    assert "F_a is 2, by Newton's law and the law of friction -1" in said("coulomb", heard(LAWS["coulomb"], none), jump)


def test_a_run_that_is_doubted_says_so_and_where(monkeypatch):
    module = sys.modules["friction.simulation"]
    right = module._events
    monkeypatch.setattr(module, "_events", lambda task, *rest: right(task._replace(model=Coulomb(1.1)), *rest))
    run = simulate(Coulomb(), Testbench())
    assert run.status is Status.DOUBTED
    assert run.doubt.startswith("two methods disagree at ")
    assert run.t.size == 1001
    told = CliRunner().invoke(main, ["friction", "run", "coulomb"])
    assert told.exit_code == 1
    assert f"NOT met: {run.doubt}\n" in told.output
