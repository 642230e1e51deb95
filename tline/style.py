"""Common style of all pictures: colours that everyone can distinguish, sizes, and files of figures."""

import textwrap
from collections.abc import Iterable, Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib
import matplotlib.rcsetup
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colorbar import Colorbar
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.transforms import BboxBase

from tline.atomic import replacing
from tline.errors import InputError
from tline.words.wording import shown

# Okabe and Ito's colours, distinct with every kind of colour vision; yellow is left out as too faint on white
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
DASHES: tuple[Any, ...] = ("-", (0, (5, 1.6)), (0, (1.6, 1.2)), (0, (6, 1.4, 1.4, 1.4)))
UP, DOWN, INK, FAINT = "#B2182B", "#2166AC", "#222222", "#8A8A8A"
DIVERGING = (DOWN, "#67A9CF", "#F7F7F7", "#EF8A62", UP)
POINTS = 96  # per inch of a notebook's page
HALO = [withStroke(linewidth=2.5, foreground="white")]
LONGEST_NAME, ONE_ROW = 18, 80  # letters of a node's name, and of all names beside each other
LOOK: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 10,
    "text.parse_math": False,  # names may hold a dollar sign
    "text.color": INK,
    "axes.titlesize": 11,
    "axes.labelcolor": INK,
    "axes.edgecolor": FAINT,
    "axes.linewidth": 0.8,
    "axes.prop_cycle": matplotlib.rcsetup.cycler(color=COLOURS),
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5),
    "xtick.color": FAINT,
    "ytick.color": FAINT,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "grid.color": "#E4E4E4",
    "grid.linewidth": 0.8,
    "lines.linewidth": 1.7,
    "lines.solid_joinstyle": "miter",
    "legend.frameon": False,
    "svg.hashsalt": "tline",
}


# decorates drawing functions, so that they use this style in place of the user's settings, which are restored
styled = matplotlib.rc_context(LOOK)


class Picture(Figure):
    """Figure independent of window systems, which notebooks show on their own."""

    @styled
    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        """Figure in a notebook: sharp on screens with twice the resolution."""
        file = BytesIO()
        self.savefig(file, format="png")
        width, height = self.get_size_inches() * POINTS
        return file.getvalue(), {"width": round(width), "height": round(height)}


def figure(width: float, height: float, title: str) -> Picture:
    """Create an empty figure, inches."""
    blank = Picture(figsize=(width, height), dpi=150, layout="constrained")
    if title:
        text = textwrap.fill(title, int(9 * width))
        blank.suptitle(text, x=0.02, ha="left", fontsize=12, fontweight="bold")
    return blank


def check_axes(ax: object, hint: str = "") -> None:
    """Raise an error unless the argument is a Matplotlib axes."""
    if not isinstance(ax, Axes):
        raise InputError("ax", "not matplotlib axes", "Axes" + hint, shown(ax))


def cells_of(
    ax: Axes | None, width: float, height: float, rows: int = 1, columns: int = 1, title: str = "", **shared: Any
) -> tuple[Any, list[Axes]]:
    """Return the target of `plot(ax)` and its axes: `ax` alone, or those of a new figure, inches.

    Examples
    --------
    >>> drawn, cells = cells_of(None, 8.0, 4.0, rows=2, sharex=True)
    >>> type(drawn).__name__, len(cells), cells_of(cells[0], 8.0, 4.0)[0] is cells[0]
    ('Picture', 2, True)
    """
    if ax is not None:
        check_axes(ax)
        return ax, [ax]
    blank = figure(width, height, title)
    return blank, [*blank.subplots(rows, columns, squeeze=False, **shared).ravel()]


def add_bar(colours: ScalarMappable, axes: Any, label: str, fraction: float = 0.06) -> Colorbar:
    """Add a colour bar next to axes."""
    beside = [axes] if isinstance(axes, Axes) else [*axes]
    bar = beside[0].figure.colorbar(colours, ax=beside, label=label, pad=0.02, fraction=fraction)
    bar.outline.set_visible(False)
    return bar


def short(name: str) -> str:
    """Shorten a long name."""
    return name if len(name) <= LONGEST_NAME else name[: LONGEST_NAME - 1] + "…"


def write_name(
    axes: Axes, name: str, place: tuple[float, float], sides: Iterable[tuple[float, float]], taken: list[BboxBase]
) -> None:
    """Write a name next to a place, at the first side, points, where it covers no taken box; else nowhere."""
    for x, y in sides:
        across, up = "center" if not x else "left" if x > 0 else "right", "bottom" if y > 0 else "top"
        text = axes.annotate(name, place, (x, y), textcoords="offset points", ha=across, va=up, fontsize=9,
                             linespacing=1.3, path_effects=HALO, zorder=9)  # fmt: skip
        box = text.get_window_extent()
        if not any(box.overlaps(other) for other in taken):
            taken.append(box)
            return
        text.remove()


def name_nodes(axes: Axes, labels: Mapping[float, str]) -> None:
    """Write the nodes of a route above the axes, as many as there is space for, and mark the inner ones."""
    marks, names = list(labels), list(labels.values())
    room = 0.06 * (marks[-1] - marks[0])
    kept = [0]
    for k in range(1, len(marks) - 1):
        if marks[k] - marks[kept[-1]] > room and marks[-1] - marks[k] > room:
            kept.append(k)
    kept.append(len(marks) - 1)
    top = axes.secondary_xaxis("top")
    texts = [*map(short, names)]
    top.set_xticks([marks[k] for k in kept], [texts[k] for k in kept])
    top.tick_params(length=3, color=FAINT, labelcolor=INK)
    top.spines["top"].set_visible(False)
    if sum(len(texts[k]) for k in kept) > ONE_ROW:
        for label in top.get_xticklabels():
            label.set(rotation=40, ha="left", rotation_mode="anchor")
    for place in marks[1:-1]:
        axes.axvline(place, color=INK, linewidth=0.7, alpha=0.6)


@styled
def save_figure(picture: Figure, path: str | Path) -> None:
    """Write a figure as PNG, SVG or PDF, by the path's suffix.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    with replacing(path) as temporary:
        undated = {"CreationDate" if temporary.suffix == ".pdf" else "Date": None}
        picture.savefig(temporary, metadata=None if temporary.suffix == ".png" else undated)
