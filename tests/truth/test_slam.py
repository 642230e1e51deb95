"""A check valve whose disc has inertia, against its equation of motion by DOP853."""

import numpy as np
import pytest
from hydraulic_by_hand import pipe
from method_of_steps import Motion, integrate

from tline import Scene, SceneError, simulate

DIAMETER, K = 0.2, 50.0
BORE = np.pi / 4 * DIAMETER**2
WIDE = BORE * np.sqrt(2 / (K * 1000))
BEFORE, AFTER, HIGH = 8.2e5, 1e5, 8e5
CRACKING, OPEN = 100.0, 400.0
DISC = {
    "disc_mass": 12, "travel": 0.1, "cracking_pressure": CRACKING, "open_pressure": OPEN, "damping": 40,
}  # fmt: skip
M, D = (value * 0.1 / BORE for value in (12, 40))
PIPES = pipe(200, DIAMETER, 1000), pipe(400, DIAMETER, 1000)
PIPE = {"diameter": DIAMETER, "wave_speed": 1000, "density": 1000}


def scene(**disc) -> Scene:
    """A main that is fed from below, by a pressure that falls."""
    fall = {"shape": "ramp", "from": BEFORE, "to": AFTER, "at": 1, "duration": 0.5}
    valve = {"kind": "check valve", "nodes": ["a", "b"], "loss_coefficient": K, "diameter": DIAMETER}
    return Scene(
        medium="hydraulic",
        t_end=3.5,
        start="steady",
        lines={
            "up": {"nodes": ["low", "a"], "length": 200, **PIPE},
            "main": {"nodes": ["b", "high"], "length": 400, **PIPE},
        },
        links={"valve": valve | DISC | disc},
        loads={"high": {"at": "high", "kind": "reservoir", "pressure": HIGH}},
        sources={"low": {"at": "low", "kind": "pressure", "value": fall}},
        probes={"a": {"at": "a"}, "b": {"at": "b"}},
    )


def by_hand() -> Motion:
    """M·x'' = drop - closing pressure - D·x', between the stop (2), moving (1) and shut (0)."""
    z = PIPES[0].z0 + PIPES[1].z0

    def flow(x, w):
        d, c = w[1] - w[2], x * WIDE
        return 2 * d * c / (z * c + np.sqrt((z * c) ** 2 + 4 * abs(d)))

    def drop(x, w):
        return w[1] - w[2] - z * flow(x, w)

    def opening(x, mode):
        return max(x[0], 0.0) if mode[0] == 1 else float(mode[0] == 2)

    def circuit(t, x, w, mode):
        q = flow(opening(x, mode), w)
        closing = CRACKING + (OPEN - CRACKING) * x[0]
        push = (drop(opening(x, mode), w) - closing - D * x[1]) / M
        rates = np.array([x[1], push]) if mode[0] == 1 else np.zeros(2)
        efforts = np.interp(t, [0, 0.5], [BEFORE, AFTER]), w[1] - PIPES[0].z0 * q, w[2] + PIPES[1].z0 * q, HIGH
        return rates, np.array(efforts)

    def edges(t, x, w, mode):
        leaves = drop(1.0, w) - OPEN if mode[0] == 2 else np.inf
        return [(np.inf, x[0] if mode[0] == 1 else leaves)]

    q = WIDE * np.sqrt(BEFORE - HIGH)
    efforts = np.array([BEFORE, BEFORE, HIGH, HIGH])
    z0 = np.repeat([line.z0 for line in PIPES], 2)
    return integrate(
        circuit, [*PIPES], 2.4, scale=[1.0, 1.0], state=[1.0, 0.0], edges=edges, mode=(2,), corners=(0.5,),
        steady=[*efforts, *(efforts + np.array([-1, 1, -1, 1]) * z0 * q)], longest=0.02, rtol=1e-12,
    )  # fmt: skip


def test_a_disc_slams_as_its_equation_of_motion_has_it():
    """But in the slabs in which it meets its seat, and their echoes."""
    result = simulate(scene(), tol=1e-4)
    motion = by_hand()
    times = np.linspace(0.05, 2.35, 400)
    u, y = motion.probe(2, times)
    probe = result.probes["b"].at(times + 1.0)
    assert np.median(np.abs(probe.u - u)) < 1e-6 * HIGH
    assert np.abs(probe.y - y).max() < 1e-3 * np.abs(y).max()
    fine = np.linspace(0, 2.35, 40_000)
    back = -motion.probe(2, fine)[1].min() / BORE
    assert back > 0.05
    assert result.slams["links.valve"] == pytest.approx(back, rel=1e-3)
    assert f"links.valve: liquid flows back through it at up to {back:.3g} m/s" in result.notes


def test_a_light_disc_lets_little_back():
    velocity = [simulate(scene(disc_mass=mass), tol=1e-3).slams["links.valve"] for mass in (3, 12, 48)]
    assert velocity == sorted(velocity)
    assert velocity[0] < 0.5 * velocity[-1]


@pytest.mark.parametrize("mass", [0.1, 12])
def test_the_energy_never_grows(mass):
    """The pressure below is dropped at once: the light disc chatters, too fast for these slabs."""
    given = scene(disc_mass=mass).with_changes(
        sources={"low": {"at": "low", "kind": "pressure", "value": {"shape": "step", "from": BEFORE, "to": AFTER}}},
        solver={"order": 3, "slab": "7 ms"},
    )
    ledger = simulate(given, ledger=True).ledger
    (valve,) = (entry for entry in ledger.entries if entry.where == "links.valve")
    assert valve.created <= 1e-9 * ledger.turnover
    assert valve.dissipated > 0


@pytest.mark.parametrize(
    ("disc", "said"),
    [
        ({"travel": None}, "travel: is missing, expected that of the disc, with disc_mass"),
        ({"disc_mass": None}, "travel: is of a disc that moves, expected disc_mass beside it"),
        ({"open_pressure": 10}, "open_pressure: too low, expected at least the 100 Pa at the seat, got 10 Pa"),
        ({"loss_coefficient": None, "diameter": None}, "diameter: is missing, expected a capacity and the bore"),
    ],
)
def test_a_disc_that_is_not_told(disc, said):
    table = scene().table()
    valve = {key: value for key, value in (table["links"]["valve"] | disc).items() if value is not None}
    with pytest.raises(SceneError, match=said):
        Scene(**table | {"links": {"valve": valve}})
