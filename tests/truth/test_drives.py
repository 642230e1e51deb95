"""The coupled drives against Lagrange's equations with a multiplier: exact in fractions, to 50 digits in mpmath."""

import math
import random
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from drives_twin import Numbers, precise, respond
from flint import fmpq, fmpq_poly

from drives import (
    INPUTS,
    OUTPUTS,
    Belt,
    CoupledDrives,
    Pulley,
    Spool,
    Torque,
    decoupled,
    design,
    largest_friction_with_peak,
    peak,
    relative_gain_array,
    simulate,
    simulate_control,
    symbolic_transfer,
    undamped_frequency,
)
from drives.number import roots
from drives.symbolic import SYMBOLS

EXERCISE = CoupledDrives()
UNEQUAL = CoupledDrives(
    Spool(2e-3, 0.03, 0.07), Spool(5e-4, 0.2, 0.13), Belt(40, 0.3), Belt(90, 0.05), Pulley(150, math.radians(37))
)
UNDAMPED_BELT = CoupledDrives(right_belt=Belt(70, 0), pulley=Pulley(300, math.radians(60)))
SWINGING = CoupledDrives(Spool(1e-3, 1e-3, 0.1), Spool(1e-3, 1e-3, 0.1), Belt(50, 0.05), Belt(50, 0.05))
HEAVY = CoupledDrives(UNEQUAL.left, UNEQUAL.right, UNEQUAL.left_belt, Belt(90, 0.4), Pulley(150, math.radians(37), 0.6))
ALL = {
    "exercise": EXERCISE, "unequal": UNEQUAL, "undamped belt": UNDAMPED_BELT, "swinging": SWINGING, "heavy": HEAVY,
}  # fmt: skip
every_drive = pytest.mark.parametrize("drives", ALL.values(), ids=list(ALL))


def some(rng, low=1, high=50):
    return Fraction(rng.randint(low, high), rng.randint(1, 50))


def random_drives(rng):
    spools = [Spool(some(rng), some(rng, 0), some(rng)) for _ in range(2)]
    belts = [Belt(some(rng), some(rng, 0)) for _ in range(2)]
    while True:
        pulley = Pulley(some(rng), rng.uniform(0.05, 1.5))
        if pulley.cosine_squared == pulley.cosine**2:  # not one of the angles whose cosine is no fraction
            return CoupledDrives(*spools, *belts, pulley)


def horner(coefficients, s):
    value = s * 0
    for c in coefficients:
        value = value * s + c
    return value


@pytest.mark.parametrize("seed", range(25))
def test_transfer_functions_are_exact(seed):
    rng = random.Random(seed)
    drives, s = random_drives(rng), some(rng)
    for k, source in enumerate(INPUTS):
        told = respond(Numbers(drives, Fraction), s, k)
        for output in OUTPUTS:
            h = drives.transfer(output, source)
            assert horner(h.numerator, s) / horner(h.denominator, s) == told[output], (output, source)
            p, q = drives.state_space((output,), (source,)).minimal().transfer(0, 0)
            assert (p, q) == (h.p, h.q)  # the state space has it too, and no hidden mode


@pytest.mark.parametrize("equal", [False, True])
def test_symbols_stand_for_any_numbers(equal):
    rng = random.Random(3)
    values = {name: some(rng) for name in ("J", "B", "r", "K", "Bb", *SYMBOLS)}
    if equal:
        values |= {name: values[name.rstrip("12")] for name in SYMBOLS if name[-1] in "12"}

    class Given:
        j, b, r = ([values[f"{n}{i}"] for i in (1, 2)] for n in "JBr")
        stiffness, damping = ([values[f"{n}{i}"] for i in (1, 2)] for n in ("K", "Bb"))
        k, c = values["k"], values["c"]

    for k, source in enumerate(INPUTS):
        told = respond(Given, values["s"], k)
        for output in OUTPUTS:
            p, q = symbolic_transfer(output, source, equal=equal)
            assert evaluate(p, values) / evaluate(q, values) == told[output]


