"""Elements between nodes: the same impedances as of loads, and ports of two nodes each."""

from math import sqrt

import numpy as np
import pytest

from tline import Scene
from tline.scene import Capacitor, Impedance, Inductor, Parallel, Resistor, Series, Source
from tline.scene.heights import taken_as_zero
from tline.scene.multiport import ControlledSource, CoupledInductors, Gyrator, Ports, Transformer
from tline.solver.description.elements import active_impedances

R, L, C, BETWEEN = 50.0, 2e-9, 3e-12, ("a", "b")


@pytest.mark.parametrize(
    ("link", "z"),
    [
        (Resistor(nodes=BETWEEN, resistance=R), lambda s: R),
        (Inductor(nodes=BETWEEN, inductance=L), lambda s: s * L),
        (Capacitor(nodes=BETWEEN, capacitance=C), lambda s: 1 / (s * C)),
        (Series(nodes=BETWEEN, resistance=R, inductance=L, capacitance=C), lambda s: R + s * L + 1 / (s * C)),
        (Parallel(nodes=BETWEEN, resistance=R, capacitance=C), lambda s: 1 / (1 / R + s * C)),
        (Impedance(nodes=BETWEEN, numerator=["2 nH", 50], denominator=[1]), lambda s: s * L + R),
    ],
)
def test_links_have_their_impedance(link, z):
    s = 1e9 + 3e9j
    assert link.rational()(s) == pytest.approx(z(s), rel=1e-14)


@pytest.mark.parametrize(
    ("element", "given"),
    [
        (Inductor, {"inductance": "2 nH"}),
        (Capacitor, {"capacitance": "3 pF"}),
        (Series, {"resistance": 50, "capacitance": "3 pF"}),
        (Parallel, {"inductance": "2 nH", "capacitance": "3 pF"}),
        (Impedance, {"expression": "R + s*L", "parameters": {"R": 5, "L": "2 nH"}}),
    ],
)
def test_they_are_those_of_the_loads_of_that_kind(element, given):
    between, at_node = element(nodes=BETWEEN, **given), element(at="a", **given)
    assert between.rational() == at_node.rational()
    assert between.kind == at_node.kind


def test_systems_of_others_become_links():
    from scipy.signal import lti

    link = Impedance.from_system(lti([2.0, 5.0], [1.0]), nodes=BETWEEN)
    assert link.nodes == BETWEEN
    assert link.rational()(3.0) == pytest.approx(11)


TWO_PORTS = [
    (Transformer, {"ratio": 2.5}),
    (Gyrator, {"resistance": 50}),
    (ControlledSource, {"gain": 3, "resistance": 40}),
    (ControlledSource, {"transconductance": 0.02}),
    (CoupledInductors, {"inductance": [1e-6, 4e-6], "coupling": -0.5}),
]


def impedance(ports: Ports, s: complex, loads: np.ndarray, driven: int) -> np.ndarray:
    """Efforts at the terminals where 1 A flows in at one of them, with a conductance at each."""
    M, N, E, Q, P, R = ports
    states = np.linalg.inv(s * np.eye(len(Q)) - Q) if len(Q) else np.zeros((0, 0))
    of_efforts, of_flows = M - E @ states @ P, N - E @ states @ R
    return np.linalg.solve(of_efforts - of_flows @ loads, -of_flows[:, driven])  # i = current in - loads·u


@pytest.mark.parametrize(("kind", "given"), TWO_PORTS)
def test_ports_between_nodes_see_differences_alone(kind, given):
    """A conductance from each terminal to the reference: half of each is in series across the port."""
    grounded, s = kind(nodes=("a", "c"), **given).ports(), 2e6 + 1e6j
    floating = kind(nodes=("a", "b", "c", "d"), **given).ports()
    one = impedance(grounded, s, np.diag([0.01, 0.005]), 0)
    four = impedance(floating, s, np.diag([0.02, 0.02, 0.01, 0.01]), 0)
    across = np.array([four[0] - four[1], four[2] - four[3]])
    assert across == pytest.approx(one / 2, rel=1e-12)  # of 1 A into a, half of it drives the port


@pytest.mark.parametrize(("kind", "given"), TWO_PORTS)
def test_nothing_stays_within_a_port(kind, given):
    ports = kind(nodes=("a", "b", "c", "d"), **given).ports()
    assert [matrix.shape[0] for matrix in ports[:3]] == [4, 4, 4]
    for flows in ([1, -1, 0, 0], [0, 0, 1, -1]):
        assert not (ports.N[2:] @ flows).any()
    assert (ports.M.sum(axis=1) == 0).all()  # all efforts may rise together
    assert np.allclose(ports.P.sum(axis=1), 0, atol=1e-9)


def test_a_common_return_is_named_twice():
    pair = CoupledInductors(nodes=["a", "m", "b", "m"], inductance=[1, 4], coupling=0.5)
    assert pair.nodes == ("a", "m", "b", "m")
    assert pair.ports().M.shape == (4, 4)
    assert not pair.is_grounded


def test_an_active_impedance_is_found_between_nodes_too():
    line = {"nodes": BETWEEN, "z0": 50, "delay": 1}
    links = {"x": Impedance(nodes=BETWEEN, expression="s - 2"), "r": Resistor(nodes=BETWEEN, resistance=2)}
    scene = Scene(medium="electrical", t_end=1, lines={"l": line}, links=links, probes={"p": {"at": "a"}})
    assert list(active_impedances(scene)) == ["links.x"]


def test_terminals_of_sources():
    assert Source(at="a", kind="voltage", value=1).terminals == ("a", None)
    assert Source(nodes=["a", "b"], kind="voltage", value=1).terminals == BETWEEN


def test_heights_follow_links_and_sources_and_matter_to_ports_at_nodes_alone():
    def known(**parts) -> Scene:
        pipe = {"nodes": ["a", "b"], "z0": 1e8, "delay": 1, "density": 1000}
        tail = {"nodes": ["c", "d"], "z0": 1e8, "delay": 1}
        lines, nodes = {"pipe": pipe, "tail": tail}, {node: {"elevation": 5} for node in "ab"}
        return Scene(medium="hydraulic", t_end=1, probes={"p": {"at": "a"}}, lines=lines, nodes=nodes, **parts)

    assert "c" not in known().heights
    lift = known(sources={"x": {"nodes": ["c", "b"], "kind": "pressure", "value": 1}})
    assert lift.heights["d"].per_metre == pytest.approx(9806.65)
    assert taken_as_zero(lift) == []
    coil = {"kind": "inductor", "inductance": 1, "nodes": ["b", "c"]}
    assert taken_as_zero(known(links={"x": coil})) == []
    at_nodes = {"kind": "transformer", "ratio": sqrt(2), "nodes": ["b", "c"]}
    assert "'c'" in taken_as_zero(known(links={"x": at_nodes}))[0]
    assert taken_as_zero(known(links={"x": at_nodes | {"nodes": ["a", "b", "c", "d"]}})) == []
