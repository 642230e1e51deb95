"""Parts, torques, hidden modes, slack, control and refusals of the package drives."""

import math
from fractions import Fraction

import numpy as np
import pytest

import drives
from drives import Belt, CoupledDrives, Pulley, Spool, Torque, design, hidden_modes, simulate, simulate_control
from drives.discretise import energy_matrix, step_matrix
from drives.linearise import literal_rates
from drives.number import exact, roots
from drives.state_space import floats

EXERCISE = CoupledDrives()
UNEQUAL = CoupledDrives(
    Spool(2e-3, 0.03, 0.07), Spool(5e-4, 0.2, 0.13), Belt(40, 0.3), Belt(90, 0.05), Pulley(150, math.radians(37))
)
WITHOUT_DAMPING = CoupledDrives(Spool(1e-3, 0, 0.1), Spool(1e-3, 0, 0.1), Belt(50, 0), Belt(50, 0))


def test_every_public_name_can_be_had():
    for name in drives.__all__:
        assert getattr(drives, name) is not None
    with pytest.raises(AttributeError, match="nothing"):
        _ = drives.nothing


def test_the_pulley_is_a_spring_whatever_the_signs_of_its_motion():
    pulley, deflection = Pulley(200, math.radians(25)), -0.02
    tension = pulley.tension(deflection)
    assert tension > 0  # pulled: x_k < 0
    e_p = -2 * float(pulley.cosine) * deflection
    assert math.isclose(float(pulley.belt_stiffness) * e_p**2 / 2, 200 * deflection**2 / 2, rel_tol=1e-14)
    assert math.isclose(float(pulley.belt_stiffness) * e_p, tension, rel_tol=1e-14)


def test_a_float_counts_as_the_decimal_it_shows():
    assert exact(0.1, "x") == exact(np.float64(0.1), "x") == Fraction(1, 10)
    assert exact(np.int64(3), "x") == 3
    assert Pulley(1, math.pi / 3).cosine_squared == Fraction(1, 4)
    assert Pulley(1, math.pi / 3).cosine == Fraction(1, 2)
    assert Pulley(1, math.radians(45.0001)).cosine_squared != Fraction(1, 2)


