"""Lossy lines: circuits in cells against their plain twins, their maps, and what scenes with losses refuse."""

import re

import numpy as np
import pytest
from lossy_scenes import cable, pipe

from tline import InputError, Scene, SceneError, simulate
from tline.frequency import resonances, respond
from tline.loss import Foster
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe
from tline.solver.description.lines import one_step
from tline.solver.description.resolution import Resolution, resolution
from tline.solver.description.slab import cell_of
from tline.solver.kernel.blocks import NEAR
from tline.solver.kernel.diamonds.cells import pass_cells
from tline.solver.loop.march import Kernel
from tline.solver.radau import basis

VISCOUS = {"viscosity": "0.0347 Pa s"}


@pytest.mark.parametrize(
    "scene", [cable(resistance=200, conductance=0.01), cable(skin={"resistance": 60, "frequency": "10 GHz"})]
)
def test_circuits_of_cells_are_their_plain_twins(scene):
    """In cells of one slab of order 2, pair by pair; friction is no more than what a resistance takes."""
    h = float(scene.lines["line"].parameters.delay) / 5
    assembly = assemble(describe(scene), set(), Resolution(2, h, diamonds=False))
    net, state, rng = assembly.network, assembly.state, np.random.default_rng(1)
    net.diamonds.constants[:] = 0.0
    state.waves[:], memory = rng.normal(size=state.waves.shape), net.diamonds.memory
    state.memory[:] = rng.normal(size=state.memory.shape)
    slabs, states, kernel = state.waves.reshape(10, 2).copy(), state.memory.copy(), Kernel(net, state)
    for later in range(2):
        for i in range(5 - later):
            a, b, column = (-1 - i) % 10, -1 - (4 - later - i) + 5, 2 * i + later
            for c, sign in enumerate(memory.sign):
                n, at = memory.modes[c], memory.at[c, int(column in (0, 8))]
                D, C, B, decay = np.split(memory.maps[at : at + 4 + 5 * n], np.cumsum([4, 2 * n, 2 * n]))
                x = states[memory.state_at[c] + column * n :][:n]
                w = slabs[a] + sign * slabs[b]
                e = D.reshape(2, 2) @ w + C.reshape(2, n) @ x
                x[:] = B.reshape(n, 2) @ w + decay * x
                slabs[a], slabs[b] = slabs[a] - e, slabs[b] - sign * e
    pass_cells(kernel.run(np.empty((0, 0)), np.empty((0, 2, 0))), NEAR, 1)
    assert state.waves == pytest.approx(slabs.ravel(), rel=1e-12, abs=1e-13)
    assert state.memory == pytest.approx(states, rel=1e-12, abs=1e-13)


def test_a_circuit_settles_to_its_resistance():
    order = basis(3)
    law, h = Foster(0.3, 0.0, [0.5, 2.0], [1.0, 30.0]), 0.1
    parts = np.split(one_step(law, 1.0, order, h), np.cumsum([9, 6, 6]))
    D, C, B, decay = parts[0].reshape(3, 3), parts[1].reshape(3, 2), parts[2].reshape(2, 3), parts[3]
    x = np.zeros(2)
    for _ in range(1000):
        e, x = D @ np.ones(3) + C @ x, B @ np.ones(3) + decay * x
    assert e == pytest.approx(0.3 / 2.3)  # e = w - 2 q, 2 q + 0.3 q = w


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ({"friction": {"kind": "darcey", "factor": 0.02}}, "lines.line.friction.kind: unknown, expected 'darcy'"),
        ({"friction": {"factor": 0.02}}, "lines.line.friction.kind: is missing"),
        ({"friction": {"kind": "darcy"}}, "lines.line.friction.factor: is missing"),
        ({"friction": {"kind": "darcy", "factor": -1}}, "lines.line.friction.factor: friction factor out of range"),
        ({"friction": 0.02}, "lines.line.friction: not a table"),
        ({"creep": [{"compliance": 1e-10, "time": 1}]}, "lines.line: creep needs its wall_thickness"),
    ],
)
def test_mistakes_in_pipes_are_one_sentence(line, sentence):
    with pytest.raises(SceneError, match=re.escape(sentence)):
        pipe(**line)


WIRE = {"height": "10 m", "wire_diameter": "2 cm"}


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        (WIRE | {"height": "0.5 cm"}, "lines.line.height: the conductors touch or overlap, expected more than 0.01 m"),
        (WIRE | {"earth": "-100 ohm m"}, "lines.line.earth: earth resistivity out of range, expected more than 0"),
        (WIRE | {"earth": "100 ohm"}, "lines.line.earth: this unit measures something else, expected a quantity such"),
        (WIRE | {"z0": "300 ohm"}, "lines.line.z0: follows from height and wire_diameter in air, too"),
        ({"z0": "300 ohm"}, "lines.line: earth needs its height"),
        (
            WIRE | {"attenuation": {"unit": "dB/m", "points": [[1e6, 1], [1e7, 4]]}},
            "lines.line.earth: is a loss that the",
        ),
        (WIRE | {"wire": {}}, "lines.line.wire: not one of conductivity and resistance, expected one of them"),
        (
            {"z0": 300, "delay": 1, "wire": {"resistance": 1e-4}, "earth": None},
            "lines.line.wire: its radius does not follow",
        ),
    ],
)
def test_mistakes_in_overhead_lines_are_one_sentence(line, sentence):
    with pytest.raises(SceneError, match=re.escape(sentence)) as refusal:
        cable(**{"length": "10 km", "inductance": None, "capacitance": None, "earth": "100 ohm m"} | line)
    assert "\n" not in str(refusal.value)


