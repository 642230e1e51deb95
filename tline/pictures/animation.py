"""Animation of waves and effort along a route: as a web page, or as a film."""

import json
from collections.abc import Iterator
from html import escape
from importlib.resources import files
from math import ceil, log10
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from numpy.typing import NDArray
from PIL import Image

from tline.atomic import replacing
from tline.errors import InputError, import_extra
from tline.pictures.bounds import Bound, bounds, scale, spread
from tline.pictures.path import Route, axis, extremes_along, waves_along
from tline.pictures.profile import draw_bounds
from tline.solver.result.result import Result
from tline.style import COLOURS, DASHES, figure, name_nodes, styled
from tline.units import handy

FRAMES, PLACES = 180, 361
FRAME = 480  # pixels, height in a notebook
SUFFIXES, PAGE = (".html", ".gif", ".mp4"), ("player.html", "waves.js")
STEPS = 9999  # levels from smallest to largest effort in the page
NOTE = (
    "a travels to the right, b to the left; the effort u is half of their sum. Shaded: what u passes through in the "
    "whole run."
)


class MovingQuantities(NamedTuple):
    """Animated quantities, in handy units."""

    title: str
    waves: NDArray  # (2, instants, places): half of the wave along the route, and of that against it; their sum is u
    lowest: NDArray
    highest: NDArray
    t: NDArray
    time_unit: str
    x: NDArray
    labels: dict[float, str]  # names of nodes by place
    bounds: list[Bound]
    place: str  # text below the axis
    effort: str  # and beside it

    @property
    def frames(self) -> NDArray:
        """Effort, shape (instants, places)."""
        return self.waves.sum(axis=0)

    @property
    def wave_range(self) -> tuple[float, float]:
        """Axis limits of half a wave."""
        return spread(float(self.waves.min()), float(self.waves.max()))

    @property
    def range(self) -> tuple[float, float]:
        """Axis limits of the effort, with its extremes and bounds."""
        shown = np.concatenate([self.lowest, self.highest, *(bound.effort for bound in self.bounds)])
        return spread(np.nanmin(shown), np.nanmax(shown))

    @property
    def decimals(self) -> int:
        """Number of decimals of the clock at which all frames differ."""
        return max(ceil(-log10(self.t[1])), 0) + 1


class Animation:
    """Waves along a route and against it, and the effort, half of their sum, moving in time; notebooks play it.

    Parameters
    ----------
    motion : MovingQuantities
        What moves.
    """

    def __init__(self, motion: MovingQuantities):
        self.motion = motion
        self.html = _page(motion)

    def _repr_html_(self) -> str:
        return f'<iframe srcdoc="{escape(self.html)}" width="100%" height="{FRAME}" style="border: 0"></iframe>'

    def save(self, filename: str | Path) -> None:
        """Write the animation to a file.

        Parameters
        ----------
        filename : str or Path
            ``.html`` for a page that needs nothing else, with play, pause and a slider; ``.gif`` for a picture that
            plays for ever; ``.mp4`` for a film.

        Raises
        ------
        InputError
            Another suffix, or the file cannot be written.
        MissingExtraError
            A film is asked for, and ffmpeg is not installed.
        """
        suffix = Path(filename).suffix.lower()
        if suffix not in SUFFIXES:
            raise InputError(str(filename), "unknown kind of animation", " or ".join(SUFFIXES), f"'{suffix}'")
        with replacing(filename) as temporary:
            if suffix == ".html":
                temporary.write_text(self.html, encoding="utf-8")
            else:
                (write_gif if suffix == ".gif" else write_mp4)(self.motion, temporary)


def animated(result: Result, path: Route) -> Animation:
    """Animate waves and effort along a route.

    Parameters
    ----------
    result : Result
        A finished run in which the route's lines were recorded.
    path : Route
        From `route(scene)`.

    Raises
    ------
    InputError
        A line of the route was not recorded.
    """
    return Animation(_motion(result, path))


def _motion(result: Result, path: Route) -> MovingQuantities:
    t_end = float(result.t[-1])
    t, x = np.linspace(0.0, t_end, FRAMES), np.linspace(0.0, path.marks[-1], PLACES)
    waves, seen = waves_along(result, path, x, t) / 2, extremes_along(result, path)
    effort = waves.sum(axis=0)
    lowest = np.minimum(np.interp(x, seen.x, seen.lowest), effort.min(0))
    highest = np.maximum(np.interp(x, seen.x, seen.highest), effort.max(0))
    limits = bounds(result.scene, path, x, lowest)
    word, size, unit = scale(result.scene, path.lines, max(-lowest.min(), highest.max()))
    second, time_unit = handy(t_end, "s")
    metre, place = axis(path, result.scene)
    return MovingQuantities(
        result.scene.title,
        waves / size,
        lowest / size,
        highest / size,
        t / second,
        time_unit,
        x / metre,
        {mark / metre: name for mark, name in path.labels.items()},
        [bound.in_units(metre, size) for bound in limits],
        place,
        f"{word} [{unit}]",
    )