@pytest.mark.parametrize(
    ("build", "sentence"),
    [
        (lambda: Spool(0, 1, 1), "inertia: not physical, expected more than 0, got 0"),
        (lambda: Spool(1, -1, 1), "friction: not physical, expected 0 or more, got -1"),
        (lambda: Spool(1, 1, math.inf), "radius: not finite, expected a real number in SI units, got inf"),
        (lambda: Spool(1, 1, "10 cm"), "radius: not a number, expected a real number in SI units, got '10 cm'"),
        (lambda: Spool(1e-200, 1, 1), "inertia: out of reach"),
        (lambda: Spool(1, 10**40, 1), "friction: out of reach"),
        (lambda: Spool(True, 1, 1), "inertia: not a number"),
        (lambda: Belt(Fraction(1, 3**300), 1), "stiffness: out of reach"),
        (lambda: Belt(1 + Fraction(1, 3**300), 1), "stiffness: too many digits"),
        (
            lambda: Pulley(200, math.pi / 2),
            "angle: not physical, expected more than 0 and less than 90 degrees, got 90",
        ),
        (lambda: Pulley(200, 0), "angle: not physical"),
        (lambda: CoupledDrives(left=Belt(1, 1)), "left: something else, expected Spool"),
        (lambda: simulate(EXERCISE, 0.1, t_end=1, step=0.5), "T1: something else, expected Torque, got 0.1"),
        (lambda: drives.draw_poles(EXERCISE.transfer("w1", "T1")), "transfers: something else, expected list or tuple"),
        (lambda: EXERCISE.state_space(outputs=5), "outputs: no names"),
        (lambda: EXERCISE.transfer("speed", "T1"), "output: unknown name, expected x_k or tension"),
        (lambda: EXERCISE.state_space("x_k"), "outputs: no names"),
        (lambda: Torque.table([0, 2, 1], [1, 1, 1]), "times[2]: out of order, expected a time later than 2 s, got 1 s"),
        (lambda: Torque.table([0, 0], [1, 1]), "times[1]: out of order"),
        (lambda: Torque.table([0, 1e-200], [1, 1]), "times[1]: out of reach"),
        (lambda: Torque.table([0], [1, 1]), "torque table: wrong length"),
        (lambda: Torque.table([0, 1], [1, math.nan]), "values[1]: not finite"),
        (lambda: Torque.step(1, at=-1), "step: before the start"),
        (lambda: simulate(EXERCISE, t_end=1, step=0), "step: not physical"),
        (lambda: simulate(EXERCISE, t_end=1, step=1e-9), "step: unfit"),
        (lambda: simulate(EXERCISE, t_end=1, step=2), "step: unfit"),
        (lambda: simulate(EXERCISE, t_end=1, step=0.5, initial={"phi2": 1}), "initial.phi2: no such state"),
        (lambda: drives.steady_state(CoupledDrives(Spool(1, 0, 1), Spool(1, 0, 1)), 1, 1), "friction: nothing settles"),
        (lambda: design(EXERCISE, -1), "speed_bandwidth: not physical"),
        (lambda: simulate_control(design(EXERCISE), t_end=1, step=0.1, limit=0), "limit: not physical"),
        (lambda: EXERCISE.transfer("phi1", "T1")(0), "s: a pole of phi1/T1"),
        (lambda: design(WITHOUT_DAMPING), "tension/tau_f: no PI controller of this rule has the margins"),
        (lambda: EXERCISE.transfer("x_k", "T1").phase([-1]), "omega: no angular frequencies"),
        (lambda: drives.peak(EXERCISE.transfer("phi1", "T1")), "phi1/T1: has no finite value"),
        (lambda: drives.largest_friction_with_peak(UNEQUAL), "drives: spools or belts differ"),
    ],
)
def test_bad_input_gets_one_sentence(build, sentence):
    with pytest.raises(drives.InputError) as error:
        build()
    assert str(error.value).startswith(sentence)
    assert "\n" not in str(error.value)


def test_torques():
    ramp = Torque.ramp(2.0, 1.0, 3.0)
    assert [ramp(t) for t in (0, 1, 2, 3, 9)] == [0, 0, 1, 2, 2]
    held = Torque.table([1.0, 2.0], [5.0, 7.0], held=True)
    assert [held(t) for t in (0, 1, 1.5, 2, 3)] == [5, 5, 5, 7, 7]
    assert Torque.table([0.5, 1.0], [0.0, 1e-200])(1.0) == 1e-200
    assert Torque.step(3.0, 0.3).aligned(0.1).times == (0.0, 3 * 0.1)


def test_hidden_modes_of_unequal_drives():
    for output in ("x_k", "belt_speed", "w1"):
        (mode,) = hidden_modes(UNEQUAL, output, "T1")
        assert (mode.poles, mode.names, mode.unobservable, mode.uncontrollable) == ((0j,), ("free angle",), 1, 0)
    assert hidden_modes(UNEQUAL, "phi1", "T1") == []


def test_hidden_modes_of_the_exercise():
    names = {mode.poles[0]: mode.names for mode in hidden_modes(EXERCISE, "tension", "T2")}
    assert names == {0j: ("free angle",), -100: ("common speed", "belts against each other", "spools and belts alike")}
    (_, belts, tension) = hidden_modes(EXERCISE, "belt_speed", "T2")
    assert belts.names == ("belts against each other", "tension")
    assert (len(tension.poles), tension.names, tension.unobservable) == (2, ("tension",), 1)
    orders = [len(EXERCISE.state_space((o,), ("T1",)).minimal().states) for o in ("x_k", "belt_speed", "w1", "phi1")]
    assert orders == [2, 1, 3, 4]