def evaluate(polynomial, values):
    names, total = polynomial.context().names(), Fraction(0)
    for powers, c in polynomial.to_dict().items():
        term = Fraction(int(c))
        for name, power in zip(names, powers, strict=True):
            term *= values[name] ** int(power)
        total += term
    return total


@every_drive
@pytest.mark.parametrize("output", ["x_k", "tension", "belt_speed", "w1"])
def test_bode_data(drives, output):
    # both sides take the cosine as the same decimal; where cos^2 is exact they differ by what a float's cosine is off
    omega = np.logspace(-1, 4, 11)
    with mpmath.workdps(50):
        n = Numbers(drives, precise)
        n.c = mpmath.sqrt(precise(drives.pulley.cosine_squared))
        for k, source in enumerate(INPUTS):
            h = drives.transfer(output, source)
            size, phase = h.magnitude(omega), h.phase(omega)
            for w, a, angle in zip(omega, size, phase, strict=True):
                true = respond(n, mpmath.mpc(0, float(w)), k)[output]
                assert abs(a / abs(true) - 1) < 1e-14
                assert abs(mpmath.expj(float(angle)) - true / abs(true)) < 1e-13


@every_drive
def test_the_phase_has_no_jumps_and_starts_where_it_says(drives):
    omega = np.logspace(-6, 8, 3000)
    for output, start in (("x_k", -180), ("tension", 0), ("w2", 0)):
        phase = np.degrees(drives.transfer(output, "T2").phase(omega))
        assert abs(phase[0] - start) < 1e-2
        # the least damped pair turns by 180 degrees over some samples; a pulley with mass gives an undamped zero
        assert np.abs(np.diff(phase)).max() < 40 or (output == "tension" and drives.pulley.mass)
    h = drives.transfer("x_k", "T1")
    assert abs(np.degrees(h.phase(1e12)) + 180 + 90 * h.relative_degree) < 1e-3


def exact(coefficients):
    return [precise(c) for c in coefficients]


def slope(coefficients):
    return [c * power for c, power in zip(coefficients, range(len(coefficients) - 1, 0, -1), strict=False)]


@every_drive
def test_poles_and_zeros_do_not_move_under_newton_with_60_digits(drives):
    with mpmath.workdps(60):
        for output in ("x_k", "w1"):
            h = drives.transfer(output, "T1")
            for found, coefficients in ((h.poles, h.denominator), (h.zeros, h.numerator)):
                assert len(set(found)) == len(coefficients) - 1
                for z in found:
                    true = mpmath.mpc(z)
                    for _ in range(4):
                        true -= horner(exact(coefficients), true) / horner(exact(slope(coefficients)), true)
                    assert abs(z - true) <= 4e-16 * abs(z)


def step_answer(numerator, denominator, t):
    """Value at t of the answer to a unit step, by residues at poles that are refined to the working precision."""
    p, q = exact(numerator), exact(denominator)
    total = p[-1] / q[-1]
    for pole in roots(fmpq_poly([fmpq(c.numerator, c.denominator) for c in reversed(denominator)])):
        z = mpmath.mpc(pole)
        for _ in range(4):
            z -= horner(q, z) / horner(slope(q), z)
        total += mpmath.exp(z * t) * horner(p, z) / (z * horner(slope(q), z))
    return total.real


