"""The exercise's own texts against the model: its Modelica parts, solved as printed, and the pulley's two balances."""

import math
import random
import re

import numpy as np
import pytest
from drives_parts import ASSEMBLY, BELT, DRIVE, PULLEY

from drives import PI, Belt, CoupledDrives, Design, Pulley, Spool, Torque, check_pulley, design, reach, simulate_control

UNEQUAL = CoupledDrives(
    Spool(2e-3, 0.03, 0.07), Spool(5e-4, 0.2, 0.13), Belt(40, 0.3), Belt(90, 0.05), Pulley(150, math.radians(37))
)
NAME = re.compile(r"[A-Za-z_][A-Za-z_0-9.]*")


def parameters_of(drives):
    spools = [{"J": x.inertia, "B": x.friction, "r": x.radius} for x in (drives.left, drives.right)]
    belts = [{"K": x.stiffness, "B": x.damping} for x in (drives.left_belt, drives.right_belt)]
    found = {
        "drive1": (DRIVE, spools[0] | {"sign": -1}),
        "drive2": (DRIVE, spools[1] | {"sign": 1}),
        "belt1": (BELT, belts[0]),
        "belt2": (BELT, belts[1]),
        "pulley": (PULLEY, {"k": drives.pulley.stiffness, "theta": drives.pulley.angle}),
    }
    return {name: (text, {k: float(v) for k, v in given.items()}) for name, (text, given) in found.items()}


def equations(drives):
    """All equations, as printed, as functions that take the unknowns and der and give left less right."""
    found = []
    for name, (text, given) in parameters_of(drives).items():
        for line in text.partition("equation\n")[2].splitlines():
            if "=" in line:
                left, _, right = line.strip().rstrip(";").partition(" = ")
                written = NAME.sub(
                    lambda m, name=name, given=given: (
                        m[0]
                        if m[0] in ("der", "cos")
                        else f"{given[m[0]]!r}"
                        if m[0] in given
                        else f"x['{name}.{m[0]}']"
                    ),
                    f"({left}) - ({right})",
                )
                found.append(written)
    for first, second in re.findall(r"connect\(([\w.]+), ([\w.]+)\)", ASSEMBLY):
        found += [f"x['{first}.v'] - x['{second}.v']", f"x['{first}.f'] + x['{second}.f']"]
    return found


def pencil(drives):
    """A, B and the names with A x + B der(x) = 0; the last two names are the torques."""
    texts = equations(drives)
    names = sorted({name for text in texts for name in re.findall(r"x\['([\w.]+)'\]", text)})
    names = [n for n in names if not n.endswith(".T")] + ["drive1.T", "drive2.T"]

    def rows(text, name, s):
        # ours to evaluate: the text is a constant of the package
        scope = {"x": {n: float(n == name) for n in names}, "der": lambda v: s * v, "cos": math.cos}
        return eval(text, scope)

    zero, one = (np.array([[rows(text, name, s) for name in names] for text in texts]) for s in (0.0, 1.0))
    return zero, one - zero, names


@pytest.mark.parametrize("drives", [CoupledDrives(), UNEQUAL], ids=["exercise", "unequal"])
def test_the_printed_modelica_parts_are_the_model(drives):
    a, b, names = pencil(drives)
    assert a.shape[0] == len(names) - 2  # as many equations as unknowns
    for s in (1j, 3.0 + 20j, 500j):
        unknown = np.linalg.solve((a + s * b)[:, :-2], -(a + s * b)[:, -2:])
        seen = dict(zip(names, unknown, strict=False))
        for output, name in (("x_k", "pulley.x_k"), ("tension", "pulley.F"), ("w1", "drive1.w"), ("w2", "drive2.w")):
            expected = [drives.transfer(output, source)(s) for source in ("T1", "T2")]
            assert seen[name] == pytest.approx(expected, rel=1e-9)  # rounding of a solve with 19 unknowns


def test_the_printed_parts_have_one_state_too_many():
    a, b, _ = pencil(UNEQUAL)
    # det(A + s B) over s^2 is a constant near 0 and over s is not bounded: 0 is a pole twice
    sizes = [abs(np.linalg.det((a + s * b)[:, :-2])) for s in (1e-2, 1e-3)]
    assert math.log10(sizes[0] / sizes[1]) == pytest.approx(2, abs=0.05)