def test_zeros_stay_zeros_where_difference_quotients_lie():
    assert drives.zero_eigenvalues(EXERCISE.state_space().a) == 1
    assert drives.zero_eigenvalues(drives.literal_jacobian(UNEQUAL)) == 2
    seen = drives.artefact(EXERCISE, runs=400)
    assert 0.5 < seen.unstable / seen.runs < 0.85  # 3/4 if signs of rounding were drawn, which some LAPACKs are not
    assert 0 < seen.by_difference < seen.unstable
    assert 1e-9 < seen.largest < 1e-3
    x = np.random.default_rng(2).normal(size=7)
    exact_jacobian = floats(drives.literal_jacobian(UNEQUAL))
    told = drives.forward_difference(literal_rates(UNEQUAL), x)
    assert np.abs(told - exact_jacobian).max() < 1e-6 * np.abs(exact_jacobian).max()
    shared = [z for z in roots(drives.literal_jacobian(UNEQUAL).charpoly()) if z != 0]
    assert np.allclose(shared, [z for z in UNEQUAL.state_space().poles if z != 0], rtol=1e-12)


def test_a_step_matrix_and_an_energy_matrix_by_hand():
    from flint import fmpq_mat

    for h in (1e-6, 1.0, 1e3):
        assert math.isclose(step_matrix(fmpq_mat([[-3]]), h)[0, 0], math.expm1(-3 * h), rel_tol=1e-15)
        found = energy_matrix(fmpq_mat([[-3]]), fmpq_mat([[6]]), h)[0, 0]
        assert math.isclose(found, -math.expm1(-6 * h), rel_tol=1e-14)


def test_a_run_that_starts_settled_stays_there():
    start = drives.steady_state(UNEQUAL, -0.2, 0.9)
    run = simulate(UNEQUAL, Torque.step(-0.2), Torque.step(0.9), t_end=100.0, step=10.0, initial=start)
    for name in ("tension", "w1", "w2", "x_k"):
        assert np.ptp(run.outputs[name]) < 1e-12 * np.abs(run.outputs[name]).max()
    assert np.allclose(run.outputs["phi1"], start["w1"] * run.t, rtol=1e-12)


def test_a_tight_belt_never_goes_slack():
    torques = Torque.step(0.3), Torque.table([0.0, 0.5, 1.0], [0.0, 1.0, 0.4])
    straight, slack = (simulate(UNEQUAL, *torques, t_end=1.0, step=0.05, slack=slack) for slack in (False, True))
    for name, values in slack.outputs.items():
        assert np.abs(values - straight.outputs[name]).max() < 1e-7 * np.abs(values).max()


def test_a_belt_that_is_pushed_hangs_slack_and_tightens_again():
    torques = Torque.step(0.1), Torque.table([0.0, 0.3, 0.31, 0.5, 0.51, 2.0], [0.3, 0.3, -0.6, -0.6, 0.5, 0.5])
    run = simulate(EXERCISE, *torques, t_end=2.0, step=0.01, slack=True)
    tension = run.outputs["tension"]
    assert tension.min() == 0
    assert tension[-1] > 1
    assert tension[:10].max() > 0
    assert simulate(EXERCISE, *torques, t_end=2.0, step=0.01).outputs["tension"].min() < 0
    slack = tension == 0
    assert (run.outputs["x_k"][slack] == 0).all()
    assert np.ptp(run.energy.stored[slack]) > 0  # the spools still turn
    assert np.abs(run.energy.imbalance).max() < 1e-10 * run.energy.supplied.max()  # the solver's tolerance is 1e-13


