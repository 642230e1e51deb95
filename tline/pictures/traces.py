"""What the probes saw, over time."""

from matplotlib.figure import Figure

from tline.pictures.handy import handy, quantities, spread
from tline.pictures.style import COLOURS, DASHES, figure, styled
from tline.solver.result.dense_output import curve
from tline.solver.result.result import Result

WIDTH, HEIGHT, MORE = 8.0, 5.2, 2.2  # inches; more for a third panel
MARGIN = 0.08  # of the range, above and below
ENTRY = 0.11  # inches per letter in the legend


@styled
def plot_probes(result: Result) -> Figure:
    """Effort above, or gauge pressure and head in a scene with elevations, flow below; one curve for each probe.

    Probes at nodes where no line ends have no flow.

    Parameters
    ----------
    result : Result
        A finished run.

    Returns
    -------
    matplotlib.figure.Figure
        With two axes, or three, that share time.
    """
    curves = {name: curve(probe) for name, probe in result.probes.items()}
    columns = max(int(WIDTH / (0.6 + ENTRY * max(map(len, curves)))), 1)
    rows = -(-len(curves) // columns) if len(curves) > 1 else 0
    picture = figure(WIDTH, HEIGHT + 0.22 * rows + MORE * bool(result.scene.heights), result.scene.title)
    flowing = {name for name, probe in result.probes.items() if probe.has_flow}
    shown = [each for each in quantities(result.scene) if each[1] != "y" or flowing]
    ratios = [2 if letter == "y" else 3 for _, letter, _, _ in shown]
    panels = picture.subplots(len(shown), 1, sharex=True, height_ratios=ratios, squeeze=False)[:, 0]
    second, time_unit = handy(result.t[-1], "s")
    handles = {}
    for axes, (word, letter, _, unit) in zip(panels, shown, strict=True):
        drawn = {
            name: (k, samples.t / second, getattr(samples, letter))
            for k, (name, samples) in enumerate(curves.items())
            if letter != "y" or name in flowing
        }
        values = [v for _, _, v in drawn.values()]
        size, name = handy(max(abs(v).max() for v in values), unit)
        handles |= {
            probe: axes.plot(t, v / size, color=COLOURS[k % len(COLOURS)], linestyle=DASHES[k % len(DASHES)])[0]
            for probe, (k, t, v) in drawn.items()
        }
        where = f" at {next(iter(curves))}" if len(curves) == 1 else ""
        axes.set_ylabel(f"{word}{where} [{name}]")
        axes.grid(True)
        axes.margins(x=0)
        low, high = spread(min(v.min() for v in values) / size, max(v.max() for v in values) / size)
        axes.set_ylim(low - MARGIN * (high - low), high + MARGIN * (high - low))
    panels[-1].set_xlabel(f"time [{time_unit}]")
    picture.align_ylabels(panels)
    if len(curves) > 1:
        names = [f" {name}" for name in curves]  # a name that begins with '_' would be left out
        picture.legend(handles.values(), names, loc="outside lower center", ncols=min(columns, len(names)))
    return picture
