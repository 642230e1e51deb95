"""Refusal of lines, nodes and sources that a caller does not support; `what` names the caller."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from tline.errors import InputError
from tline.scene.cavities import with_cavities
from tline.scene.coupled import Coupled
from tline.words.wording import place

if TYPE_CHECKING:
    from tline.scene.line import SceneLine
    from tline.scene.scene import Scene
    from tline.scene.source import Source


def refuse_losses(scene: Scene, what: str) -> None:
    """Raise an error if a line has losses."""
    for name, line in scene.lines.items():
        if line.losses is not None:
            raise InputError(place("lines", name), f"it has losses: {what}", "lossless lines")


def refuse_cavities(lines: Mapping[str, SceneLine], what: str) -> None:
    """Raise an error if a line has cavities."""
    for name in with_cavities(lines):
        raise InputError(place("lines", name, "cavities"), "is non-linear", f"a line without for {what}")


def refuse_coupled(lines: Mapping[str, SceneLine], what: str) -> None:
    """Raise an error if a line is of coupled conductors."""
    for name, line in lines.items():
        if isinstance(line, Coupled):
            raise InputError(place("lines", name), f"{what} knows no coupled conductors", "single lines")


def refuse_heights(scene: Scene, what: str) -> None:
    """Raise an error if a node has an elevation."""
    for name, site in scene.nodes.items():
        if site.elevation is not None:
            raise InputError(place("nodes", name, "elevation"), "heights are not known here", f"none for {what}")


def refuse_floating(sources: Mapping[str, Source], what: str) -> None:
    """Raise an error if a source is between two nodes."""
    for name, source in sources.items():
        if source.nodes is not None:
            raise InputError(place("sources", name), "stands between two nodes", f"one at a node for {what}")
