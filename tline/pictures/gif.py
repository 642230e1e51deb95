"""The animation as a GIF: what stands still is drawn once, curve and clock over it for each frame."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

from tline.pictures.animation import MovingQuantities
from tline.pictures.profile import draw_bounds
from tline.pictures.style import COLOURS, figure, name_nodes, styled

FRAMES_PER_SECOND = 20
PALETTE = 64  # colours


@styled
def write_gif(motion: MovingQuantities, path: Path) -> None:
    """Write all frames, to be played for ever."""
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
    low, high = motion.range
    pad = 0.06 * (high - low)
    axes.set(xlim=(0.0, motion.x[-1]), ylim=(low - pad, high + pad), xlabel=motion.place, ylabel=motion.effort)
    axes.grid(True, axis="y")
    name_nodes(axes, motion.labels)
    draw_bounds(axes, motion.bounds)
    if motion.bounds:
        picture.legend(loc="outside lower left", ncols=len(motion.bounds), fontsize=9)
    (line,) = axes.plot(motion.x, motion.frames[0], color=COLOURS[0], linewidth=2.2, animated=True)
    clock = picture.text(0.985, 0.02, "", ha="right", va="bottom", animated=True)
    canvas.draw()
    still = canvas.copy_from_bbox(picture.bbox)
    for t, effort in zip(motion.t, motion.frames, strict=True):
        canvas.restore_region(still)
        line.set_ydata(effort)
        clock.set_text(f"t = {t:.{motion.decimals}f} {motion.time_unit}")
        axes.draw_artist(line)
        picture.draw_artist(clock)
        yield Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3].copy())
