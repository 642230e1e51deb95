"""The two waves: a runs toward end 2 of a line, b toward end 1, and what one sees is their sum and difference."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.pictures.along import waves_along
from tline.pictures.path import Leg, Route, axis
from tline.pictures.spread import spread
from tline.pictures.style import COLOURS, DASHES, Picture, figure, name_nodes, styled
from tline.solver.result.dense_output import curve
from tline.solver.result.result import Result
from tline.units import handy
from tline.words.wording import nearest, shown

PIXELS = 300, 600  # places, instants
LABELS = ("a = u + z0·y, toward end 2", "b = u - z0·y, toward end 1")


@styled
def plot_waves(result: Result, probe: str | None = None) -> Picture:
    """Both waves at a probe over time, and the effort, which is half their sum.

    Parameters
    ----------
    result : Result
        A finished run.
    probe : str, optional
        Not needed if there is one only.

    Raises
    ------
    InputError
        There is no such probe, several and none is named, or no line ends where it stands.
    """
    if probe is None and len(result.probes) > 1:
        raise InputError("probe", "several, and none is named", nearest("", [*result.probes]))
    name = next(iter(result.probes)) if probe is None else probe
    if name not in result.probes:
        raise InputError("probe", "no such probe", nearest(str(name), [*result.probes]), shown(name))
    if not result.probes[name].has_flow:
        raise InputError("probe", f"no line ends at '{name}', so no waves pass", "a probe on a line")
    seen = curve(result.probes[name])
    size, unit = handy(float(max(abs(seen.a).max(), abs(seen.b).max())), result.medium.shown["effort"])
    second, time_unit = handy(float(result.t[-1]), "s")
    picture = figure(8.0, 4.2, result.scene.title)
    axes = picture.subplots()
    line = result.probes[name].line
    for k, (values, label) in enumerate(zip((seen.a, seen.b), LABELS, strict=True)):
        axes.plot(seen.t / second, values / size, color=COLOURS[k], linestyle=DASHES[k], label=label)
    axes.plot(
        seen.t / second, seen.u / size, color=COLOURS[6], linewidth=0.9, label=f"{result.medium.effort} u = (a + b)/2"
    )
    axes.set_xlabel(f"time [{time_unit}]")
    axes.set_ylabel(f"waves of {line} at {name} [{unit}]")
    axes.grid(True)
    axes.margins(x=0)
    picture.legend(loc="outside lower center", ncols=3)
    return picture


def plot_line_waves(result: Result, line: str) -> Picture:
    """Both waves on a line over place and time, which runs down: a leans one way, b the other.

    Parameters
    ----------
    result : Result
        A finished run in which the line was recorded.
    line : str
        Name of a line.

    Raises
    ------
    InputError
        There is no such line, or it was not recorded.
    """
    if line not in result.scene.lines:
        raise InputError("line", "no such line", nearest(str(line), [*result.scene.lines]), shown(line))
    parameters, nodes = result.scene.single_lines[line].parameters, result.scene.single_lines[line].nodes
    end, unit = (parameters.length, "m") if parameters.length else (parameters.delay or 0.0, "s")
    return plot_path_waves(result, Route((nodes[0], nodes[1]), (Leg(line, True, 0.0, (0.0, end)),), (0.0, end), unit))


@styled
def plot_path_waves(result: Result, way: Route) -> Picture:
    """Both waves along a route over place and time, which runs down.

    Parameters
    ----------
    result : Result
        A finished run in which the route's lines were recorded.
    way : Route
        From `route(scene)`.
    """
    across, down = PIXELS
    t, x = (np.arange(down) + 0.5) / down * result.t[-1], (np.arange(across) + 0.5) / across * way.marks[-1]
    return _images(result, waves_along(result, way, x, t), way)


def _images(result: Result, both: NDArray, way: Route) -> Picture:
    size, unit = handy(float(abs(both).max()), result.medium.shown["effort"])
    second, time_unit = handy(float(result.t[-1]), "s")
    length, place = axis(way, result.scene)
    low, high = spread(float(both.min() / size), float(both.max() / size))
    picture = figure(9.0, 4.8, result.scene.title)
    panels = picture.subplots(1, 2, sharey=True)
    extent = (0.0, way.marks[-1] / length, float(result.t[-1]) / second, 0.0)
    look: Any = {"cmap": "viridis", "vmin": low, "vmax": high, "aspect": "auto", "extent": extent}
    labels = (f"a = u + z0·y, toward {way.nodes[-1]}", f"b = u - z0·y, toward {way.nodes[0]}")
    for axes, values, label in zip(panels, both, labels, strict=True):
        axes.imshow(values / size, interpolation="antialiased", **look)
        name_nodes(axes, {mark / length: name for mark, name in way.labels.items()})
        axes.set_title(label, loc="left", fontsize=10, pad=22)
        axes.set_xlabel(place)
    panels[0].set_ylabel(f"time [{time_unit}]")
    bar = picture.colorbar(panels[0].images[0], ax=panels, pad=0.02, fraction=0.06)
    bar.set_label(f"wave [{unit}]")
    bar.outline.set_visible(False)
    return picture