def _points(bound: Bound) -> list:
    """Places and efforts; null where the height is not known."""
    return [(x, None if np.isnan(u) else u) for x, u in zip(bound.x.tolist(), bound.effort.tolist(), strict=True)]


def _page(motion: MovingQuantities) -> str:
    """Compose the page, with the efforts as whole numbers from 0 to STEPS."""
    low, high = motion.range

    def counts(values: NDArray, low: float = low, high: float = high) -> list:
        return np.rint((values - low) / (high - low) * STEPS).astype(int).tolist()

    data = {
        "title": motion.title or motion.effort,
        "note": NOTE,
        "keys": ", u, a and b show or hide a curve",
        "range": [low, high],
        "steps": STEPS,
        "marks": list(motion.labels.items()),
        "bounds": [[bound.kind, bound.name, _points(bound)] for bound in motion.bounds],
        "place": motion.place,
        "effort": motion.effort,
        "step": float(motion.t[1]),
        "decimals": motion.decimals,
        "time": motion.time_unit,
        "lowest": counts(motion.lowest),
        "highest": counts(motion.highest),
        "frames": counts(motion.frames),
        "wave_range": motion.wave_range,
        "along": counts(motion.waves[0], *motion.wave_range),
    }
    text = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    template, script = (files("tline.pictures").joinpath(name).read_text(encoding="utf-8") for name in PAGE)
    before, middle, after = (part for end in template.split("DATA", 1) for part in end.split("SCRIPT\n"))
    return before.replace("TITLE", escape(data["title"])) + text + middle + script + after  # texts of users come last


FRAMES_PER_SECOND = 20
PALETTE = 64  # colours
LABELS = ("u = a/2 + b/2", "a/2, to the right", "b/2, to the left")


@styled
def write_mp4(motion: MovingQuantities, path: Path) -> None:
    """Write an MP4 film."""
    ffmpeg = import_extra("imageio_ffmpeg", "ffmpeg", "video", ".mp4")
    frames = list(_frames(motion))
    film = ffmpeg.write_frames(str(path), frames[0].size, fps=FRAMES_PER_SECOND, macro_block_size=2)
    film.send(None)
    for frame in frames:
        film.send(frame.tobytes())
    film.close()


@styled
def write_gif(motion: MovingQuantities, path: Path) -> None:
    """Write all frames as a GIF that loops for ever."""
    frames = list(_frames(motion))
    palette = frames[-1].quantize(PALETTE, method=Image.Quantize.MAXCOVERAGE)
    first, *rest = (frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames)
    first.save(path, format="GIF", save_all=True, append_images=rest, duration=1000 // FRAMES_PER_SECOND, loop=0)


def _frames(motion: MovingQuantities) -> Iterator[Image.Image]:
    picture = figure(8.0, 4.2, motion.title)
    picture.set_dpi(100)
    canvas = FigureCanvasAgg(picture)
    axes = picture.subplots()
    axes.fill_between(motion.x, motion.lowest, motion.highest, color=COLOURS[0], alpha=0.13, linewidth=0)
    ranges = [motion.range] if motion.bounds else [motion.range, motion.wave_range]
    low, high = min(each[0] for each in ranges), max(each[1] for each in ranges)
    pad = 0.06 * (high - low)
    axes.set(xlim=(0.0, motion.x[-1]), ylim=(low - pad, high + pad), xlabel=motion.place, ylabel=motion.effort)
    axes.grid(True, axis="y")
    name_nodes(axes, motion.labels)
    draw_bounds(axes, motion.bounds)
    if motion.bounds:
        picture.legend(loc="outside lower left", ncols=len(motion.bounds), fontsize=9)
    effort = motion.frames
    moving = (effort,) if motion.bounds else (effort, *motion.waves)  # beside limits and ground the effort counts
    curves = [
        axes.plot(
            motion.x, values[0], color=COLOURS[k], linestyle=DASHES[k], linewidth=wide, animated=True, label=label
        )[0]
        for k, (values, wide, label) in enumerate(zip(moving, (2.2, 1.4, 1.4), LABELS, strict=False))
    ]
    if not motion.bounds:
        picture.legend(handles=curves, loc="outside lower left", ncols=3, fontsize=9)
    clock = picture.text(0.985, 0.02, "", ha="right", va="bottom", animated=True)
    canvas.draw()
    still = canvas.copy_from_bbox(picture.bbox)
    for t, *values in zip(motion.t, *moving, strict=True):
        canvas.restore_region(still)
        clock.set_text(f"t = {t:.{motion.decimals}f} {motion.time_unit}")
        for curve, each in zip(curves, values, strict=True):
            curve.set_ydata(each)
            axes.draw_artist(curve)
        picture.draw_artist(clock)
        yield Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3].copy())
