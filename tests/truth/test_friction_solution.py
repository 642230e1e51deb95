"""References with friction: limits, what they say of their error; and what runs of bristle laws tell of theirs."""

from importlib.util import find_spec

import numpy as np
import pytest
from friction_by_scipy import reference as by_scipy
from friction_scales import FORCES, judge, random_case, true_errors
from friction_series import reference

from friction import Dahl, ElastoPlastic, LuGre, Ramp, Sine, Status, Table, Testbench, simulate
from tline import InputError, Scene
from tline.solver.description.description import describe
from tline.solver.simulate import simulate as tl_simulate
from tline.solver.steady.steady_state import steady_state
from tline.study.charts.scenes import chart_scene
from tline.study.programs import rthym, tsnet
from tline.study.reference import lattice
from tline.study.reference.friction import FrictionSolution

T = np.linspace(0, 20, 1001)
BOTH = pytest.mark.parametrize(("name", "finest"), [("friction", 256), ("network", 64)])


def changed(name: str = "friction", **parts) -> Scene:
    return Scene(**chart_scene(name).scene.table() | parts)


def with_factor(name: str, factor: float) -> Scene:
    lines = chart_scene(name).scene.table()["lines"]
    friction = {"kind": "darcy", "factor": factor}
    return changed(name, lines={key: pipe | {"friction": friction} for key, pipe in lines.items()})


def lossless(name: str) -> Scene:
    """What is shut is drawn the other way, from rest: without friction that adds to a steady state of no efforts."""
    given = chart_scene(name).scene.table()
    lines = {key: {k: v for k, v in pipe.items() if k != "friction"} for key, pipe in given["lines"].items()}
    (key,) = (key for key, draw in given["sources"].items() if isinstance(draw["value"], dict))
    ramp = given["sources"][key]["value"]
    drawn = ramp | {"from": 0, "to": ramp["from"].removeprefix("-")}
    return changed(name, lines=lines, sources={key: given["sources"][key] | {"value": drawn}}, start="rest")


def largest(solution: FrictionSolution, scene: Scene, wanted=None) -> float:
    """Largest effort at the probes, or largest difference to wanted ones."""
    efforts = {probe: solution.at(probe, T) for probe in scene.probes}
    return max(np.abs(efforts[probe] - (wanted[probe] if wanted else 0)).max() for probe in efforts)


@BOTH
def test_without_friction_it_is_the_exact_lattice(name, finest):
    scene = lossless(name)
    exact = {probe: np.array(lattice(scene, T.tolist(), probe, float)[0]) for probe in scene.probes}
    scale = max(np.abs(u).max() for u in exact.values())
    errors = [largest(FrictionSolution(with_factor(name, f), finest), scene, exact) / scale for f in (2e-6, 1e-6)]
    assert errors[1] < 1e-4
    assert errors[0] == pytest.approx(2 * errors[1], rel=1e-3)  # so it tends to zero with the factor


@BOTH
def test_its_error_falls_with_the_third_power_and_is_not_less_than_it_says(name, finest):
    scene = chart_scene(name).scene
    *grids, best = (FrictionSolution(scene, finest * 2**k) for k in range(4))
    errors = [each.error for each in (*grids, best)]
    assert -np.polyfit(range(4), np.log2(errors), 1)[0] > 2.8  # at least: where flows turn is on no grid
    wanted = {probe: best.at(probe, T) for probe in scene.probes}
    for rough in grids:
        assert largest(rough, scene, wanted) < rough.error
    assert best.error < 3e-8 * largest(best, scene)


def test_a_flow_stopped_at_once_is_that_of_diamonds():
    """Fronts are kept on both sides by the grid, and followed by the diamonds; they have nothing in common."""
    given = chart_scene("friction").scene.table()
    draw = given["sources"]["draw"] | {"value": {"shape": "step", "from": "-200 L/s", "to": 0, "at": 0.25}}
    scene = changed(sources={"draw": draw}, solver={"order": 5, "slab": 0.125})
    solution = FrictionSolution(scene, 256)
    run = tl_simulate(scene)
    assert largest(solution, scene, {"far": run.probes["far"].at(T).u}) < 1e-11 * largest(solution, scene)
    assert solution.error < 1e-11 * largest(solution, scene)


@pytest.mark.parametrize("name", ["friction", "network"])
def test_before_anything_moves_it_is_the_steady_state(name):
    """The solver's own has nothing in common with it."""
    scene = chart_scene(name).scene
    efforts, _ = steady_state(describe(scene))
    solution = FrictionSolution(scene, 128)
    for probe in scene.probes.values():
        assert solution.at(str(probe.at), np.zeros(1)) == pytest.approx(efforts[str(probe.at)], rel=1e-12)


