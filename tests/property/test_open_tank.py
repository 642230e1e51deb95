"""What a tank with a rim and a bottom holds, and the waves before it, only lose."""

from energy import never_grows
from hypothesis import given, settings
from hypothesis import strategies as st

from tline.scene.scene import Scene

AT_ONCE = 2e-14  # of the energy at the start, in one slab: roundings


@settings(max_examples=12, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    order=st.integers(1, 7),
    slab=st.floats(0.05, 0.49),
    bottom=st.floats(-0.5, 0.0),
    rim=st.floats(0.01, 0.5),
    losses=st.tuples(st.floats(1e-3, 5), st.floats(1e-3, 5)),
    one_way=st.booleans(),
)
def test_stored_energy_never_grows(seed, order, slab, bottom, rim, losses, one_way):
    ends = {"lowest_level": bottom, "highest_level": rim, "loss_in": losses[0], "loss_out": losses[1]}
    tank = {"kind": "open tank", "tank_area": 1.0, "bore": 1.0, "gravity": 1.0, "density": 1.0, "one_way": one_way}
    scene = Scene(
        medium="hydraulic",
        t_end=20.0,
        lines={"pipe": {"nodes": ["a", "b"], "z0": 1.0, "delay": 1.0}},
        loads={"x": {"at": "b"} | tank | ends},
        probes={"b": {"at": "b"}},
        solver={"order": order, "slab": slab},
    )

    def held(assembly):
        laws = assembly.network.laws
        return laws.constants[3] * assembly.state.load[laws.state_at[0]] ** 2 / 2

    never_grows(scene, seed, held, AT_ONCE)
