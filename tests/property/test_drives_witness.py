"""The witness of the drives, also with bearings that rub: silent about runs of the mechanism given alone."""

import random
from dataclasses import replace
from functools import cache
from typing import Any

import pytest
from flint import fmpq_mat

import drives.simulation
from drives import Belt, CoupledDrives, Energy, InputError, Pulley, Spool, Torque, design, simulate, simulate_control
from drives.by_hand import Control
from drives.discretise import legs
from drives.witness import doubts
from friction import Coulomb, Karnopp

SAID = "two methods disagree at "


def size(rng, decades):
    return float(f"{10 ** rng.uniform(-decades, decades):.3g}")


def random_drives(rng, decades):
    """Every fifth friction or damping is none."""
    spools, belts = (
        [[size(rng, decades) * (k != 1 or rng.random() > 0.2) for k in range(n)] for _ in range(2)] for n in (3, 2)
    )
    pulley = Pulley(size(rng, decades), round(rng.uniform(0.01, 1.56), 3))
    return CoupledDrives(Spool(*spools[0]), Spool(*spools[1]), Belt(*belts[0]), Belt(*belts[1]), pulley)


def random_torque(rng, end, corners):
    times = sorted({round(rng.random(), 3) * end for _ in range(corners)} or {0.0})
    return Torque.table(times, [rng.uniform(-5, 5) for _ in times], held=rng.random() < 0.5)


def random_run(kind, seed):
    rng = random.Random(f"{kind} {seed}")
    linear = kind in ("torques", "control")
    made = random_drives(rng, {"torques": 3, "control": 2}.get(kind, 1))
    step = size(rng, 3) if linear else 0.006 * size(rng, 1)  # far beyond all time constants, and far below
    end = rng.choice([1, 3, 20]) * step
    first, second, third = (random_torque(rng, end, corners) for corners in (rng.randint(0, 2), 0, rng.randint(0, 1)))
    start = {name: rng.uniform(-0.5, 0.5) for name in made.states if rng.random() < 0.5}
    how = {"t_end": end, "step": step, "initial": start}
    if kind in ("torques", "slack"):
        return simulate(made, first, second, **how, slack=kind == "slack")
    how |= {"d1": third, "limit": size(rng, 1) if kind == "limit" else None, "antiwindup": rng.random() < 0.7}
    return simulate_control(design(made), first, second, **how)


@pytest.mark.parametrize(("kind", "runs"), [("torques", 40), ("control", 10), ("slack", 10), ("limit", 5)])
def test_nothing_is_said_of_what_is_right(kind, runs):
    heard = 0
    for seed in range(10 * runs):
        try:
            run = random_run(kind, seed)
        except InputError:  # no controller of the rule
            continue
        assert [one for one in run.verdicts if one.startswith(SAID)] == []
        heard += 1
        if heard == runs:
            return
    pytest.fail("too few runs")


DRIVES = CoupledDrives(right=Spool(2e-3, 0.05, 0.08), right_belt=Belt(60, 0.3), pulley=Pulley(200, 0.8))
TORQUES = Torque.table([0.0, 0.5, 1.1], [0.1, -0.4, 0.3]), Torque.table([0.0, 0.7], [0.1, 0.5], held=True)
POINTS = Torque.step(1.0), Torque.step(5.0, 0.3), Torque.step(0.3, 1.0), Torque.step(0.0)
KINDS = ("torques", "long steps", "control", "slack", "limit")


@cache
def heard(kind):
    """A run, and what the witness is told beside the parts."""
    if kind in ("torques", "long steps"):
        return simulate(DRIVES, *TORQUES, t_end=2.0, step=0.4 if kind == "long steps" else 0.01), {"inputs": TORQUES}
    if kind == "slack":
        return simulate(DRIVES, *TORQUES, t_end=2.0, step=0.02, slack=True), {"inputs": TORQUES, "slack": True}
    made, limit = design(DRIVES), 1.0 if kind == "limit" else None
    run = simulate_control(made, *POINTS[:2], d1=POINTS[2], limit=limit, t_end=2.0, step=0.02)
    gains = [(float(one.gain), float(one.integral_time)) for one in (made.speed, made.tension)]
    control = Control(*gains) if limit is None else Control(*gains, limit)
    return run, {"inputs": POINTS, "control": control}


