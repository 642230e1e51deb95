"""The electrical scenes with circuits as decks for ngspice, written by hand; nodes have the names of the scenes.

REL makes a T element see corners that arrive: smaller ones than by itself, for each costs it a step.
"""

from math import exp, log
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.result.result import Result
from tline.study.programs import ngspice

INSTANTS = 4000  # at most, at which a run is compared

DIODE = ".model D D(IS=1n N=1)"


def table(name: str, nodes: str, points: list[tuple[float, float]]) -> str:
    """A source of current that follows straight lines between points of voltage and current."""
    plus, minus = nodes.split()
    v = f"v({plus},{minus})" if minus != "0" else f"v({plus})"
    (u, i), *rest = points
    slopes = [(j - i) / (b - a) for (a, i), (b, j) in zip(points, rest, strict=False)]
    bends = [
        f"({new - old!r})*max({v}-({at!r}),0)" for old, new, (at, _) in zip(slopes, slopes[1:], rest, strict=False)
    ]
    return f"B{name} {plus} {minus} i={i!r}+({slopes[0]!r})*({v}-({u!r}))" + "".join(f"+{bend}" for bend in bends)


TOP = 0.4 * 68 / (68 - 0.4) * log(68 / 0.4)  # us, when the surge is highest
SURGE = 3e3 / (exp(-TOP / 68) - exp(-TOP / 0.4))  # A
ARRESTER = [(150e3, 1.0), (200e3, 100.0), (230e3, 1e3), (260e3, 5e3), (290e3, 10e3)]
DECKS = {
    "ddr_receiver": [
        "Vdata die 0 PULSE(0 1.2 0.2n 0.2n 0.2n 1.4n 3.2n)",
        table("driver", "die pad", [(-1.2, -34e-3), (-0.4, -20e-3), (0.4, 20e-3), (1.2, 34e-3)]),
        "T1 pad 0 ball 0 Z0=50 TD=0.4n REL=0.1",
        "C1 ball 0 1.5p",
        "Vsupply supply 0 DC 1.2",
        "D1 ball supply D",
        "D2 0 ball D",
        DIODE,
    ],
    "multi_drop_bus": [
        "V1 s 0 PULSE(0 1.5 0.1n 0.2n 0.2n 2.8n 6n)",
        "R1 s driver 30",
        "T1 driver 0 tap1 0 Z0=50 TD=0.5n REL=0.1",
        "T2 tap1 0 tap2 0 Z0=50 TD=0.3n REL=0.1",
        "T3 tap2 0 tap3 0 Z0=50 TD=0.3n REL=0.1",
        "T4 tap3 0 end 0 Z0=50 TD=0.2n REL=0.1",
        "Rend end 0 50",
        *(f"Rd{k} tap{k} stub{k} 15" for k in (1, 2, 3)),
        *(f"Ts{k} stub{k} 0 chip{k} 0 Z0=60 TD=0.1n REL=0.1" for k in (1, 2, 3)),
        "C1 chip1 0 2p",
        "C2 chip2 0 3p",
        "C3 chip3 0 5p",
    ],
    "ac_coupled": [
        "V1 s 0 PULSE(0 0.8 20n 20n 20n 580n 1u)",
        "R1 s driver 50",
        "T1 driver 0 before 0 Z0=50 TD=5n",
        "C1 before after 100n",
        "T2 after 0 receiver 0 Z0=50 TD=15n",
        "R2 receiver 0 60",
    ],
    "via_tdr": [
        "V1 s 0 PULSE(0 0.5 0.1n 35p 35p 1)",
        "R1 s instrument 50",
        "T1 instrument 0 upper_pad 0 Z0=50 TD=0.3n",
        "C1 upper_pad 0 0.06p",
        "L1 upper_pad lower_pad 0.5n",
        "C2 lower_pad 0 0.06p",
        "T2 lower_pad 0 end 0 Z0=50 TD=0.3n",
        "R2 end 0 50",
    ],
    "pad_6db": [
        "V1 s 0 PULSE(0 2 1n 0.5n 0.5n 3n)",
        "R1 s generator 50",
        "T1 generator 0 in 0 Z0=50 TD=3n REL=0.01",
        "R2 in 0 150.5",
        "R3 in out 37.35",
        "R4 out 0 150.5",
        "T2 out 0 end 0 Z0=50 TD=5n REL=0.01",
        "R5 end 0 1e15",
    ],
    "l_match": [
        "V1 s 0 SIN(0 2 78meg)",
        "R1 s transmitter 50",
        "T1 transmitter 0 coil 0 Z0=50 TD=6n",
        "L1 coil feed 176.7n",
        "C1 feed 0 17.67p",
        "T2 feed 0 antenna 0 Z0=200 TD=4n",
        "R2 antenna 0 200",
    ],
    "lightning": [
        f"B1 0 strike i=({SURGE!r})*(exp(-time/68u)-exp(-time/0.4u))",  # EXP would begin its tail a step late
        "T1 west 0 strike 0 Z0=350 TD=1u REL=0.1",
        "R1 west 0 350",
        "T2 strike 0 station 0 Z0=350 TD=2u REL=0.1",
        "C1 station 0 2n",
        table("arrester", "station 0", [(-u, -i) for u, i in ARRESTER[::-1]] + ARRESTER),
    ],
    "balun": [
        "V1 s 0 PULSE(0 2 1n 1n 1n 9n 20n)",
        "R1 s generator 50",
        "T1 generator 0 in 0 Z0=50 TD=2n REL=0.1",
        "L1 in 0 1u",
        "L2 plus minus 2u",
        "K1 L1 L2 0.99",
        "T2 plus 0 end_plus 0 Z0=50 TD=3n REL=0.1",
        "T3 minus 0 end_minus 0 Z0=50 TD=3n REL=0.1",
        "R2 end_plus 0 50",
        "R3 end_minus 0 75",
    ],
}


class Spice(NamedTuple):
    """A run in ngspice: the largest distance from ours, relative to the amplitude, its waves, and its seconds."""

    distance: float
    waves: dict[str, NDArray]
    seconds: float

    def change(self, coarser: "Spice") -> float:
        """Largest difference from a run with wider steps, relative to the amplitude."""
        t, at = self.waves["time"], coarser.waves["time"]
        moved = [
            np.abs(np.interp(at, t, u) - coarser.waves[key]).max() / np.abs(u).max()
            for key, u in self.waves.items()
            if key != "time"
        ]
        return float(max(moved))


def in_ngspice(name: str, ours: Result, steps: int) -> Spice:
    """A scene with so many steps in its shortest delay at least."""
    step = min(float(line.parameters.delay or 0) for line in ours.scene.single_lines.values()) / steps
    options = f".options acct reltol=1e-6 gmin=1e-20 abstol=1e-15 vntol=1e-9 minbreak={step / 100!r}"
    saved = ".save " + " ".join(f"v({probe})" for probe in ours.probes)
    transient = f".tran {step!r} {float(ours.scene.t_end)!r} 0 {step!r} uic"
    text = "\n".join([f"* {name}", *DECKS[name], options, saved, transient, ".end", ""])
    waves, seconds, _ = ngspice.transient(text)
    t = waves["time"]
    chosen = np.unique(np.linspace(1, len(t) - 1, INSTANTS).astype(int))
    off = [
        np.abs(waves[f"v({key})"][chosen] - probe.at(t[chosen]).u).max() / np.abs(probe.u).max()
        for key, probe in ours.probes.items()
    ]
    return Spice(float(max(off)), waves, seconds)
