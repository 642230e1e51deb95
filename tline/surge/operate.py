"""A network as it is read, and with operations on valves, pipes, pumps, demands and bursts, by events."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import accumulate, pairwise
from math import pi
from pathlib import Path
from types import UnionType
from typing import Any, NamedTuple

from tline.errors import InputError
from tline.interchange.any_file import refuse_water
from tline.interchange.water_controls import WaterControl
from tline.interchange.water_scene import read_with_controls
from tline.interchange.water_valves import gate_of, put_gate
from tline.scene.file import EPANET, as_scene
from tline.scene.held import held_nodes
from tline.scene.medium import readable
from tline.scene.outflow import Leak
from tline.scene.pump import EFFICIENCY, Pump
from tline.scene.quantity import Quantity
from tline.scene.regulating import RegulatingValve
from tline.scene.scene import Scene
from tline.scene.valve import CheckValve, Orifice
from tline.solver.description.description import describe
from tline.solver.description.excitation import just_before
from tline.solver.steady.steady_state import above_level
from tline.surge.event import FLOWING, Event
from tline.units import engineering
from tline.words.wording import nearest, place

Table = dict[str, Any]
LEAST_PRESSURE = 1e3  # Pa; an outflow is given by the gauge pressure of its node, and by no less than that
PRINTED_DIGITS = 5e-4  # of a flow, as results print four digits
SURPLUS = 1.2  # torque of a starting motor, over the most that its pump takes at rated speed
VALVE = "a valve, or an open pipe"
NOTHING: Mapping[str, Any] = {}


def operated(
    scene: Scene,
    events: Sequence[Event],
    *,
    inertia: float | str | None = None,
    rated_speed: float | str | None = None,
    more: Mapping[str, Any] = NOTHING,
) -> tuple[Scene, list[str]]:
    """Return the scene with events, none twice for an element but for demands, and notes on guesses.

    Inertia, kg m², and rated speed, 1/s, are those of pumps that trip, unless the scene has them; else usual values.
    Tables of `more` replace those of the scene.
    """
    if scene.medium != "hydraulic" or scene.start != "steady":
        got = f"medium = '{scene.medium}', start = '{scene.start}'"
        raise InputError("scene", "nothing to be operated", "medium = 'hydraulic' and start = 'steady'", got)
    work = _Operated(scene, inertia, rated_speed)
    for event in as_one_each(events):
        getattr(work, event.kind)(event)
    return Scene(scene.folder, **{**work.tables, **more}), work.notes


class _Operated:
    """Tables of a scene that events change; each kind of event has the method of its name."""

    def __init__(self, scene: Scene, inertia: float | str | None, rated_speed: float | str | None):
        self.scene, self.tables, self.notes = scene, scene.with_lines(), list[str]()
        self._rotor = {"inertia": inertia, "rated_speed": rated_speed}
        for (key, value), unit in zip(self._rotor.items(), ("kg m^2", "Hz"), strict=True):
            if value is not None and not Quantity(value, unit, key) > 0:
                raise InputError(key, "out of range", "above zero", f"{value}")
        self._description = describe(scene)
        self._before = above_level(self._description)
        self._done: set[tuple[str, str]] = set()

    def trip(self, event: Event) -> None:
        """Let a pump run down."""
        pump = self._running(event)
        table = self.tables["links"][event.name]
        speed = just_before(pump.speed)
        table.pop("speed", None)
        if speed != 1:  # rated anew, for the speed that it has
            table["curve"] = [[speed * q, speed**2 * h] for q, h in pump.curve]
        given = {key: table.get(key, value) for key, value in self._rotor.items()}
        if None in given.values():
            efforts = [self._gauge(node) + self._description.nodes[node].height.weight for node in pump.nodes]
            water = (efforts[1] - efforts[0]) * self._before.through[place("links", event.name)]
            lifted = water if water > 0 else pump.largest_power  # where its check valve holds
            given |= self._usual(event.name, lifted / float(pump.efficiency or EFFICIENCY), given)
        table |= given | {"trip": event.at}

    def start(self, event: Event) -> None:
        """Let a pump at rest run up: with its motor's torque, or in a given time."""
        pump = self._link(event, Pump, "a pump")
        table = self.tables["links"][event.name]
        returns = "trip" in table and "start" not in table
        if not returns:
            self._once(event)
        if not returns and just_before(pump.speed):
            raise InputError(
                "start", f"pump '{event.name}' runs already", "a pump of speed 0, or one that trips before"
            )
        if returns and event.duration:
            raise InputError(
                "start", "power returns to a motor at once", f"{event.name}@TIME", f"+{event.duration:g} s"
            )
        if event.duration:
            table["speed"] = event.control(0.0, 1.0)
            return
        table.pop("speed", None)
        given = {key: table.get(key, value) for key, value in self._rotor.items()}
        if None in given.values():
            given |= self._usual(event.name, pump.largest_power / float(pump.efficiency or EFFICIENCY), given)
        if "motor_torque" not in table:
            turns = 2 * pi * float(Quantity(given["rated_speed"], "Hz"))
            table["motor_torque"] = float(f"{SURPLUS * pump.largest_torque / turns:.3g}")
            told = f"{table['motor_torque']:g} N m, {SURPLUS:g} times the most that the pump takes"
            self.notes.append(f"pump '{event.name}': its motor starts it with {told}; give what it has")
        table |= given | {"start": event.at}

    def stop(self, event: Event) -> None:
        """Take a pump's speed down to nothing."""
        pump = self._running(event)
        self.tables["links"][event.name]["speed"] = event.control(just_before(pump.speed), 0.0)

    def speed(self, event: Event) -> None:
        """Bring a pump to another speed, or along a course of speeds."""
        pump = self._link(event, Pump, "a pump")
        self._once(event)
        self.tables["links"][event.name]["speed"] = event.control(just_before(pump.speed), event.speed or 0.0)

    def close(self, event: Event) -> None:
        """Shut a valve, or one that is put at the end of a pipe."""
        self._turn(event, 0.0)

    def open(self, event: Event) -> None:
        """Open a valve wide."""
        self._turn(event, 1.0)

    def burst(self, event: Event) -> None:
        """Let a flow out through a hole."""
        self._let_out(event, event.flow)

    def demand(self, event: Event) -> None:
        """Draw more, or less, at a node."""
        if event.flow > 0:
            self._let_out(event, event.flow)
        else:
            self._take_less(event, -event.flow)

    def _running(self, event: Event) -> Pump:
        pump = self._link(event, Pump, "a pump")
        self._once(event)
        if not just_before(pump.speed):
            raise InputError(event.kind, f"pump '{event.name}' stands already", "a pump that runs")
        return pump

    def _usual(self, name: str, power: float, given: Table) -> Table:
        """Inertia and rated speed of a pump with a power at the shaft, where they are not given."""
        told = given["rated_speed"]
        turns = RATED_SPEED if told is None else float(Quantity(told, "Hz"))
        guess = float(f"{usual_inertia(power, turns):.3g}")
        words = [f"{guess:g} kg m^2"] * (given["inertia"] is None) + [f"{60 * turns:.4g} rpm"] * (told is None)
        why = f"what is usual for {engineering(power, 'W')} at the shaft"
        self.notes.append(f"pump '{name}': its rotor has {' and '.join(words)}, {why}; give what it has")
        return {"rated_speed": turns, "inertia": guess if given["inertia"] is None else given["inertia"]}

    def _turn(self, event: Event, after: float) -> None:
        """Move an opening from where it is."""
        load = self.scene.loads.get(event.name)
        self._once(event)
        if event.name in self.scene.lines:
            if after and not event.course:
                raise InputError(event.kind, f"pipe '{event.name}' is open already", "a valve that is not")
            self._put_valve(event.name, event.control(1.0, after))
            return
        valve = load if isinstance(load, Orifice) else self._link(event, Orifice | RegulatingValve, VALVE)
        part = self.tables["loads" if valve is load else "links"]
        if isinstance(valve, RegulatingValve):
            kept = {key: value for key, value in part[event.name].items() if key in Orifice.link.model_fields}
            part[event.name] = kept | {"kind": "orifice"}
            before = self._before.openings[place("links", event.name)]
            self.notes.append(f"valve '{event.name}': it regulates no more, from its opening of {before:.3g} on")
        else:
            before = just_before(valve.opening)
        part[event.name]["opening"] = event.control(before, after)

    def _put_valve(self, name: str, opening: Table) -> None:
        """A gate valve at the second end of a pipe, or at the first if the second one is blind."""
        pipe = self.scene.lines[name]
        open_ = [load for load in self.scene.loads.values() if load.kind != "closed"]
        ends = [line.nodes for line in self.scene.lines.values()]
        ends += [one.terminals for one in (*open_, *self.scene.links.values(), *self.scene.sources.values())]
        end = pipe.nodes[sum(pipe.nodes[1] in each for each in ends) > 1]
        diameter, density = (getattr(pipe.parameters, key, None) for key in ("diameter", "density"))
        if diameter is None or density is None or gate_of(name) in self._description.nodes:
            raise InputError(f"line '{name}'", "no valve fits it", "its diameter and density, and no node of its name")
        node = put_gate(self.tables, name, end, {"diameter": diameter, "density": density, "opening": opening})
        self.tables["lines"][name] = pipe.table() | {"nodes": [node if one == end else one for one in pipe.nodes]}
        for probe in self.tables.get("probes", {}).values():
            if probe.get("line") == name and probe["at"] == end:
                del probe["line"]  # the line ends at the valve now
        if end in self.tables.get("nodes", {}):
            site = self.tables["nodes"][end]
            self.tables["nodes"][node] = {key: value for key, value in site.items() if key != "start"}
        loss = self.tables["links"][node]["loss_coefficient"]
        self.notes.append(f"pipe '{name}': a gate valve is put at '{end}', and loses {loss:g} velocity heads when open")

    def _let_out(self, event: Event, flow: float) -> None:
        """An outflow to the air, with the square root of the pressure."""
        self._node(event)
        if event.name in held_nodes(self.scene):
            raise InputError(
                event.kind, "the pressure there is held, so nothing comes of it", "a junction", f"'{event.name}'"
            )
        pressure = max(self._gauge(event.name), LEAST_PRESSURE)
        name = f"{event.name}:{event.kind}"
        if name in self.tables.setdefault("loads", {}):
            raise InputError(event.kind, "the scene has a load of that name", "another node", f"'{name}'")
        self.tables["loads"][name] = {
            "at": event.name, "kind": "leak", "flow": flow, "pressure": pressure, "opening": event.control(0.0, 1.0),
        }  # fmt: skip

    def _take_less(self, event: Event, flow: float) -> None:
        """Shut a part of an outflow that is there."""
        self._node(event)
        drawn = {
            name: float(load.flow)
            for name, load in self.scene.loads.items()
            if load.at == event.name and isinstance(load, CheckValve | Leak) and load.flow
        }
        name = max(drawn, key=drawn.__getitem__, default="")
        if flow > drawn.get(name, 0.0) * (1 + PRINTED_DIGITS):
            unit = readable(self.scene).shown["flow"]
            least, got = (engineering(x, unit) for x in (flow, drawn.get(name, 0.0)))
            raise InputError("demand", f"node '{event.name}' draws less", f"at least {least}", got)
        table = self.tables["loads"][name]
        if table["kind"] == "check valve":
            table = {"at": table["at"], "kind": "leak", "flow": table["flow"], "pressure": table["pressure_drop"]}
        share = max(1 - flow / drawn[name], 0.0)
        event = event._replace(course=tuple((t, 1 - x * (1 - share)) for t, x in event.course))
        self.tables["loads"][name] = table | {"opening": event.control(1.0, share)}

    def _link(self, event: Event, kind: type | UnionType, what: str) -> Any:
        link = self.scene.links.get(event.name)
        if not isinstance(link, kind):
            known = [name for name, one in self.scene.links.items() if isinstance(one, kind)]
            known += list(self.scene.lines) if what == VALVE else []
            expected = nearest(event.name, known) if known else "a scene that has one"
            raise InputError(event.kind, f"not {what}", expected, f"'{event.name}'")
        return link

    def _node(self, event: Event) -> None:
        if event.name not in self._description.nodes:
            known = list(self._description.nodes)
            raise InputError(event.kind, "no such node", nearest(event.name, known), f"'{event.name}'")
        self._once(event)

    def _once(self, event: Event) -> None:
        key = event.kind if event.kind in FLOWING else ""
        if (key, event.name) in self._done:
            raise InputError(event.kind, f"'{event.name}' is operated twice", "once; write a waveform for more")
        self._done.add((key, event.name))

    def _gauge(self, node: str) -> float:
        """Gauge pressure at a node before any operation, Pa."""
        return self._before.effort[node] - self._description.nodes[node].height.above_level