def said(run, told, parts=DRIVES):
    told = dict(told)
    return doubts(parts, told.pop("inputs"), run, **told)


@pytest.mark.parametrize("kind", KINDS)
def test_the_runs_that_faults_are_put_into_are_right(kind):
    assert said(*heard(kind)) == ()


@pytest.mark.parametrize("kind", KINDS)
def test_one_per_cent_of_any_parameter_is_found(kind):
    for part in ("left", "right", "left_belt", "right_belt", "pulley"):
        old = getattr(DRIVES, part)
        keys = [key for key in ("inertia", "friction", "radius", "stiffness", "damping", "angle") if hasattr(old, key)]
        for key in keys:
            values = {name: float(getattr(old, name)) * (1.01 if name == key else 1) for name in keys}
            found = said(*heard(kind), replace(DRIVES, **{part: type(old)(**values)}))
            assert [one[: len(SAID)] for one in found] == [SAID], (part, key)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("change", [
    lambda x, t, e: x.update(x_k=-x["x_k"]),
    lambda x, t, e: x.update(tension=2 * x["tension"]),
    lambda x, t, e: x.update(belt_speed=1.01 * x["belt_speed"]),
    lambda x, t, e: x.update(phi2=x["phi2"] + 1e-6 * t),
    lambda x, t, e: x.update(w1=x["w2"], w2=x["w1"]),
    lambda x, t, e: e.update(supplied=1.001 * e["supplied"]),
    lambda x, t, e: e.update(dissipated=0.999 * e["dissipated"]),
    lambda x, t, e: e.update({name: 1.01 * e[name] for name in e}),
    lambda x, t, e: e.update(stored=e["stored"] + 1e-6 * e["stored"].max()),
], ids=["sign of x_k", "tension", "belt speed", "phi2", "spools", "work", "heat", "energies", "store"])  # fmt: skip
def test_what_is_given_out_wrong_is_found(kind, change):
    run, told = heard(kind)
    outputs, energy = dict(run.outputs), dict(vars(run.energy))
    change(outputs, run.t, energy)
    assert said(replace(run, outputs=outputs, energy=Energy(**energy)), told)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("change", [
    lambda one: Torque.step(one(0.0)),
    lambda one: replace(one, starts=tuple(1.01 * x for x in one.starts), slopes=tuple(1.01 * x for x in one.slopes)),
    lambda one: replace(one, slopes=tuple(x + 0.01 for x in one.slopes)),
], ids=["steps are lost", "1 % more", "a slope"])  # fmt: skip
def test_other_inputs_are_found(kind, change):
    run, told = heard(kind)
    assert said(run, told | {"inputs": [change(one) for one in told["inputs"]]})


@pytest.mark.parametrize("kind", ["control", "limit"])
@pytest.mark.parametrize("key", ["speed", "tension", "limit"])
def test_another_controller_is_found(kind, key):
    run, told = heard(kind)
    old = told["control"]
    if key == "limit":
        new = old._replace(limit=1.01 if kind == "limit" else 1.0)
    else:
        gain, integral = getattr(old, key)
        new = old._replace(**{key: (gain, 1.01 * integral)})
    assert said(run, told | {"control": new})


def test_integrals_that_wind_up_are_found():
    run, told = heard("limit")
    assert said(run, told | {"control": told["control"]._replace(antiwindup=False)})


def test_a_belt_that_pushes_is_found():
    run, told = heard("torques")
    assert said(run, told | {"slack": True})
    run, told = heard("slack")
    assert said(run, told | {"slack": False})


