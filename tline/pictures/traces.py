"""Records of the probes of one or several results, over time."""

import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError, check_kind
from tline.pictures.bounds import spread
from tline.solver.result.dense_output import curve
from tline.solver.result.quantities import Quantity, in_tables
from tline.solver.result.result import Result
from tline.style import COLOURS, DASHES, Picture, check_axes, figure, styled
from tline.units import handy, to_si
from tline.words.wording import nearest, shown

WIDTH, HEIGHT, MORE = 8.0, 5.2, 2.2  # inches; more for a third panel
ONE = 3.6  # height of a single panel
MARGIN = 0.08  # of the range, above and below
ENTRY = 0.11  # inches per letter in the legend
LABELS = ("a = u + z0·y, toward end 2", "b = u - z0·y, toward end 1")
UNIT = re.compile(r"\[(.+)\]$")  # of an axis, in its label


class Panel(NamedTuple):
    """Quantity of a panel."""

    of: Quantity
    word: str
    shown: str  # unit


class Trace(NamedTuple):
    """Record of one probe of one result."""

    name: str
    where: str  # the probe
    t: NDArray
    values: Mapping[str, NDArray]  # by key of a quantity


@styled
def plot(
    results: Result | Mapping[str, Result],
    probes: Iterable[str] | None = None,
    quantity: str | None = None,
    t: ArrayLike | None = None,
) -> Picture:
    """Plot effort above, or gauge pressure and head in a scene with elevations, flow below; one curve for each probe.

    Probes at nodes where no line ends have no flow.

    Parameters
    ----------
    results : Result, or mapping of str to Result
        A finished run; or several of one medium, by their names in the legend.
    probes : iterable of str, optional
        Some of the probes.
    quantity : str, optional
        One quantity, such as ``"flow"`` or ``"voltage"``.
    t : array_like, s, optional
        Instants to be drawn; the whole run if not given.

    Returns
    -------
    matplotlib.figure.Figure
        With axes that share time.

    Raises
    ------
    InputError
        There is no result, probe or quantity of that name, or the media differ.

    Examples
    --------
    >>> import tline as tl
    >>> len(plot(tl.simulate(tl.examples["cable_rc"])).axes)
    2
    """
    named = {"": results} if isinstance(results, Result) else results
    if not isinstance(named, Mapping) or not named or not all(isinstance(each, Result) for each in named.values()):
        raise InputError("results", "not results", "a Result, or a dict of several", shown(results))
    first = next(iter(named.values()))
    if len({each.scene.medium for each in named.values()}) > 1:
        raise InputError("results", "of two media", "pipes or cables")
    panels = _asked(first, quantity)
    traces = [trace for name, each in named.items() for trace in _traces(each, probes, panels, name, t)]
    panels = [panel for panel in panels if any(panel.of.key in trace.values for trace in traces)]
    columns = max(int(WIDTH / (0.6 + ENTRY * max(len(trace.name) for trace in traces))), 1)
    rows = -(-len(traces) // columns) if len(traces) > 1 else 0
    height = ONE if len(panels) == 1 else HEIGHT + MORE * (len(panels) > 2)
    picture = figure(WIDTH, height + 0.22 * rows, first.scene.title if len(named) == 1 else "")
    ratios = [2 if panel.of.flows else 3 for panel in panels]
    both = picture.subplots(len(panels), 1, sharex=True, height_ratios=ratios, squeeze=False)[:, 0]
    handles: dict[str, Line2D] = {}
    for axes, panel in zip(both, panels, strict=True):
        handles |= _draw(axes, panel, traces)
        if axes is not both[-1]:
            axes.set_xlabel("")
    picture.align_ylabels(both)
    if len(traces) > 1:
        names = [f" {name}" for name in handles]  # a name that begins with '_' would be left out
        picture.legend(handles.values(), names, loc="outside lower center", ncols=min(columns, len(names)))
    return picture


@styled
def plot_waves(result: Result, probe: str | None = None) -> Picture:
    """Plot both waves at a probe over time, and the effort, which is half their sum.

    Parameters
    ----------
    result : Result
        A finished run.
    probe : str, optional
        Not needed if there is one only.

    Raises
    ------
    InputError
        There is no such probe, several and none is named, or no line ends at its node.
    """
    if probe is None and len(result.probes) > 1:
        raise InputError("probe", "several, and none is named", nearest("", [*result.probes]))
    name = next(iter(result.probes)) if probe is None else probe
    if not isinstance(name, str) or name not in result.probes:
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


@styled
def draw_probes(
    axes: Axes, result: Result, probes: Iterable[str] | None = None, quantity: str | None = None, label: str = ""
) -> Axes:
    """Draw one quantity of a result on axes, in addition to their curves and in their units.

    Parameters
    ----------
    axes : Axes
    result : Result
    probes : iterable of str, optional
        Some of the probes.
    quantity : str, optional
        Such as ``"flow"``; the effort if none is given.
    label : str
        For the legend: of one probe, or in front of the names of several.

    Raises
    ------
    InputError
        There is no probe or quantity of that name.
    """
    check_axes(axes, "; a probe is chosen by probes=[…]")
    panel = _asked(result, quantity)[0]
    _draw(axes, panel, _traces(result, probes, [panel], label))
    if len(axes.lines) > 1:
        axes.legend()
    return axes


def _asked(result: Result, quantity: str | None) -> list[Panel]:
    known = [Panel(each, each.named(result.scene), each.shown(result.scene)) for each in in_tables(result.scene)]
    if quantity is None:
        return known
    found = [each for each in known if quantity in (each.word, each.of.key)]
    if not found:
        raise InputError(
            "quantity", "not known", nearest(str(quantity), [each.word for each in known]), shown(quantity)
        )
    return found


def _traces(
    result: Result, probes: Iterable[str] | None, panels: list[Panel], label: str, t: ArrayLike | None = None
) -> list[Trace]:
    check_kind("probes", probes, str, Iterable, type(None))
    names = [*result.probes] if probes is None else [probes] if isinstance(probes, str) else [*probes]
    for name in names or [""]:
        if not isinstance(name, str) or name not in result.probes:
            raise InputError("probes", "no such probe", nearest(str(name), [*result.probes]), shown(name))
    found = []
    for name in names:
        probe = result.probes[name]
        seen = curve(probe) if t is None else probe.at(t)
        values = {panel.of.key: panel.of.of(seen) for panel in panels if panel.of.seen_by(probe)}
        told = name if not label else label if len(names) == 1 else f"{label}, {name}"
        found.append(Trace(told, name, seen.t, values))
    return found


def _draw(axes: Axes, panel: Panel, traces: list[Trace]) -> dict[str, Line2D]:
    """Draw the curves of one quantity, in the units of the axes if these have any."""
    numbered = [(k, trace) for k, trace in enumerate(traces, len(axes.lines)) if panel.of.key in trace.values]
    traces, there = [trace for _, trace in numbered], (axes.get_xlabel(), axes.get_ylabel())
    second, time_unit = _unit(there[0]) or handy(max((trace.t[-1] for trace in traces), default=1.0), "s")
    largest = max((float(abs(trace.values[panel.of.key]).max()) for trace in traces), default=1.0)
    size, unit = _unit(there[1]) or handy(largest, panel.shown)
    drawn = {}
    for k, trace in numbered:
        style = {"color": COLOURS[k % len(COLOURS)], "linestyle": DASHES[k % len(DASHES)]}
        values = trace.values[panel.of.key] / size
        (drawn[trace.name],) = axes.plot(trace.t / second, values, label=f" {trace.name}", **style)
    where = {trace.where for trace in traces}
    axes.set_ylabel(there[1] or f"{panel.word}{f' at {where.pop()}' if len(where) == 1 else ''} [{unit}]")
    axes.set_xlabel(there[0] or f"time [{time_unit}]")
    axes.grid(True)
    axes.margins(x=0)
    if axes.lines:
        values = [np.asarray(line.get_ydata(), float) for line in axes.lines]
        low, high = spread(min(each.min() for each in values), max(each.max() for each in values))
        axes.set_ylim(low - MARGIN * (high - low), high + MARGIN * (high - low))
    return drawn


def _unit(label: str) -> tuple[float, str] | None:
    """Size and name of the unit of an axis; None if it has none."""
    found = UNIT.search(label)
    return (to_si(f"1 {found[1]}", None), found[1]) if found else None
