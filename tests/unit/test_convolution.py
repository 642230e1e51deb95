"""Which scenes are convolutions, when jumps arrive, and what is kept of results."""

import numpy as np
import pytest
from lossy_scenes import cable, pipe

from tline import Scene, simulate
from tline.solver.convolution.rays import arrivals
from tline.solver.convolution.run import Convolved
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.result.dense_output import inside
from tline.solver.tolerance.convolved import convolved
from tline.solver.tolerance.ladder import Budget, Search
from tline.study.reference.lossy import lossy_response

SKIN = {"skin": {"resistance": "10 ohm/m", "frequency": "100 MHz"}}
ZIELKE = {"kind": "zielke", "viscosity": "0.0347 Pa s"}


def with_loads(loads) -> Scene:
    table = cable(t_end="4 ns", **SKIN).table()
    return Scene.model_validate(table | {"loads": table["loads"] | loads})


@pytest.mark.parametrize(
    ("scene", "tol"),
    [
        (cable(resistance=20), 1e-4),  # no memory: in diamonds
        (cable(**SKIN), 1e-12),  # finer than transforms are
        (pipe(friction={"kind": "darcy", "factor": 0.02}), 1e-4),
    ],
)
def test_other_scenes_are_none(scene, tol):
    assert convolved(Search(describe(scene), tol, [], False, Budget())) is None


def test_an_envelope_has_all_nodes_and_errors():
    scene = cable(t_end="2 ns", **SKIN)
    result = simulate(scene, tol=1e-4, envelope=True)
    assert result.resolution.convolved
    assert result.envelope is not None
    assert set(result.envelope.nodes) == {"a", "b"}
    assert result.lines.keys() == simulate(scene, tol=1e-4).lines.keys()
    closer = simulate(scene, tol=1e-6)
    for probe in closer.probes.values():
        found = result.envelope.of(scene.probes[probe.name].at)
        u = probe.at(np.linspace(0, 2e-9, 4001)).u
        for which, extreme in (("lowest", u.min()), ("highest", u.max())):
            assert found[which] == pytest.approx(extreme, abs=max(3 * found[f"{which}_error"], 1e-4 * np.abs(u).max()))


def test_a_switch_that_never_moves_in_time_gives_the_same():
    still = {"w": {"at": "b", "kind": "switch", "time": "1 s", "before": "inf", "after": 50}}
    one, other = simulate(with_loads(still), tol=1e-5), simulate(cable(t_end="4 ns", **SKIN), tol=1e-5)
    assert (one.resolution.convolved, other.resolution.convolved) == (True, True)
    t = np.array([1.3e-9, 1.9e-9, 3.5e-9])
    assert one.probes["far"].at(t).u == pytest.approx(other.probes["far"].at(t).u, abs=1e-5)


def test_a_second_run_is_the_first_to_the_last_bit():
    opens = {"w": {"at": "b", "kind": "switch", "time": "0.271 ns", "before": 50, "after": "inf"}}
    runs = Convolved(describe(with_loads(opens)), [])
    one, other = (runs.run(Resolution(5, 0.05e-9, layers=1e-3)).probes["far"] for _ in range(2))
    for wave, same in zip(one.waves, other.waves, strict=True):
        assert np.array_equal(wave.values, same.values)
        assert np.array_equal(wave.pieces.values, same.pieces.values)


def test_jumps_arrive_after_every_delay():
    line = {"z0": 50, "length": "0.1 m", **SKIN}
    source = {"kind": "voltage", "resistance": 25}
    scene = Scene(
        medium="electrical", t_end="6 ns",
        lines={
            "p": {"nodes": ["a", "m"], "delay": "1 ns"} | line,
            "q": {"nodes": ["m", "b"], "delay": "1.5 ns"} | line,
        },
        sources={
            "s": source | {"at": "a", "value": {"shape": "step", "to": 1, "at": "0.2 ns"}},
            "r": source | {"at": "b", "value": {"shape": "ramp", "to": 1, "duration": "1 ns"}},
        },
        probes={"m": {"at": "m"}},
    )  # fmt: skip
    found = arrivals(describe(scene))
    assert found["a"] == pytest.approx([0.2e-9, 2.2e-9, 4.2e-9, 5.2e-9])
    assert found["m"] == pytest.approx([1.2e-9, 3.2e-9, 4.2e-9, 5.2e-9])
    assert found["b"] == pytest.approx([2.7e-9, 4.7e-9, 5.7e-9])


def test_a_steady_start_stays():
    scene = pipe(value={"shape": "constant", "level": 3}, t_end=0.1, friction=ZIELKE)
    steady = Scene.model_validate(scene.table() | {"start": "steady"})
    result = Convolved(describe(steady), []).run(Resolution(3, 1e-3))
    assert result.probes["far"].u == pytest.approx(3.0, abs=1e-12)


def test_the_inside_of_a_line_follows_from_its_ends():
    scene = cable(t_end="4 ns", **SKIN)
    result, t = simulate(scene, tol=1e-4, record=["line"]), ["1.3e-9", "2.9e-9", "3.7e-9"]
    exact = lossy_response(scene.lines["line"].losses.exact, t, 0.1, source=25, load=100).u
    seen = inside(result, "line").effort(np.array(t, float), 0.5)
    assert seen == pytest.approx([float(u) for u in exact], abs=5e-3)  # of second order in a sixteenth of the line


def test_energies_are_accounted_for_in_slabs():
    result = simulate(cable(t_end="4 ns", **SKIN), tol=1e-3, ledger=True)
    assert result.resolution.convolved
    source = next(entry for entry in result.ledger.entries if entry.where == "sources.s")
    u, y = result.probes["near"].at(t := np.linspace(0, 4e-9, 4001)).u, result.probes["near"].at(t).y
    assert source.supplied - source.dissipated == pytest.approx(np.trapezoid(u * y, t), rel=2e-3)