@pytest.mark.parametrize(("name", "counts"), [("friction", (16, 32)), ("network", (4, 8))])
@pytest.mark.parametrize("peer", [rthym, tsnet])
def test_other_programs_converge_to_it(peer, name, counts):
    scene = chart_scene(name).scene
    if why := peer.incompatibility(scene):
        pytest.skip(why)
    solution, errors = FrictionSolution(scene, 256), []
    for n in counts:
        run = peer.run(scene, n)
        exact = {probe: solution.at(probe, run.t) for probe in scene.probes}
        scale = max(np.abs(u).max() for u in exact.values())
        errors.append(max(np.abs(run.u[probe] - exact[probe]).max() for probe in exact) / scale)
    assert errors[1] < 4e-3
    assert errors[0] > 1.7 * errors[1]  # they are of the first order


@pytest.mark.skipif(not find_spec("rthym_moc"), reason="pip install 'tline[peers]'")
def test_the_factor_of_rthym_moc_is_that_of_the_scene_at_the_start():
    scene = chart_scene("friction").scene
    assert rthym.run(scene, 4).u["far"][0] == pytest.approx(FrictionSolution(scene, 256).at("far", T[:1])[0], rel=1e-12)


@pytest.mark.parametrize(
    ("parts", "sentence"),
    [
        ({"start": "rest"}, "scene: has links, or does not start"),
        ({"lines": chart_scene("hammer").scene.table()["lines"]}, "lines.pipe: not with Darcy's friction alone"),
        ({"loads": {"tank": {"at": "tank", "kind": "resistor", "resistance": 1}}}, "loads.tank: holds no pressure"),
        ({"sources": {"p": {"at": "far", "kind": "pressure", "value": 1}}}, "sources.p: no flow of straight pieces"),
    ],
)
def test_what_it_cannot_do(parts, sentence):
    with pytest.raises(InputError, match=sentence):
        FrictionSolution(changed(**parts))


def test_corners_have_to_be_on_the_grid():
    with pytest.raises(InputError, match="corners of flows lie between points"):
        FrictionSolution(chart_scene("friction").scene, 24)


SLOW = LuGre(v_s=1.8, sigma0=6e4, sigma1=330.0)
NOISE = Table(np.linspace(0.0, 9.0, 200).tolist(), (1e-5 * np.random.default_rng(1).normal(size=200)).tolist())


@pytest.mark.parametrize(("force", "tol"), [(Ramp(0.08), 1e-2), (Ramp(1e-4), 0.1), (NOISE, 1e-2)])
def test_motion_that_is_small_against_v_s_is_as_good_as_told(force, tol):
    bench = Testbench(force, mass=45.0)
    run = simulate(SLOW, bench, tol=tol)
    true = true_errors(run, reference(SLOW, bench, run.t))
    assert run.status is Status.DONE
    assert max(true.values()) <= tol
    assert all(true[name] <= 3.0 * run.errors[name] + 1e-12 for name in true)


def test_told_errors_do_not_depend_on_where_one_looks():
    """An oscillation that both of two runs lose is over at the end."""
    bench = Testbench(Ramp(1e-4), mass=45.0)
    told = simulate(SLOW, bench, tol=0.1, times=[10.0]).errors
    assert told["v"] > 0.1 * simulate(SLOW, bench, tol=0.1).errors["v"]


def test_runs_over_wide_scales_are_as_good_as_told():
    runs = [judge(n, seed=32) for n in range(120)]
    assert sum(run.status is Status.DONE for run, _, _ in runs) >= 115
    assert max(share for run, share, _ in runs if run.status is Status.DONE) <= 1.0
    assert max(over for run, _, over in runs if run.status is Status.DONE) <= 3.0


@pytest.mark.parametrize(
    ("model", "bench"),
    [
        (LuGre(sigma0=1e3, sigma1=20.0), Testbench(Sine(1.5, 1.0))),
        (Dahl(sigma0=1e3), Testbench(Ramp(0.6, 0.1), v0=-0.3)),
        (ElastoPlastic(sigma0=1e3, sigma1=5.0, z_ba=6e-4), Testbench(Sine(1.4, 2.0), 0.5)),
    ],
)
def test_the_reference_agrees_with_scipys(model, bench):
    times = np.linspace(0.0, 2.0, 41)
    series, other = reference(model, bench, times), by_scipy(model, bench, times)
    assert np.all(np.abs(series - other) <= 1e-9 * np.abs(other).max(axis=0))


def test_cases_cover_the_scales():
    cases = [random_case(np.random.default_rng((31, n)), FORCES[n % len(FORCES)]) for n in range(600)]
    v_s = [getattr(model, "v_s", 1.0) for model, *_ in cases]
    masses, tols = [bench.mass for _, bench, *_ in cases], [tol for *_, tol in cases]
    assert min(v_s) < 2e-3 < 50.0 < max(v_s)
    assert min(masses) < 0.02 < 500.0 < max(masses)
    assert min(tols) < 2e-9 < 0.05 < max(tols)