RATED_SPEED = 1450 / 60  # Hz, of a motor with four poles at 50 Hz


def usual_inertia(power: float, rated_speed: float) -> float:
    """Inertia of impeller with liquid, and motor, kg m², by the power of the shaft, W, and the rated speed, Hz.

    Regressions over many machines: a guess within a factor of two.

    References
    ----------
    A. R. D. Thorley: Fluid Transients in Pipeline Systems, 2nd edition, Professional Engineering Publishing (2004),
    with power in kW and speed in turns per minute: 1.5e7·(P/N³)^0.9556 and 118·(P/N)^1.48.
    """
    kilowatt, turns = power / 1e3, 60 * rated_speed
    return 1.5e7 * (kilowatt / turns**3) ** 0.9556 + 118 * (kilowatt / turns) ** 1.48


def as_one_each(events: Iterable[Event]) -> list[Event]:
    """The events, with those on the demand of one node as one event with a course of its share.

    Examples
    --------
    >>> rise, fall = Event("demand", "b", 1.0, 0.5, 0.005), Event("demand", "b", 4.0, 0.0, -0.005)
    >>> as_one_each([rise, fall])[0].course
    ((0.0, 0.0), (0.5, 1.0), (3.0, 1.0), (3.0, 0.0))
    """
    changes, rest = defaultdict[str, list[Event]](list), list[Event]()
    for event in events:
        (changes[event.name] if event.kind == "demand" else rest).append(event)
    return [*rest, *(_as_one(sorted(each, key=lambda event: event.at)) for each in changes.values())]


