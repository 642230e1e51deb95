"""What an accumulator on a spring holds, and the waves before it, only lose, at its stops as well."""

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
    preload=st.floats(-0.5, 0.5),
    stroke=st.floats(0.05, 0.5),
    stiffness=st.floats(0.1, 10),
)
def test_stored_energy_never_grows(seed, order, slab, preload, stroke, stiffness):
    accumulator = {"kind": "spring accumulator", "piston_diameter": 1.0, "stiffness": stiffness, "preload": preload}
    scene = Scene(
        medium="hydraulic",
        t_end=20.0,
        lines={"pipe": {"nodes": ["a", "b"], "z0": 1.0, "delay": 1.0}},
        loads={"x": {"at": "b", "stroke": stroke} | accumulator},
        probes={"b": {"at": "b"}},
        solver={"order": order, "slab": slab},
    )

    def held(assembly):
        laws = assembly.network.laws
        return laws.constants[1] * assembly.state.load[laws.state_at[0]] ** 2 / 2

    never_grows(scene, seed, held, AT_ONCE)
