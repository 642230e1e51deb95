"""Presentation of results: a screen of text, and the pictures of `tline.pictures`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast, overload

from tline.presentation import Presentation, plain
from tline.units import engineering

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    import tline as tl
    from tline.solver.result.result import Result

SHOWN = 20  # probes


class Display(Presentation):
    """Text and plots of a result; each method imports its plotting module."""

    @property
    def _result(self) -> Result:
        return cast("Result", self)

    def text_lines(self) -> Iterator[str]:
        """Scene, order and slabs, error estimate, and extremes of each probe."""
        yield from as_text(self._result).splitlines()

    def to_dict(self) -> dict[str, Any]:
        """Order, slabs, extremes and last value of each probe, measures and notes, in SI; see ``tline run --json``."""
        from tline.solver.result.dense_output import extremes
        from tline.solver.result.quantities import in_tables

        result, probes = self._result, dict[str, Any]()
        for name, probe in result.probes.items():
            for each in in_tables(result.scene):
                if each.seen_by(probe):
                    (low, low_at), (high, high_at) = extremes(probe, each.key)
                    probes.setdefault(name, {})[each.named(result.scene)] = {
                        "unit": each.si(result.scene),
                        "minimum": low,
                        "minimum_time": low_at,
                        "maximum": high,
                        "maximum_time": high_at,
                        "end": float(each.of(probe.samples)[-1]),
                    }
        told = {
            "title": result.scene.title,
            "medium": result.medium.name,
            "end_time": float(result.t[-1]),
            "order": result.resolution.s,
            "slab": result.resolution.h,
            "slabs": result.slabs.number,
            "probes": probes,
            "measures": {name: {"unit": unit, "value": value} for name, (value, unit) in result.measures.items()},
            "notes": result.notes,
        }
        return plain(told)

    @overload
    def plot(self, *, probes: Iterable[str] | None = None, quantity: str | None = None) -> Figure: ...
    @overload
    def plot(
        self, ax: Axes, *, probes: Iterable[str] | None = None, quantity: str | None = None, label: str = ""
    ) -> Axes: ...
    def plot(
        self,
        ax: Axes | None = None,
        *,
        probes: Iterable[str] | None = None,
        quantity: str | None = None,
        label: str = "",
    ) -> Figure | Axes:
        """Draw the signals of the probes over time.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Axes for one quantity, which keep their content; without it a new figure with all quantities.
        probes : iterable of str, optional
            Some of the probes.
        quantity : str, optional
            Such as ``"flow"`` or ``"voltage"``; on `ax` the effort if none is given.
        label : str
            For the legend of `ax`, instead of the probe's name or in front of it.

        Returns
        -------
        Figure or Axes
            The figure or axes drawn on. Several results in one figure: `tline.plot`.

        Raises
        ------
        InputError
            There is no such probe or quantity.
        """
        import tline as tl

        if ax is None:
            return tl.pictures.plot(self._result, probes, quantity)
        return tl.pictures.draw_probes(ax, self._result, probes, quantity, label)

    def plot_waves(self, probe: str | None = None, *, line: str | None = None) -> Figure:
        """Draw the waves a = u + z0·y and b = u - z0·y: over time at a probe, or over time and place on a line.

        Parameters
        ----------
        probe : str, optional
            Not needed if there is one only.
        line : str
            Instead of a probe, a line that was recorded: each that has a probe, and those of ``record=[…]``.
        """
        import tline as tl

        pictures, result = tl.pictures, self._result
        return pictures.plot_line_waves(result, line) if line else pictures.plot_waves(result, probe)

    def plot_space_time(self, *nodes: str) -> Figure:
        """Draw the effort over time and place, along a chain of lines or from node to node; see `record` of a run."""
        import tline as tl

        return tl.pictures.plot_space_time(self._result, tl.pictures.route(self._result.scene, *nodes))

    def plot_profile(self, *nodes: str) -> Figure:
        """Draw the lowest and the highest effort along a path, with ground and limits; see `record` of a run."""
        import tline as tl

        return tl.pictures.plot_profile(self._result, tl.pictures.route(self._result.scene, *nodes))

    def plot_map(self) -> Figure:
        """Draw maps of the network, coloured by how far the effort rose and fell: of a run with ``envelope=True``."""
        import tline as tl

        return tl.pictures.plot_map(self._result)

    def plot_lattice(self) -> Figure:
        """Draw the bounce diagram of a scene with one line."""
        import tline as tl

        return tl.pictures.plot_lattice(self._result)

    def animate(self, *nodes: str) -> tl.pictures.Animation:
        """Animate the waves along a path, a to the right and b to the left, and the effort.

        Notebooks play it; its method ``save`` writes it as a page that needs nothing else, or as a GIF.

        Parameters
        ----------
        *nodes : str
            First and last node of the path, and any to be passed; none where all lines form a chain.
        """
        import tline as tl

        return tl.pictures.animated(self._result, tl.pictures.route(self._result.scene, *nodes))


def as_text(result: Result) -> str:
    """Scene, order and slabs, error estimate, and extremes of each probe."""
    from tline.solver.result.dense_output import extremes
    from tline.solver.result.quantities import in_tables

    found, title = result.accuracy, result.scene.title
    name, end = f" {title!r}" if title else "", engineering(float(result.t[-1]), "s")
    lines = [f"<Result{name}: {end} in {result.slabs.number:,} slabs, order {result.resolution.s}"]
    if found and found.tol is not None:
        lines.append(f"  error {found.worst:.1g}, {found.tol:.1g} asked and {'met' if found.met else 'NOT met'}")
    width = max(map(len, result.probes), default=0)
    for name in [*result.probes][:SHOWN]:
        probe, parts = result.probes[name], []
        for each in in_tables(result.scene):
            if each.seen_by(probe):
                (low, _), (high, _) = extremes(probe, each.key)
                parts.append(" … ".join(with_unit(x, each.shown(result.scene)) for x in (low, high)))
        lines.append(f"  {name:{width}}  {',  '.join(parts)}")
    more = len(result.probes) - SHOWN
    return "\n".join([*lines, *([f"  and {more} more probes"] if more > 0 else [])]) + ">"


def with_unit(value: float, unit: str) -> str:
    """Format a value with an engineering prefix; heights stay in metres."""
    return f"{value:.4g} m" if unit == "m" else engineering(value, unit)


def shortly(kind: str, **parts: Any) -> str:
    """Return a one-line representation of an object with long arrays."""
    return f"<{kind}: {', '.join(f'{key} {value}' for key, value in parts.items())}>"
