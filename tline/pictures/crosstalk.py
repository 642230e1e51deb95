"""Crosstalk: the driven conductor above, the quiet ones below, and the modes of a pair."""

from matplotlib.figure import Figure

from tline.pictures.handy import handy
from tline.pictures.style import COLOURS, DASHES, figure, styled
from tline.signal.crosstalk import Crosstalk


@styled
def plot_crosstalk(seen: Crosstalk, title: str = "") -> Figure:
    """Voltages of the driven conductor and of the quiet ones, and differential and common mode of pairs, over time.

    Parameters
    ----------
    seen : Crosstalk
    title : str

    Returns
    -------
    matplotlib.figure.Figure
        With three axes that share time; of more than two conductors without the modes.
    """
    second, unit = handy(float(seen.t[-1]), "s")
    quiet = {**seen.near, **seen.far}
    modes = seen.pairs if len(seen.pairs) == 2 else ()
    picture = figure(8.0, 7.0 if modes else 5.0, title)
    axes = picture.subplots(3 if modes else 2, 1, sharex=True)
    _draw(axes[0], seen, second, {node: u for node, u in seen.voltages.items() if node not in quiet})
    largest = max(float(abs(seen.voltages[node]).max()) for node in quiet)
    size, prefix = handy(largest, "V")
    shares = {f"{node}, {100 * share:.3g} %": seen.voltages[node] / size for node, share in quiet.items()}
    _draw(axes[1], seen, second, shares)
    axes[0].set_ylabel("driven [V]")
    axes[1].set_ylabel(f"quiet [{prefix}]")
    if modes:
        waves = {f"{a} − {b}": u for (a, b), u in seen.differential.items()}
        _draw(axes[2], seen, second, waves | {f"mean of {a}, {b}": u for (a, b), u in seen.common.items()})
        axes[2].set_ylabel("modes [V]")
    axes[-1].set_xlabel(f"time [{unit}]")
    picture.align_ylabels(list(axes))
    return picture


def _draw(axes, seen: Crosstalk, second: float, waves: dict) -> None:
    for k, (name, u) in enumerate(waves.items()):
        axes.plot(seen.t / second, u, color=COLOURS[k % len(COLOURS)], linestyle=DASHES[k % len(DASHES)], label=name)
    axes.legend(loc="best", fontsize="small", ncols=2)
    axes.grid(True)
    axes.margins(x=0)