@every_drive
@pytest.mark.parametrize(("step", "samples"), [(1e-6, 1000), (1e-3, 100), (1.0, 3)])
def test_steps_of_a_microsecond_and_of_a_second_are_exact(drives, step, samples):
    run = simulate(drives, T1=Torque.step(0.3), T2=Torque.step(0.2), t_end=samples * step, step=step)
    with mpmath.workdps(50):
        t = precise(Fraction(step)) * samples
        for output in ("x_k", "tension", "belt_speed", "w1", "w2"):
            h1, h2 = (drives.transfer(output, source) for source in INPUTS)
            true = precise(Fraction(0.3)) * step_answer(h1.numerator, h1.denominator, t)
            true += precise(Fraction(0.2)) * step_answer(h2.numerator, h2.denominator, t)
            assert abs(run.outputs[output][-1] - true) < 1e-12 * np.abs(run.outputs[output]).max(), output
    r1, r2, x = float(drives.left.radius), float(drives.right.radius), run.outputs
    apart = r2 * x["phi2"] - r1 * x["phi1"] - sum(run.states[name] for name in drives.elongations)
    assert np.abs(apart).max() < 1e-14


def test_ramps_and_corners_between_samples_are_exact():
    coarse, fine = (
        simulate(UNEQUAL, T2=Torque.table([0.1, 0.37, 0.4], [0.0, 1.0, -0.5]), t_end=2.0, step=h) for h in (0.25, 1e-3)
    )
    for name, values in coarse.outputs.items():
        assert np.abs(values - fine.outputs[name][::250]).max() < 1e-12 * np.abs(values).max()


def product(a, b):
    total = [Fraction(0)] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for k, y in enumerate(b):
            total[i + k] += x * y
    return total


def plus(a, b):
    size = max(len(a), len(b))
    return [x + y for x, y in zip(*([Fraction(0)] * (size - len(c)) + list(c) for c in (a, b)), strict=True)]


@pytest.mark.parametrize("drives", [EXERCISE, UNEQUAL], ids=["exercise", "unequal"])
def test_closed_loop_answers(drives):
    made = design(drives, 20, 20)
    run = simulate_control(made, Torque.step(1.0), Torque.step(5.0), t_end=0.4, step=0.1)
    loops = (("belt_speed", made.speed, made.speed_plant, 1), ("tension", made.tension, made.tension_plant, 5))
    with mpmath.workdps(50):
        for output, controller, plant, height in loops:
            gain, time = controller.gain, controller.integral_time
            p = product([gain * time, gain], plant.numerator)
            q = plus(product([time, Fraction(0)], plant.denominator), p)
            for k in (1, 2, 4):
                true = height * step_answer(p, q, precise(Fraction(0.1)) * k)
                assert abs(run.outputs[output][k] - true) < 1e-12 * height


def test_disturbances_under_control_by_inverse_laplace():
    made, height, t = design(EXERCISE, 20, 20), 0.05, 0.1
    run = simulate_control(made, d1=Torque.step(height), t_end=0.4, step=t)
    with mpmath.workdps(40):
        n = Numbers(EXERCISE, precise)
        n.c = mpmath.sqrt(precise(EXERCISE.pulley.cosine_squared))
        share = mpmath.matrix([[-1, 1], [1, 1]]) / 2  # of (tau_v, tau_f) in T1 and T2

        def answer(s, output):
            seen = [respond(n, s, k) for k in (0, 1)]
            plant = mpmath.matrix([[one[o] for one in seen] for o in ("belt_speed", "tension")])
            gains = [precise(c.gain) * (1 + 1 / (precise(c.integral_time) * s)) for c in (made.speed, made.tension)]
            disturbed = mpmath.matrix([precise(Fraction(height)) / s, 0])
            loop = share * mpmath.diag(gains) * plant  # T = -loop (T + disturbed)
            torques = mpmath.lu_solve(mpmath.eye(2) + loop, disturbed)
            return sum(one[output] * torque for one, torque in zip(seen, torques, strict=True))

        for output in ("belt_speed", "tension", "x_k", "w1"):
            true = [
                mpmath.invertlaplace(lambda s, o=output: answer(s, o), t * k, method="talbot", degree=40)
                for k in (1, 4)
            ]
            assert max(abs(run.outputs[output][k] - x) for k, x in zip((1, 4), true, strict=True)) < 1e-12