def test_waves_on_overhead_lines_are_as_fast_as_light_unless_said():
    given = WIRE | {"inductance": None, "capacitance": None, "earth": 100}
    fast, slow = (cable(**given | more).lines["line"].parameters for more in ({}, {"velocity_factor": "98 %"}))
    assert (fast.wave_speed, slow.wave_speed) == pytest.approx((299792458, 0.98 * 299792458))


def test_what_a_loss_needs_is_said_by_name():
    line = {"nodes": ["a", "b"], "z0": 1e8, "delay": 1, "friction": {"kind": "laminar", **VISCOUS}}
    with pytest.raises(SceneError, match=r"lines\.line: friction needs its density and area"):
        Scene(medium="hydraulic", t_end=1, lines={"line": line}, probes={"p": {"at": "a"}})
    line = {"nodes": ["a", "b"], "z0": 50, "delay": 1, "resistance": 1}
    with pytest.raises(SceneError, match=r"lines\.line: resistance needs its length"):
        Scene(medium="electrical", t_end=1, lines={"line": line}, probes={"p": {"at": "a"}})
    with pytest.raises(SceneError, match="skin and wire say the same"):
        cable(skin={"resistance": 1, "frequency": 1}, wire={"radius": "1 mm", "conductivity": 5e7})


def test_what_is_not_known_of_lossy_lines_is_refused():
    scene = cable(resistance=20)
    with pytest.raises(InputError, match=r"lines\.line: it has losses"):
        resonances(scene, 1e9)
    with pytest.raises(InputError, match=r"probes\.p\.position: inside lines\.line, which has losses"):
        _ = describe(Scene(**scene.table() | {"probes": {"p": {"line": "line", "position": "10 cm"}}})).probes
    with pytest.raises(InputError, match=r"lines\.line\.friction: depends on the size of the flow"):
        respond(pipe(friction={"kind": "darcy", "factor": 0.02}), 1j)


def test_steady_drops_and_their_slopes():
    laminar = pipe(friction={"kind": "laminar", **VISCOUS}).lines["line"]
    drop, slope = laminar.steady_drop(1e-4)
    assert drop == pytest.approx(8 * 0.0347 * 36.09 / (np.pi * 0.0127**4) * 1e-4)
    assert slope == pytest.approx(drop / 1e-4)
    darcy = pipe(friction={"kind": "darcy", "factor": 0.02}).lines["line"]
    speed = 1e-3 / (np.pi * 0.0127**2)
    assert darcy.steady_drop(-1e-3)[0] == pytest.approx(-0.02 * 36.09 / 0.0254 * 878 * speed**2 / 2)
    assert cable().lines["line"].steady_drop(1.0) == (0.0, 0.0)


def test_quasi_steady_friction_is_laminar_below_and_colebrook_above():
    pytest.importorskip("fluids")
    friction = {"kind": "quasi-steady", "roughness": "0.1 mm", **VISCOUS}
    line, plain = (pipe(friction=f).lines["line"] for f in (friction, {"kind": "laminar", **VISCOUS}))
    assert line.steady_drop(1e-4) == pytest.approx(plain.steady_drop(1e-4))
    flow = 1e-2
    drop, slope = line.steady_drop(flow)
    reynolds = 878 * flow / (np.pi * 0.0127**2) * 0.0254 / 0.0347
    factor = drop / (36.09 / 0.0254 * 878 * (flow / (np.pi * 0.0127**2)) ** 2 / 2)
    colebrook = -2 * np.log10(0.0001 / 0.0254 / 3.7 + 2.51 / (reynolds * np.sqrt(factor)))
    assert 1 / np.sqrt(factor) == pytest.approx(colebrook, rel=1e-4)  # 3.7 and 2.51 are rounded there
    assert slope == pytest.approx(
        (line.steady_drop(1.001 * flow)[0] - line.steady_drop(0.999 * flow)[0]) / 2e-5, rel=1e-4
    )
    scene = pipe("1 bar", friction=friction)
    assert simulate(scene, tol=1e-4).accuracy.met


@pytest.mark.parametrize(("length", "in_cells"), [(30.0, False), (1.0, True)])
def test_friction_is_in_cells_beside_pipes_too_short_for_diamonds(length, in_cells):
    """Diamonds are as narrow as the shortest delay, and far more than smooth friction needs."""
    pipe = {"diameter": 0.2, "wave_speed": 1000, "density": 1000, "friction": {"kind": "darcy", "factor": 0.02}}
    ends = {"long": (["a", "b"], 1000), "stub": (["b", "c"], length)}
    lines = {name: {"nodes": nodes, "length": own, **pipe} for name, (nodes, own) in ends.items()}
    scene = Scene(medium="hydraulic", t_end=20, lines=lines, probes={"c": {"at": "c"}})
    description = describe(scene)
    assert (cell_of(description, 2, resolution(description).h) > 0) == in_cells


@pytest.mark.parametrize(("length", "crowded"), [(10.0, False), (1.0, True)])
def test_fronts_of_valves_that_move_beside_very_short_pipes_are_projected(length, crowded):
    """They would multiply at its ends; what is lost of them is told."""
    pipe = {"diameter": 0.2, "wave_speed": 1000, "density": 1000, "friction": {"kind": "darcy", "factor": 0.02}}
    ends = {"long": (["a", "b"], 4000), "stub": (["b", "c"], length)}
    shut = {"shape": "ramp", "from": 1, "to": 0, "at": 0.5, "duration": 0.1}
    valve = {"at": "c", "kind": "orifice", "flow": 0.03, "pressure_drop": 1e5, "opening": shut}
    scene = Scene(
        medium="hydraulic", t_end=20, lines={n: {"nodes": at, "length": own, **pipe} for n, (at, own) in ends.items()},
        loads={"valve": valve}, probes={"c": {"at": "c"}},
    )  # fmt: skip
    assert describe(scene).crowded == crowded
