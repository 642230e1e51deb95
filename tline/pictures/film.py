"""Animation as GIF or MP4: the background is drawn once, curve and clock over it for each frame."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

from tline.errors import import_extra
from tline.pictures.animation import MovingQuantities
from tline.pictures.profile import draw_bounds
from tline.style import COLOURS, DASHES, figure, name_nodes, styled

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
