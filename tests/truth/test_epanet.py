"""What is read from EPANET files agrees with EPANET's own solution; its results are floats of 32 bits."""

from collections import defaultdict
from math import pi
from pathlib import Path

import pytest
from networks import ring

import tline as tl
from tline.errors import InputError
from tline.interchange.epanet import read_epanet
from tline.interchange.water_network import WaterNetwork, friction_of
from tline.scene.heights import GRAVITY
from tline.scene.line import Pipe

wntr = pytest.importorskip("wntr")
SHIPPED = Path(wntr.__file__).parent / "library" / "networks"
NETWORKS = ["Net1", "Net2", "Net3", "Net6", "ky4", "ky10"]
FLOAT32 = 6e-8


def losses_agree(network: WaterNetwork) -> None:
    """The pipes of a scene give the heads: to rounding of the heads, and to flows of EPANET's last step."""
    heads = {name: node.head for name, node in network.nodes.items()}
    for name, pipe in network.pipes.items():
        if not pipe.flow and pipe.one_way:
            continue
        friction = friction_of(pipe, network.density, network.viscosity)
        table = {"nodes": pipe.nodes, "length": pipe.length, "diameter": pipe.diameter, "wave_speed": 1000}
        line = Pipe.model_validate(table | {"density": network.density, "friction": friction})
        lost = line.steady_drop(pipe.flow)[0] / (network.density * GRAVITY)
        one, two = (heads[node] for node in pipe.nodes)
        assert one - two == pytest.approx(lost, rel=2e-5, abs=4 * FLOAT32 * max(one, two) + 1e-4), name


def flows_balance(network: WaterNetwork) -> None:
    """What flows into a junction is its demand and what its emitter lets out."""
    inflow, size = defaultdict(float), defaultdict(float)
    for link in (*network.pipes.values(), *network.pumps.values(), *network.valves.values()):
        one, two = link.nodes
        inflow[one] -= link.flow
        inflow[two] += link.flow
        for node in link.nodes:
            size[node] += abs(link.flow)
    total = sum(size.values())
    for name, node in network.junctions.items():
        out = node.demand + node.emitter * max(node.head - node.elevation, 0.0) ** network.exponent
        assert inflow[name] == pytest.approx(out, rel=1e-5, abs=1e-5 * size[name] + 1e-7 * total), name


@pytest.mark.parametrize("name", NETWORKS)
def test_shipped_networks(name):
    network = read_epanet(SHIPPED / f"{name}.inp")
    losses_agree(network)
    flows_balance(network)


@pytest.mark.parametrize(("law", "rough"), [("H-W", 120), ("C-M", 0.012), ("D-W", 0.2)])
@pytest.mark.parametrize("units", ["LPS", "GPM"])
@pytest.mark.parametrize("exponent", [0.5, 0.8])
def test_laws_and_units(tmp_path, law, rough, units, exponent):
    network = read_epanet(ring(tmp_path, units, law, rough, exponent))
    losses_agree(network)
    flows_balance(network)
    heads = {name: node.head for name, node in network.nodes.items()}
    pump = network.pumps["duty"]
    assert pump.curve is not None
    assert pump.curve.head(pump.flow) == pytest.approx(heads["lift"] - heads["suction"], rel=1e-5)


@pytest.mark.parametrize(
    "curve",
    [
        "lifting 90 75",
        "lifting 0 100\n lifting 90 75\n lifting 150 20",
        "lifting 0 90\n lifting 50 88\n lifting 90 70\n lifting 150 10",
    ],
)
def test_pump_curves_and_speeds(tmp_path, curve):
    for speed in (1.0, 0.9):
        changes = {"lifting 90 75": curve, "HEAD lifting": f"HEAD lifting SPEED {speed}"}
        network = read_epanet(ring(tmp_path, changes=changes))
        heads = {name: node.head for name, node in network.nodes.items()}
        pump = network.pumps["duty"]
        assert pump.curve is not None
        assert pump.speed == pytest.approx(speed, rel=FLOAT32)
        rise = speed**2 * pump.curve.head(pump.flow / speed)
        assert rise == pytest.approx(heads["lift"] - heads["suction"], rel=1e-5)


def test_power_pump(tmp_path):
    network = read_epanet(ring(tmp_path, changes={"HEAD lifting": "POWER 30"}))
    heads = {name: node.head for name, node in network.nodes.items()}
    pump = network.pumps["duty"]
    assert pump.power == pytest.approx(30e3)
    # EPANET works with 8.814 ft·ft³/s per horsepower
    water = network.density * GRAVITY
    assert water * pump.flow * (heads["lift"] - heads["suction"]) == pytest.approx(pump.power, rel=2e-3)


