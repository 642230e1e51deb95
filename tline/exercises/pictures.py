"""Figures of the letters, each on axes of its own or on given ones."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drives.picture import draw_bode as draw_bode
from drives.picture import draw_run as draw_run
from friction.pictures import draw_panels as draw_panels
from passivity.exact.picture import draw_smith
from tline.exercises.lines import LENGTH, snapshots
from tline.exercises.passive_line import example
from tline.pictures.style import COLOURS, DASHES, FAINT, UP, cells_of, styled
from tline.units import handy


@styled
def draw_snapshots(medium: str, ax: Axes | None = None) -> Figure | Axes:
    """Waves a and b and the effort along 3 km of line at three instants, or at the first of them."""
    x, times, waves = snapshots(medium)
    second, unit = handy(times[-1], "s")
    drawn, cells = cells_of(ax, 11.0, 3.4, columns=len(times), sharey=True)
    for axes, t, (a, b) in zip(cells, times, waves, strict=False):
        curves = (a, "a, toward the far end"), (b, "b, back"), ((a + b) / 2, "u = (a + b)/2")
        for n, (values, label) in enumerate(curves):
            axes.plot(x / 1e3, values, color=COLOURS[n], linestyle=DASHES[n], label=label)
        axes.set_title(f"t = {t / second:.3g} {unit}", loc="left")
        axes.set(xlabel="x [km]", xlim=(0, LENGTH / 1e3))
        axes.grid(True)
    cells[0].set_ylabel("effort over that sent")
    if isinstance(drawn, Figure):
        drawn.legend(*cells[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    else:
        drawn.legend()
    return drawn


@styled
def draw_curves(names: tuple[str, ...], ax: Axes | None = None) -> Figure | Axes:
    """Nyquist curves of G, and reflections H in a Smith chart, or the first of them."""
    title = "25 Ω, then 100 Ω beside 4 pF, at the end of 50 Ω, 0.1 ns"
    drawn, cells = cells_of(ax, 9.6, 4.8, columns=len(names), title=title)
    for axes, name in zip(cells, names, strict=False):
        z = getattr(example(), name.lower())
        if name.startswith("H"):
            draw_smith(axes, z)
        else:
            axes.axvspan(-0.4, 0, color=UP, alpha=0.12, linewidth=0, label="Re < 0: not passive")
            axes.plot(z.real, z.imag, color=COLOURS[0], label=f"{name}(jω), ω > 0")
            axes.axhline(0, color=FAINT, linewidth=0.8)
            axes.set(xlim=(-0.4, 1.06 * z.real.max()), aspect="equal", adjustable="datalim")
            axes.legend(loc="upper right", fontsize=8)
            axes.grid(True)
        axes.set(xlabel=f"Re {name}", ylabel=f"Im {name}")
        axes.set_title(f"{name}(jω)", loc="left")
    return drawn
