"""What a tank with a rim and a bottom, or an accumulator on a spring, holds, and the waves before it, only lose."""

from energy import never_grows
from hypothesis import given, settings
from hypothesis import strategies as st

from tline.scene.scene import Scene

AT_ONCE = 2e-14  # of the energy at the start, in one slab: roundings
ORDERS, SLABS, SEEDS = st.integers(1, 7), st.floats(0.05, 0.49), st.integers(0, 2**32 - 1)


def only_loses(load: dict, weight: int, order: int, slab: float, seed: int) -> None:
    """At the end of a pipe; half of one of its law's constants times its state squared is held."""
    scene = Scene(
        medium="hydraulic",
        t_end=20.0,
        lines={"pipe": {"nodes": ["a", "b"], "z0": 1.0, "delay": 1.0}},
        loads={"x": {"at": "b"} | load},
        probes={"b": {"at": "b"}},
        solver={"order": order, "slab": slab},
    )

    def held(assembly):
        laws = assembly.network.laws
        return laws.constants[weight] * assembly.state.load[laws.state_at[0]] ** 2 / 2

    never_grows(scene, seed, held, AT_ONCE)


@settings(max_examples=12, deadline=None)
@given(
    seed=SEEDS,
    order=ORDERS,
    slab=SLABS,
    bottom=st.floats(-0.5, 0.0),
    rim=st.floats(0.01, 0.5),
    losses=st.tuples(st.floats(1e-3, 5), st.floats(1e-3, 5)),
    one_way=st.booleans(),
)
def test_a_tank_with_a_rim_and_a_bottom(seed, order, slab, bottom, rim, losses, one_way):
    ends = {"lowest_level": bottom, "highest_level": rim, "loss_in": losses[0], "loss_out": losses[1]}
    tank = {"kind": "open tank", "tank_area": 1.0, "bore": 1.0, "gravity": 1.0, "density": 1.0, "one_way": one_way}
    only_loses(tank | ends, 3, order, slab, seed)


@settings(max_examples=12, deadline=None)
@given(
    seed=SEEDS,
    order=ORDERS,
    slab=SLABS,
    preload=st.floats(-0.5, 0.5),
    stroke=st.floats(0.05, 0.5),
    stiffness=st.floats(0.1, 10),
)
def test_an_accumulator_on_a_spring(seed, order, slab, preload, stroke, stiffness):
    spring = {"stiffness": stiffness, "preload": preload, "stroke": stroke}
    only_loses({"kind": "spring accumulator", "piston_diameter": 1.0} | spring, 1, order, slab, seed)
