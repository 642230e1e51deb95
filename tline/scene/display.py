"""Display of a scene: in a few lines of text, and as a drawing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tline.units import engineering

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tline.scene.scene import Scene

WIDTH = 100  # characters of a line of text
SECTIONS = "lines", "sources", "loads", "links", "probes", "measures"


def as_text(scene: Scene) -> str:
    """Summarise a scene in at most six lines: medium, end time, and names of its elements."""
    title = f" {scene.title!r}" if scene.title else ""
    head = f"<Scene{title}: {scene.medium}, {engineering(float(scene.t_end), 's')}"
    rows = [f"  {section:9}{_names([*getattr(scene, section)])}" for section in SECTIONS if getattr(scene, section)]
    return "\n".join([head, *rows]) + ">"


def as_html(scene: Scene) -> str:
    """Return the summary as HTML below a drawing, which is left out if the scene has too many nodes."""
    from base64 import b64encode
    from html import escape

    from tline.errors import InputError

    text = f"<pre>{escape(as_text(scene))}</pre>"
    try:
        picture = b64encode(drawn(scene)._repr_png_()[0]).decode()  # pyright: ignore[reportAttributeAccessIssue]
    except InputError:
        return text
    return f'<img alt="network" style="max-width: 100%" width="800" src="data:image/png;base64,{picture}">{text}'


def drawn(scene: Scene) -> Figure:
    """Draw the network of a scene; imported here, as scenes do not depend on pictures."""
    import tline as tl

    return tl.pictures.plot_network(scene)


def _names(names: list[str]) -> str:
    """Join names as far as they fit in a line, and the number of those left out."""
    room = WIDTH - 30
    kept: list[str] = []
    for name in names:
        if kept and len(", ".join([*kept, name])) > room:
            break
        kept.append(name)
    text = ", ".join(kept)
    text = text if len(text) <= room else text[: room - 1] + "…"
    return text + (f" and {len(names) - len(kept):,} more" if len(kept) < len(names) else "")