class Faulty(CoupledDrives):
    """The tension acts on spool 2 twice."""

    def state_space(self, *ports):
        model = super().state_space(*ports)
        rows = model.a.tolist()
        rows[2][3] *= 2
        return replace(model, a=fmpq_mat(rows))


@pytest.mark.parametrize(
    "run", [simulate, lambda *given, **how: simulate_control(design(given[0]), *POINTS[:2], **how)]
)
def test_a_fault_in_the_model_is_a_verdict_of_its_runs(run):
    verdicts = run(Faulty(), *TORQUES, t_end=1.0, step=0.1).verdicts
    assert [one[: len(SAID)] for one in verdicts] == [SAID]


def test_a_fault_in_the_way_is_a_verdict_of_the_run(monkeypatch):
    def without_slopes(*given):
        way = legs(*given)
        return replace(way, inputs=way.inputs * [1, 1, 0, 0])

    monkeypatch.setattr(drives.simulation, "legs", without_slopes)
    (verdict,) = simulate(DRIVES, *TORQUES, t_end=2.0, step=0.1).verdicts
    assert verdict.startswith(SAID)


def test_numbers_that_floats_cannot_follow_are_not_judged():
    stiff = CoupledDrives(left_belt=Belt(1e20, 1e-20))
    assert simulate(stiff, Torque.step(1.0), Torque.step(1.0), t_end=1.0, step=0.5).verdicts == ()


RUBBING = CoupledDrives(right=Spool(2e-3, 0.05, 0.08))
LAWS = Karnopp(F_c=0.04, F_s=0.06, F_v=0.01, v_s=2.0), Coulomb(F_c=0.03, F_v=0.0)


@pytest.mark.parametrize("seed", range(12))
def test_nothing_is_said_of_bearings_that_rub(seed):
    rng = random.Random(seed)
    laws = Karnopp(F_c=0.1 * rng.random(), F_s=0.1 + rng.random(), F_v=rng.random() / 10, v_s=rng.random()), None
    laws = laws if seed % 2 else (laws[1], Coulomb(F_c=rng.random(), F_v=0.0))
    how: dict[str, Any] = {"t_end": 0.5, "step": 0.01, "friction": laws, "slack": seed % 3 == 0}
    if seed < 6:
        assert simulate(RUBBING, *TORQUES, **how).verdicts == ()
    else:
        looks = (
            {"period": rng.uniform(1e-3, 0.02), "delay": rng.uniform(0.0, 0.01)} if seed % 2 else {"filter_time": 0.01}
        )
        how |= looks | ({"limit": 3.0} if seed % 4 < 2 else {})
        steered = simulate_control(design(RUBBING, 20, 20), Torque.step(0.2), Torque.step(5.0, 0.1), **how)
        assert not [one for one in steered.verdicts if "disagree" in one]


@cache
def run() -> Any:
    return simulate(RUBBING, *TORQUES, t_end=2.0, step=0.02, slack=True, friction=LAWS)


TOLD: dict[str, Any] = {"parts": RUBBING, "inputs": TORQUES, "slack": True, "dry": LAWS}


def test_the_run_that_faults_are_put_into_is_right():
    assert sum(map(len, run().events.values())) > 2
    assert doubts(run=run(), **TOLD) == ()


@pytest.mark.parametrize("change", [
    {"dry": (replace(LAWS[0], F_c=0.0404), LAWS[1])},
    {"dry": (replace(LAWS[0], F_v=0.0101), LAWS[1])},
    {"dry": (LAWS[0], replace(LAWS[1], F_c=0.0303))},
    {"dry": (LAWS[0], None)},
    {"parts": replace(RUBBING, left=Spool(1e-3, 0.101, 0.1))},
    {"slack": False},
])  # fmt: skip
def test_another_mechanism_is_found(change):
    (verdict,) = doubts(run=run(), **TOLD | change)
    assert verdict.startswith("two methods disagree at ")