def test_margins_by_hand():
    # L = 8/(s + 1)^3 * (1 + 1/(T s)) with T so long that it does not count: -180 degrees at sqrt(3), where |L| = 1
    from flint import fmpq_poly

    from drives import TransferFunction

    found = drives.margins(drives.PI(0.5, 1e12), TransferFunction(fmpq_poly([8]), fmpq_poly([1, 3, 3, 1])))
    assert math.isclose(found.gain, 2, rel_tol=1e-9)
    size = 4 ** (2 / 3)
    assert math.isclose(found.crossover, math.sqrt(size - 1), rel_tol=1e-9)
    assert math.isclose(found.phase, math.pi - 3 * math.atan(math.sqrt(size - 1)), rel_tol=1e-9)


@pytest.mark.parametrize("one", [EXERCISE, UNEQUAL])
def test_control_settles_and_rejects_disturbances(one):
    run = simulate_control(
        design(one, 20, 20), Torque.step(0.8), Torque.step(4.0, 0.5), d1=Torque.step(0.05, 1.5), t_end=6.0, step=0.01
    )
    assert abs(run.outputs["belt_speed"][-1] - 0.8) < 1e-6
    assert abs(run.outputs["tension"][-1] - 4.0) < 1e-6
    before = run.t < 0.5
    assert np.abs(run.outputs["tension"][before]).max() < 1e-12  # the speed does not move the tension
    assert np.abs(run.energy.imbalance).max() < 1e-12 * run.energy.dissipated[-1]


def test_other_tools_take_the_models():
    import control
    from scipy import signal

    omega = np.array([0.5, 20.0, 700.0])
    h = EXERCISE.transfer("x_k", "T1")
    true = h(1j * omega)
    small = EXERCISE.state_space(("x_k",), ("T1",)).minimal()
    for system in (h.to_control(), small.to_control()):
        assert np.allclose(np.squeeze(system(1j * omega)), true, rtol=1e-12, atol=0)
        assert math.isclose(float(np.squeeze(system.dcgain())), float(h.dc_gain), rel_tol=1e-12)
    assert isinstance(small.to_control(), control.StateSpace)
    assert np.allclose(signal.freqresp(h.to_scipy(), omega)[1], true, rtol=1e-12, atol=0)
    t, answer = signal.step(small.to_scipy(), N=50)  # not freqresp, which rounds a state space on its way
    run = simulate(EXERCISE, Torque.step(1.0), t_end=t[-1], step=t[1])
    assert np.abs(answer - run.outputs["x_k"]).max() < 1e-12
    full = EXERCISE.state_space().to_control()
    assert full.nstates == 6
    assert full.input_labels == ["T1", "T2"]


def test_pictures(tmp_path):
    run = simulate(EXERCISE, Torque.step(0.1), Torque.step(0.2), t_end=1.0, step=0.01)
    transfers = [EXERCISE.transfer("x_k", name) for name in ("T1", "T2")]
    for k, figure in enumerate(
        (
            drives.draw_bode(transfers, np.logspace(-1, 4, 50)),
            drives.draw_poles([EXERCISE.transfer("w1", "T1")]),
            drives.draw_run(run),
        )
    ):
        figure.savefig(tmp_path / f"{k}.png")
        assert (tmp_path / f"{k}.png").stat().st_size > 5000


def test_what_has_no_damping_swings_for_ever():
    h = WITHOUT_DAMPING.transfer("x_k", "T1")
    assert h.poles == [-20j, 20j]
    assert drives.peak(h) == drives.Peak(20.0, math.inf)
    # T1 = 0.1 N m on a mass of 0.1 kg: the tension is 0.5*(1 - cos(20 t)), the spools run away together
    run = simulate(WITHOUT_DAMPING, Torque.step(0.1), t_end=10.0, step=0.01)
    assert np.abs(run.outputs["tension"] - 0.5 * (1 - np.cos(20 * run.t))).max() < 1e-12
    assert np.abs(run.outputs["belt_speed"] + run.t * 5).max() < 1e-12 * 50
    assert np.abs(run.energy.imbalance).max() < 1e-12 * run.energy.supplied[-1]
    assert np.abs(drives.relative_gain_array(WITHOUT_DAMPING, [0.0, 7.0]) - 0.5).max() < 1e-15
