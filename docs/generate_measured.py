"""Writes the table and picture of docs/measured.md. Run: python -m docs.generate measured."""

import math
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from benchmarks.harness import DOCS, ROOT, table, write
from tline.scene.file import read_scene
from tline.scene.scene import Scene
from tline.solver.simulate import simulate
from tline.style import COLOURS, INK, figure, save_figure, styled

SCENE = ROOT / "scenes" / "column_separation.toml"
DENSITY, G, VISCOSITY, AIR = 999.1, 9.80665, 1.14e-3, 101.325  # kg/m³, m/s², Pa s, kPa
METRE = DENSITY * G  # of water, Pa
LOW = -18.0  # kPa, cavity's pressure in one of the figures, which should be the vapour's, next to nothing
GAS = 1e-7  # of the water
FRICTION = ("Vardy and Brown", "as in steady flow", "none")


class Experiment(NamedTuple):
    """Pipe that rises from a tank to a valve which shuts."""

    title: str
    file: str
    length: float  # m
    diameter: float  # m
    wave_speed: float  # m/s
    head: float  # of the tank, m
    rise: float  # m
    velocity: float  # m/s
    closes: float  # s

    @property
    def joukowsky(self) -> float:
        """Rise of the head, m."""
        return self.wave_speed * self.velocity / G

    def measured(self) -> tuple[NDArray, NDArray, NDArray]:
        """Instants, and the lowest and highest head at each."""
        t, *heads = np.loadtxt(DOCS / "measured" / f"{self.file}.csv", delimiter=",", unpack=True)
        if len(heads) == 1:
            heads = [(heads[0] - LOW - AIR) * 1e3 / METRE + self.rise]
        return t, heads[0], heads[-1]

    def computed(self, friction: str, places: int, late: bool = False) -> tuple[NDArray, NDArray]:
        """Instants, and heads at the valve; a late valve stops the flow in the last tenth of its closing time."""
        table = read_scene(SCENE).table()
        area = math.pi / 4 * self.diameter**2
        gas = GAS * area * self.length / (places + 1)
        pipe = table["lines"]["pipe"]
        pipe |= {"length": self.length, "diameter": self.diameter, "wave_speed": self.wave_speed}
        pipe["cavities"] |= {"places": places, "gas_volume": gas}
        pipe["friction"]["reynolds"] = DENSITY * self.velocity * self.diameter / VISCOSITY
        if friction == FRICTION[1]:
            wall = {key: pipe["friction"][key] for key in ("viscosity", "roughness")}
            pipe["friction"] = {"kind": "quasi-steady"} | wall
        elif friction == FRICTION[2]:
            del pipe["friction"]
        table["nodes"]["valve"]["elevation"] = self.rise
        table["loads"]["tank"]["pressure"] = self.head * METRE
        table["loads"]["end"] |= {"gas_volume": gas / 2}
        begin = 0.9 * self.closes if late else 0.0
        shut = {"from": -self.velocity * area, "at": begin, "duration": self.closes - begin}
        table["sources"]["valve"]["value"] |= shut
        t_end = float(self.measured()[0][-1])
        found = simulate(Scene(**table | {"t_end": t_end})).probes["valve"]
        return found.t, found.u / METRE


EXPERIMENTS = (
    Experiment("Adelaide, 0.30 m/s", "adelaide_0.30", 37.23, 22.1e-3, 1319, 22.0, 2.03, 0.30, 9e-3),
    Experiment("Adelaide, 1.40 m/s", "adelaide_1.40", 37.23, 22.1e-3, 1319, 22.0, 2.03, 1.40, 9e-3),
    Experiment("Michigan, 0.332 m/s", "michigan_0.332", 36.0, 19.05e-3, 1280, 23.41, 1.0, 0.332, 22e-3),
)


def figures(one: Experiment, t: NDArray, low: NDArray, high: NDArray) -> tuple[float, float, float, float]:
    """Level of the first pulse, end of the cavity behind it, and highest head of the next pulse and its instant."""
    echo, half = 2 * one.length / one.wave_speed, one.head
    level = np.median((low + high)[(t > 1.2 * one.closes) & (t < 0.95 * echo)] / 2)
    shut = t[np.argmax((high < half) & (t > echo))]
    gone = t[np.argmax((low > half) & (t > shut))]
    peak = np.argmax(np.where((t > gone) & (t < gone + 1.2 * echo), high, -np.inf))
    return float(level), float(gone), float(high[peak]), float(t[peak])


def off(experiment: Experiment, t: NDArray, u: NDArray) -> float:
    """Root mean square of the computed head's distance from the drawn range, over Joukowsky's rise."""
    at, low, high = experiment.measured()
    here = np.interp(at, t, u)
    return float(np.sqrt(np.mean((here - np.clip(here, low, high)) ** 2)) / experiment.joukowsky)


def measured_and_computed() -> str:
    """Compare measured and computed figures, by experiment."""
    rows = []
    cases = [(name, name, 31, False) for name in FRICTION]
    cases += [(f"{places} places", FRICTION[0], places, False) for places in (15, 63)]
    cases += [("late valve", FRICTION[0], 31, True)]
    for one in EXPERIMENTS:
        level, gone, highest, when = figures(one, *one.measured())
        said = f"{level:.0f}", f"{1e3 * gone:.0f}", f"{highest:.0f}", f"{1e3 * when:.0f}"
        rows.append((one.title, "measured", *said, ""))
        for name, *case in cases:
            t, u = one.computed(*case)
            level, gone, highest, when = figures(one, t, u, u)
            said = f"{level:.0f}", f"{1e3 * gone:.0f}", f"{highest:.0f}", f"{1e3 * when:.0f}"
            rows.append(("", name, *said, f"{100 * off(one, t, u):.0f} %"))
    return table("<|<friction|first pulse, m|cavity gone, ms|highest then, m|at, ms|off by", rows)


@styled
def overlay() -> Figure:
    """Draw measured and computed heads at the valve."""
    picture = figure(8.5, 9.5, "Column separation, measured and computed")
    for axes, one in zip(picture.subplots(len(EXPERIMENTS)), EXPERIMENTS, strict=True):
        at, low, high = one.measured()
        axes.plot([], [], color=INK, linewidth=2, label="measured")
        axes.vlines(1e3 * at, low, np.maximum(high, low + 0.01 * one.joukowsky), color=INK, linewidth=1.2)
        t, u = one.computed(FRICTION[0], 31, late=True)
        axes.plot(1e3 * t, u, color=COLOURS[1], linewidth=0.9, label="tline, 31 places, late valve")
        axes.set_title(one.title, loc="left")
        axes.set(ylabel="head at the valve / m", xlim=(0, 1e3 * at[-1]))
        axes.grid(True)
    axes.set_xlabel("time / ms")
    picture.axes[0].legend(loc="upper right", ncols=2)
    return picture


if __name__ == "__main__":
    write("docs/measured.md", measured_and_computed(), "measured")
    save_figure(overlay(), DOCS / "pictures" / "measured.png")
