"""What the packages hand out, errors too, survives pickle and copies with all it holds, and travels."""

import copy
import enum
import inspect
import pickle
import subprocess
import sys
import warnings
from concurrent.futures import ProcessPoolExecutor
from fractions import Fraction
from functools import cache
from multiprocessing import get_context
from pathlib import Path

import flint
import numpy as np
import pytest
from alike import differences

import drives
import friction
import passivity
from passivity import RationalFunction, RationalMatrix, StateSpace
from passivity.errors import ExpressionError
from tline import ActiveError, ElectricalLine, HydraulicLine, InputError, Scene, SceneError, sweep
from tline.scene.file import read_scene, scene_from
from tline.scene.user_defined import UserLink, UserLoad
from tline.solver.simulate import UnresolvedWarning, simulate

SCENES = sorted((Path(__file__).parents[2] / "scenes").glob("*.toml"))
LARGEST = 350_000  # bytes of a short run of a shipped scene
LARGEST_LINE = 60_000  # more for each of the stretches of a line that is recorded
LARGEST_STATE = 20_000  # of each element that has one
WAYS = {"pickle": lambda x: pickle.loads(pickle.dumps(x)), "copy": copy.copy, "deepcopy": copy.deepcopy}
LINE = {
    "medium": "electrical",
    "t_end": 5,
    "lines": {"line": {"nodes": ["near", "far"], "z0": 1, "delay": 1}},
    "sources": {"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 1}},
    "probes": {"far": {"at": "far"}},
}


class Clamp(UserLoad):
    """A user-defined element, which can be imported."""

    limit: float

    def flow(self, effort, opening):
        return opening * max(effort - self.limit, 0.0)


def survives(whole):
    for name, way in WAYS.items():
        assert not list(differences(whole, way(whole))), name


@cache
def shipped(path):
    """A short run with all there is to ask of it."""
    scene = read_scene(path)
    short = min(scene.t_end, 3 * min(line.shortest for line in scene.lines.values()))
    scene = scene.with_changes(t_end=short, solver={"order": 2})
    single = "pair" not in path.stem  # for coupled conductors neither is known
    record = list(scene.lines)[:2] if single else []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnresolvedWarning)  # of an order by hand
        return simulate(scene, envelope=single, ledger=single, record=record)


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_shipped_scenes(path):
    scene = read_scene(path)
    survives(scene)
    assert all(way(scene) == scene for way in WAYS.values())


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_results_of_shipped_scenes(path):
    result = shipped(path)
    for probe in result.probes.values():
        assert probe.u.size > 0  # kept beside the waves once it was asked for
    survives(result)
    stretches = sum(len(getattr(line, "stretches", ())) for line in result.lines.values())
    assert len(pickle.dumps(result)) < LARGEST + LARGEST_LINE * stretches + LARGEST_STATE * len(result.elements)


def test_a_result_with_its_estimated_errors():
    result = simulate(scene_from(LINE), envelope=True, ledger=True)
    assert result.accuracy is not None
    survives(result)