def _as_one(events: list[Event]) -> Event:
    first = events[0]
    if len(events) == 1:
        return first
    for one, two in pairwise(events):
        if two.at < one.at + one.duration or two.at == one.at:
            raise InputError("demand", f"changes at '{first.name}' overlap", "one after the other", f"{two.at:g} s")
    flows = [0.0, *accumulate(event.flow for event in events)]
    peak = max(flows, key=abs)
    shares = [round(flow / peak, 12) + 0.0 for flow in flows]  # no rounding of sums, and no -0.0
    if min(shares) < 0:
        problem = f"changes at '{first.name}' lead above and below what it drew"
        raise InputError("demand", problem, "sums that are all above, or all below")
    course = [
        (t - first.at, share)
        for event, sides in zip(events, pairwise(shares), strict=True)
        for t, share in zip((event.at, event.at + event.duration), sides, strict=True)
    ]
    return first._replace(duration=0.0, flow=peak, course=tuple(course))


class Network(NamedTuple):
    """A network that was read."""

    scene: Scene
    notes: tuple[str, ...] = ()  # on omissions from its file
    controls: tuple[WaterControl, ...] = ()  # of its file, that act within a run


def read_network(
    network: Network | Scene | str | Path | Mapping[str, Any],
    *,
    wave_speed: float | str | None = None,
    material: str | None = None,
    hour: float | None = None,
    moving_tanks: bool = False,
    opened: Collection[str] = (),
) -> Network:
    """Return the scene of a network, notes on omissions from its file, and the file's controls; see `operate`.

    Pipes that are `opened` and that the file closes are there, behind a shut gate valve.
    """
    water = {"wave_speed": wave_speed, "material": material, "hour": hour, "moving_tanks": moving_tanks or None}
    if isinstance(network, str | Path):
        suffix = Path(network).suffix.lower()
        if suffix in EPANET:
            return Network(*read_with_controls(str(network), wave_speed, material, hour or 0.0, moving_tanks, opened))
        if suffix not in ("", ".toml"):
            raise InputError(str(network), "unknown kind of file", ".inp or .toml", suffix or "no suffix")
    refuse_water(water)
    return network if isinstance(network, Network) else Network(as_scene(network))