@pytest.mark.parametrize(("drawn", "low", "high"), [(0.04, 500, 2000), (0.12, 2000, 4000), (0.25, 4000, 7000)])
def test_laminar_transitional_turbulent(tmp_path, drawn, low, high):
    """A single pipe of 50 mm by Darcy and Weisbach, in each regime of Reynolds numbers."""
    text = f"""
[JUNCTIONS]
 end 0 {drawn}
[RESERVOIRS]
 lake 1
[PIPES]
 pipe lake end 1000 50 0.05 0 Open
[OPTIONS]
 UNITS LPS
 HEADLOSS D-W
[END]
"""
    (tmp_path / "pipe.inp").write_text(text)
    network = read_epanet(tmp_path / "pipe.inp")
    pipe = network.pipes["pipe"]
    assert low < 4 * pipe.flow / (pi * pipe.diameter * network.viscosity) < high
    losses_agree(network)


VALVE, COORDINATES, LIFTING = "ease a d 100 TCV 12 0", "[COORDINATES]", "lifting 90 75"
LOOP = {"spare a b 700 100 120 0 Closed": "spare b d 700 100 120 0 Open"}
CURVE = f"{LIFTING}\n kv 20 5\n kv 50 30\n kv 90 100"


STATUS, CONTROL = "[STATUS]\n ease {}", "[CONTROLS]\n LINK ease {} AT TIME 1"
RULE = """[RULES]
 RULE 1
 IF SYSTEM TIME > 9
 AND VALVE ease STATUS IS OPEN
 THEN PUMP duty STATUS IS CLOSED
 ELSE VALVE ease SETTING = {}"""


@pytest.mark.parametrize(
    ("percent", "curve", "share", "others", "percent_then", "share_then"),
    [
        (40, "", 0.4, "", 40, 0.4),
        (100, "", 1.0, "", 100, 1.0),
        (10, "kv", 0.025, "", 10, 0.025),
        (35, "kv", 0.175, "", 35, 0.175),
        (0, "kv", 0.1, STATUS, 60, 0.3 + 0.7 / 4),
        (35, "kv", 0.175, CONTROL, 25, 0.05 + 0.25 / 6),
        (35, "", 0.35, RULE, 22, 0.22),
    ],
)
@pytest.mark.filterwarnings("ignore::tline.errors.LeftOutWarning")
def test_positional_valves(tmp_path, percent, curve, share, others, percent_then, share_then):
    """Lose what a throttle valve does whose K is that wide open over the square of the share, and say their opening."""
    networks = []
    for valve, then in (
        (f"TCV {2.5 / share**2} 2.5", 2.5 / share_then**2),
        (f"PCV {percent} 2.5 {curve}", percent_then),
    ):
        changes = {VALVE: f"ease a d 100 {valve}", COORDINATES: f"{others.format(then)}\n{COORDINATES}", LIFTING: CURVE}
        networks.append(read_epanet(path := ring(tmp_path, changes=LOOP | changes), hour=2))
    expected, found = networks
    assert found.valves["ease"].flow == pytest.approx(expected.valves["ease"].flow, rel=1e-9)
    for name, node in expected.nodes.items():
        assert found.nodes[name].head == pytest.approx(node.head, rel=1e-9)
    link = tl.read(path, hour=2, wave_speed=1000).links["ease"]
    assert link.opening.level == pytest.approx(percent_then / 100, rel=1e-9)


def test_a_positional_valve_at_nought_is_shut(tmp_path):
    network = read_epanet(ring(tmp_path, changes={VALVE: "ease a d 100 PCV 0 2.5"} | LOOP))
    assert (network.valves["ease"].flow, network.valves["ease"].share) == (0, 0)


@pytest.mark.parametrize(
    ("setting", "others", "said"),
    [
        ("-1 2", "", "ease.*percentage.*-1"),
        ("40 2 none", "", "curve 'none'"),
        ("40 2 kv", "[CURVES]\n kv 95 90", "curve 'kv'.*rise to 100"),
        ("40 2", "[STATUS]\n a z 40", "range of links"),
        ("40 2", "[RULES]\n RULE 1\n IF VALVE ease SETTING > 2\n THEN PUMP duty STATUS IS OPEN", "how far"),
        ("wide 2", "", "Error 202"),
    ],
)
def test_positional_valves_that_are_not_translated(tmp_path, setting, others, said):
    changes = {VALVE: f"ease a d 100 PCV {setting}", LIFTING: CURVE, COORDINATES: f"{others}\n{COORDINATES}"}
    with pytest.raises(InputError, match=said):
        read_epanet(ring(tmp_path, changes=changes))