def test_results_load_without_what_computed_them(tmp_path):
    """Neither compiled code nor numba."""
    bench = friction.Testbench(friction.Ramp(2.0))
    both = shipped(SCENES[-1]), friction.simulate(friction.Coulomb(), bench, t_end=1.0)
    (tmp_path / "both").write_bytes(pickle.dumps(both))
    code = "import pickle, sys; pickle.load(open(sys.argv[1], 'rb')); print({'numba', 'llvmlite'} & {*sys.modules})"
    done = subprocess.run([sys.executable, "-c", code, tmp_path / "both"], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"


def test_what_else_is_found_of_lines_and_scenes():
    scene = scene_from(LINE)
    survives(HydraulicLine(radius="10 cm", wave_speed=1500, density=980))
    survives(ElectricalLine(wave_speed=3e8, z0=300))
    survives(sweep(scene, {"lines.line.z0": [0.9, 1.1]}, keep=["extremes", [1.0, 2.0]]))


def own(kind, **more):
    return Scene(**LINE, loads={"own": kind(at="far", **more)})


def test_user_defined_elements():
    scene = own(Clamp, limit=0.25)
    result = simulate(scene)
    survives(scene)
    survives(result)
    again = simulate(pickle.loads(pickle.dumps(scene)))
    assert again.probes["far"].u.tolist() == result.probes["far"].u.tolist()


def test_user_defined_elements_of_nowhere_are_refused_in_a_sentence():
    class Hidden(Clamp):
        pass

    class Between(UserLink):
        pass

    for element in (Hidden(at="far", limit=1.0), own(Hidden, limit=1.0), Between(nodes=("a", "b"))):
        with pytest.raises(
            InputError, match=r"^an element of class '(Hidden|Between)' cannot be pickled, expected a cl"
        ):
            pickle.dumps(element)
    survivor = own(Hidden, limit=0.25)
    assert simulate(copy.deepcopy(survivor)).probes["far"].u[-1] == simulate(survivor).probes["far"].u[-1]


def test_one_bad_scene_leaves_a_pool_alive():
    good, active = scene_from(LINE), scene_from(LINE | {"loads": {"a": {"at": "far", "kind": "impedance",
        "expression": "-3 + s"}}})  # fmt: skip
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        bad = pool.submit(scene_from, LINE | {"lines": {}, "t_end": -1})
        refused, runs = pool.submit(simulate, active), pool.submit(simulate, own(Clamp, limit=0.25))
        with pytest.raises(SceneError, match="t_end") as told:
            bad.result()
        assert len(told.value.mistakes) > 1
        with pytest.raises(ActiveError):
            refused.result()
        assert runs.result().scene == own(Clamp, limit=0.25)
        here, there = simulate(good).probes["far"], pool.submit(simulate, good).result().probes["far"]
        assert not list(differences(here.samples, there.samples))


PROVED = RationalFunction.from_expression("(s^2 + s + 1)/(s^2 + s + 4)")
REFUTED = RationalFunction.from_expression("1/(s^2 + s + 1) - 1/100")
LOAD = RationalFunction.from_expression("25 + s/1000000000")
MATRIX = RationalMatrix.from_rows([["s + 1", "s"], ["s", "s + 1/s"]])
SYSTEM = StateSpace.from_entries([[-1]], [[1]], [[1]], [["-1/5"]])


def samples(values, parameter="S"):
    f = np.linspace(0, 1, 40)
    return passivity.SampledResponse(f, values(2j * np.pi * f), parameter)


ABOVE = samples(lambda s: 1.1 / (1 + s))
PASSIVITY = {
    "proved": lambda: passivity.check_positive_real(PROVED),
    "certificate": lambda: passivity.check_positive_real(PROVED).certificate,
    "margins": lambda: passivity.check_positive_real(PROVED).margins,
    "robustness": lambda: passivity.robustness(passivity.check_positive_real(PROVED), "1e-9"),
    "refuted": lambda: passivity.check_positive_real(REFUTED),
    "bounded": lambda: passivity.check_bounded_real(RationalFunction.from_expression("(1 - s)/(1 + s)")),
    "chain": lambda: passivity.check_line(LOAD, "50 ohm", "3 ns"),
    "proof": lambda: passivity.is_positive_real("1 + exp(-s)"),
    "proof in balls": lambda: passivity.is_positive_real("line(50, s, 100 + 1/s) - 5"),
    "witness": lambda: passivity.is_bounded_real("exp(2*s)/2"),
    "matrix": lambda: passivity.check_positive_real(MATRIX),
    "matrix refuted": lambda: passivity.check_positive_real(RationalMatrix.from_rows([["1", "2"], ["2", "1"]])),
    "matrix system": lambda: passivity.check_positive_real(SYSTEM.transfer),
    "system": lambda: SYSTEM,
    "two-port": lambda: passivity.check_line_two_port(1, 1, through=True),
    "symbolic": lambda: passivity.is_positive_real("R + s*L", ["R > 0", "L > 0"]),
    "conditions": lambda: passivity.is_positive_real("R - 1 + s*L", ["R > 0", "L > 0"]),
    "identity": lambda: passivity.reflection_identity(),
    "conclusion": lambda: passivity.is_positive_real("1 + exp(-s)"),
    "derivation": lambda: passivity.derive(),
    "samples": lambda: passivity.check_samples(samples(lambda s: 1.5 / (1 + s))),
    "enforced": lambda: passivity.enforce(passivity.fit(ABOVE, 2), ABOVE),
    "behind a delay": lambda: passivity.fit_scattering(samples(lambda s: 0.5 * np.exp(-s) / (1 + s)), 1e-3),
    "network": lambda: with_verdict(
        passivity.fit_scattering(samples(lambda s: np.array([[0, 0.8], [0.6, 0]]) / (1 + s)[:, None, None]), 1e-9)
    ),
}  # fmt: skip


def with_verdict(network):
    assert network.verdict.proved
    return network


PAIR = drives.CoupledDrives()
LIGHT = drives.CoupledDrives(*[drives.Spool(1e-3, 1e-4, 0.1)] * 2, *[drives.Belt(50, 1e-3)] * 2)
DRIVES = {
    "winding": lambda: drives.Winding(1e-3, 0.1),
    "sensitivities": lambda: drives.sensitivities(drives.design(drives.CoupledDrives())),
    "drives": lambda: PAIR,
    "transfer": lambda: PAIR.transfer("x_k", "T1"),
    "state space": lambda: PAIR.state_space(("tension", "belt_speed")),
    "minimal": lambda: PAIR.state_space(("tension", "belt_speed")).minimal(),
    "symbolic": lambda: drives.symbolic_transfer("belt_speed", "T2", equal=True),
    "design": lambda: drives.design(PAIR, 20, 20),
    "margins": lambda: drives.design(PAIR, 20, 20).margins,
    "hidden": lambda: drives.hidden_modes(PAIR, "x_k", "T1"),
    "artefact": lambda: drives.artefact(PAIR, runs=10),
    "peak": lambda: drives.peak(LIGHT.transfer("x_k", "T1")),
    "share": lambda: drives.decoupler(PAIR),
    "reach": lambda: drives.reach(PAIR, 1.0, 5.0, 4.0),
    "pulley": lambda: drives.check_pulley(PAIR.pulley),
    "torque": lambda: drives.Torque.table([0, 1], [0, 4]),
    "run": lambda: drives.simulate(PAIR, T1=drives.Torque.step(0.1), T2=drives.Torque.step(0.1), t_end=2.0, step=0.5),
    "slack": lambda: drives.simulate(PAIR, T1=drives.Torque.step(-0.1), T2=drives.Torque.step(-0.1), t_end=1.0,
                                     step=0.5, slack=True),
    "control": lambda: drives.simulate_control(drives.design(PAIR, 20, 20), drives.Torque.step(1.0),
                                               drives.Torque.step(5.0), t_end=2.0, step=0.5),
}  # fmt: skip

FORCES = (
    friction.Sine(0.6, 1.0),
    friction.Spring(20.0, 0.05),
    friction.Steps([0.0, 1.0], [0.0, 2.0]),
    friction.Table([0.0, 1.0], [0.0, 2.0]),
)
BENCH = friction.Testbench(friction.Ramp(0.5))
BENT = friction.prescribe(friction.Dahl(), velocity=friction.Sine(0.1, 1.0), times=np.linspace(0.0, 1.0, 101))
FRICTION = {
    "models": lambda: [model() for model in friction.MODELS.values()],
    "methods": lambda: list(friction.METHODS.values()),
    "benches": lambda: [
        friction.Testbench(**{"spring" if isinstance(force, friction.Spring) else "force": force}) for force in FORCES
    ],
    "events": lambda: friction.simulate(friction.Karnopp(), BENCH),
    "hunting": lambda: friction.Testbench(friction.Ramp(0.0), controller=friction.PID(100.0, 200.0, 5.0, 0.01)),
    "cycle": lambda: (
        friction.simulate(
            friction.Karnopp(), friction.Testbench(friction.Ramp(0.0), spring=friction.Spring(20.0, 0.05))
        ).cycle
    ),
    "ledger": lambda: friction.simulate(friction.Karnopp(), BENCH).ledger,
    "taylor": lambda: friction.simulate(friction.Coulomb(), BENCH, t_end=1.0),
    "limits": lambda: friction.limits(friction.LuGre(sigma0=500.0), 4.0),
    "chatter": lambda: friction.euler_chatter(1.0, 0.5, 0.01),
    "dead zone": lambda: friction.dead_zone(0.001, 1.0, 0.01),
    "prescribed": lambda: friction.prescribe(friction.LuGre(), velocity=friction.Sine(0.1, 1.0)),
    "elements": lambda: friction.MaxwellSlip([1000.0], [1.0]),
    "dwell and lag": lambda: friction.Armstrong(),
    "swings": lambda: friction.swings(
        friction.Coulomb(), friction.Testbench(friction.Ramp(0.0), controller=friction.PID(100.0, 700.0, 5.0))
    ),
    "identified": lambda: friction.identify(BENT.t, BENT.F_f, velocity=BENT.v, models=("dahl",)),
}


@pytest.mark.parametrize("found", [*PASSIVITY.items(), *DRIVES.items(), *FRICTION.items()], ids=lambda found: found[0])
def test_what_the_other_packages_find(found):
    survives(found[1]())


@pytest.mark.parametrize(("package", "made"), [(passivity, PASSIVITY), (drives, DRIVES), (friction, FRICTION)])
def test_no_public_class_is_forgotten(package, made):
    seen = set()
    for make in made.values():
        kinds_within(make(), seen, set())
    public = [getattr(package, name) for name in package.__all__]
    classes = {each for each in public if inspect.isclass(each) and not issubclass(each, Exception | enum.Enum)}
    classes.discard(friction.Force)  # a protocol
    assert {each.__name__ for each in classes - {base for kind in seen for base in kind.__mro__}} == set()


def kinds_within(whole, kinds, known):
    """Classes of an object and of all that it is made of."""
    if id(whole) in known or isinstance(whole, np.ndarray):
        return
    known.add(id(whole))
    kinds.add(type(whole))
    parts = list(whole.values()) if isinstance(whole, dict) else list(whole) if isinstance(whole, list | tuple) else []
    slots = [name for kind in type(whole).__mro__ for name in getattr(kind, "__slots__", ()) if hasattr(whole, name)]
    for part in (*parts, *getattr(whole, "__dict__", {}).values(), *(getattr(whole, name) for name in slots)):
        kinds_within(part, kinds, known)


@pytest.mark.parametrize("bits", [20, 53, 300])
def test_balls_do_not_grow_on_their_way(bits):
    before, flint.ctx.prec = flint.ctx.prec, bits
    try:
        balls = [flint.arb(Fraction(k, 7).numerator) / 7 * flint.arb(2) ** (13 * k - 90) for k in range(1, 15)]
        balls += [flint.arb(1, flint.arb(r)) for r in (2.0**-30, 2.0**-29, 1.5, 0.0)] + [flint.arb(3).exp()]
        for ball in balls:
            for way in WAYS.values():
                same = way(ball)
                assert (same.mid().man_exp(), same.rad().man_exp()) == (ball.mid().man_exp(), ball.rad().man_exp())
        for x in (flint.arb("inf"), flint.arb("nan"), flint.acb(1, 2) / 3, flint.arb_mat(1, 1, [balls[0]])):
            assert repr(pickle.loads(pickle.dumps(x))) == repr(x)
    finally:
        flint.ctx.prec = before


ERRORS = [
    InputError("lines.pipe.radius", "too small", "more than 0 m", "-1 m"),
    InputError("", "no lines"),
    ActiveError("loads.end", "is active", "passive elements"),
    ExpressionError("column 3", "not a number", got="x"),
    SceneError([InputError("a", "wrong", "right", "left"), InputError("b", "wrong too")]),
]


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda error: pickle.loads(pickle.dumps(error))])
def test_errors_survive_copies_and_pickle(error, copied):
    found = copied(error)
    assert type(found) is type(error)
    assert str(found) == str(error)
    assert (found.where, found.problem, found.expected, found.got) == (
        error.where,
        error.problem,
        error.expected,
        error.got,
    )
    if isinstance(error, SceneError):
        assert [str(mistake) for mistake in found.mistakes] == [str(mistake) for mistake in error.mistakes]


def test_the_four_packages_have_one_base():
    assert friction.InputError is drives.InputError is InputError
    assert issubclass(ExpressionError, InputError)


def test_the_ground_floor_loads_nothing_else():
    code = "import sys, tline.errors, tline.units; print(*sorted(m for m in sys.modules if m.startswith('tline')))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["tline", "tline.errors", "tline.lazy", "tline.units"]