def test_both_balances_give_the_model_s_pulley():
    rng = random.Random(7)
    for _ in range(200):
        pulley = Pulley(10 ** rng.uniform(-2, 4), rng.uniform(0.02, 1.55))
        found = check_pulley(pulley, rng.uniform(-1, 1))
        # the balances as two equations, from the directions of the three forces alone
        theta = pulley.angle
        left, right, up = (-math.sin(theta), -math.cos(theta)), (math.sin(theta), -math.cos(theta)), (0.0, 1.0)
        spring = -float(pulley.stiffness) * found.x_k
        total = np.array(left) * found.F1 + np.array(right) * found.F2 + np.array(up) * spring
        assert np.abs(total).max() < 1e-12 * abs(spring)
        assert pytest.approx(found.by_model, rel=1e-12) == found.F1
        assert pytest.approx(found.by_stiffness, rel=1e-12) == found.F2
        assert abs(found.power) < 1e-12 * abs(spring)


@pytest.mark.parametrize("drives", [CoupledDrives(), UNEQUAL], ids=["exercise", "unequal"])
def test_under_a_limit_runs_end_where_the_limit_allows(drives):
    made, limit = design(drives), 2.0
    inside = reach(drives, 0.3, 3.0, limit)
    assert inside.holds
    assert inside.tension_at_speed is not None
    v, f = 0.3, inside.tension_at_speed[1] * 0.98
    run = simulate_control(made, Torque.step(v), Torque.step(f), limit=limit, t_end=3.0, step=0.1)
    assert run.verdicts == ()
    assert run.outputs["belt_speed"][-1] == pytest.approx(v, rel=1e-3)
    assert run.outputs["tension"][-1] == pytest.approx(f, rel=1e-3)
    assert [run.outputs[name][-1] for name in ("T1", "T2")] == pytest.approx(
        [reach(drives, v, f, limit).T1, reach(drives, v, f, limit).T2], rel=1e-2
    )
    # far too much of the tension: both motors at their limit hold the largest there is
    most = reach(drives, v, 1e3, limit)
    run = simulate_control(made, Torque.step(v), Torque.step(1e3), limit=limit, t_end=3.0, step=0.1)
    assert most.speed_at_tension is None
    assert run.outputs["tension"][-1] == pytest.approx(most.tension[1], rel=1e-3)
    assert run.verdicts[0].startswith(
        f"from 0 s on, a belt speed of {v:.4g} m/s and a tension of 1000 N cannot be held"
    )
    # too much speed: the tension comes first and is held
    fast = reach(drives, 1e3, 3.0, limit)
    assert fast.speed_at_tension is not None
    run = simulate_control(made, Torque.step(1e3), Torque.step(3.0), limit=limit, t_end=3.0, step=0.1)
    assert run.outputs["tension"][-1] == pytest.approx(3.0, rel=1e-3)
    assert run.outputs["belt_speed"][-1] == pytest.approx(fast.speed_at_tension[1], rel=1e-3)
    assert len(run.verdicts) == 1


def test_an_unstable_design_is_called_so():
    made = design(CoupledDrives())
    bad = Design(made.drives, PI(-1, 0.01), made.tension, made.speed_plant, made.tension_plant)
    assert made.verdicts == ()
    assert bad.verdicts == ("the speed loop is unstable: a closed-loop pole at 50 rad/s",)
    short = simulate_control(bad, Torque.step(1.0), t_end=1.0, step=0.1)
    assert short.verdicts == ("the loop is unstable: a pole at 50 rad/s",)
    growth = np.diff(np.log(np.abs(short.outputs["belt_speed"][5:])))
    assert growth == pytest.approx(np.full(len(growth), 5.0), rel=1e-9)  # it grows at the rate the verdict says
    with pytest.raises(
        ValueError, match=r"^simulation: beyond the range of floats.*a pole at 50 rad/s, lost at 7.* s$"
    ):
        simulate_control(bad, Torque.step(1.0), t_end=200.0, step=0.1)
    saturated = simulate_control(bad, Torque.step(1.0), limit=2.0, t_end=1.0, step=0.1)
    assert saturated.verdicts == short.verdicts