def test_decoupled_plants():
    s, n = Fraction(7, 3), Numbers(EXERCISE, Fraction)
    # only k/cos^2 matters here, and the cosine of 45 degrees is no fraction
    n.k, n.c = n.k / EXERCISE.pulley.cosine_squared, Fraction(1)
    one, two = respond(n, s, 0), respond(n, s, 1)
    speed, tension = decoupled(EXERCISE)
    assert horner(speed.numerator, s) / horner(speed.denominator, s) == (two["belt_speed"] - one["belt_speed"]) / 2
    assert horner(tension.numerator, s) / horner(tension.denominator, s) == (two["tension"] + one["tension"]) / 2
    assert one["tension"] == two["tension"]
    assert one["belt_speed"] == -two["belt_speed"]


def test_exercise_by_hand():
    # J/r^2 = 0.1 kg, B/r^2 = 10 N s/m, k_p = 100 N/m: (0.1 s + 10)(0.5 s + 250) s + 200 (0.5 s + 50), less s + 100
    h = EXERCISE.transfer("x_k", "T1")
    assert h.denominator == (1, 500, 2000)
    roots = [-250 - math.sqrt(60500), -250 + math.sqrt(60500)]
    assert np.allclose([p.real for p in h.poles], roots, rtol=1e-13, atol=0)
    assert math.isclose(h.dc_gain, -0.5 / 0.1 * 2 * math.sqrt(0.5) / 200, rel_tol=1e-15)
    assert [round(z.real, 6) for z in EXERCISE.state_space().poles] == [
        round(roots[0], 6), -100, -100, -100, round(roots[1], 6), 0,
    ]  # fmt: skip


def test_the_resonance_of_the_exercise_text_is_a_limit():
    assert undamped_frequency(EXERCISE) == 20
    rigid = CoupledDrives(pulley=Pulley(1e12, math.radians(45)))
    assert math.isclose(undamped_frequency(rigid), math.sqrt(50 / 0.1), rel_tol=1e-9)
    nearly = Spool(1e-3, 1e-7, 0.1)
    light = CoupledDrives(nearly, nearly, Belt(50, 1e-6), Belt(50, 1e-6), Pulley(1e9, math.radians(45)))
    assert math.isclose(peak(light.transfer("x_k", "T1")).frequency, math.sqrt(50 / 0.1), rel_tol=1e-6)


def test_the_largest_friction_with_a_peak():
    limit = largest_friction_with_peak(EXERCISE)
    for factor, seen in ((0.9999, True), (1.0001, False)):
        spool = Spool(1e-3, limit * factor, 0.1)
        drives = CoupledDrives(spool, spool)
        assert (peak(drives.transfer("x_k", "T1")) is not None) is seen
        with mpmath.workdps(60):
            n = Numbers(drives, precise)
            sizes = [
                abs(respond(n, mpmath.mpc(0, w), 0)["tension"]) for w in ("1e-9", "0.01", "0.1", "0.3", "1", "5", "20")
            ]
            assert (max(sizes) > sizes[0]) is seen


def test_each_torque_moves_both_outputs_equally():
    # the array of two equal drives by mpmath's inverse of the gains
    omega = [0.0, 1.0, 22.36, 1000.0]
    shares = relative_gain_array(EXERCISE, omega)
    assert np.abs(shares - 0.5).max() < 1e-14
    shares = relative_gain_array(UNEQUAL, [7.0])
    with mpmath.workdps(40):
        n = Numbers(UNEQUAL, precise)
        seen = [respond(n, mpmath.mpc(0, 7), k) for k in (0, 1)]
        gains = mpmath.matrix([[one[o] for one in seen] for o in ("belt_speed", "tension")])
        inverse = gains**-1
        for i in range(2):
            for k in range(2):
                assert abs(shares[i, k, 0] - gains[i, k] * inverse[k, i]) < 1e-13
