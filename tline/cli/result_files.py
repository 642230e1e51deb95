"""Tables and pictures of a result, and the lines to record for them."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from tline.cli.from_signature import FileKind, drawn, picture, table

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from tline.pictures.path import Route
    from tline.scene.scene import Scene
    from tline.solver.result.result import Result

FILES = {
    "csv": table("Table of what the probes saw, SI, full precision"),
    "npz": FileKind((".npz",), "The same as NumPy arrays, with the scene"),
    "envelope": table("Table of the extremes at every node, and when"),
    "states": table("What pumps, vessels, tanks, cavities and valves do over time"),
    "ledger_csv": table("The energy ledger as a table, in full precision"),
    "plot": picture("Probes over time"),
    "profile": picture("Lowest and highest effort along a path, with ground and limits"),
    "map": picture("Map of the network, coloured by how far the effort rose and fell"),
    "space_time": picture("Image of the effort over place and time"),
    "plot_waves": picture("Waves along a path and against it, over place and time"),
    "lattice": picture("Bounce diagram, for a scene with one line"),
    "load_lines": picture("Bergeron's diagram, for one line between resistive ends"),
    "animate": FileKind((".html", ".gif", ".mp4"), "Waves and effort along a path, moving"),
}
ALONG = ("profile", "space_time", "plot_waves", "animate")  # show a path
ENVELOPES = ("envelope", "map")  # show the extremes at nodes


def recorded(scene: "Scene", way: "Route | None", mapped: bool) -> tuple[str, ...]:
    """Lines whose interior appears in pictures."""
    if not mapped:
        return way.lines if way else ()
    from tline.pictures.map import lines_to_map

    return (*(way.lines if way else ()), *lines_to_map(scene))


def writers(
    result: "Result", way: "Route | None" = None, times: "NDArray | None" = None
) -> dict[str, Callable[[str], Any]]:
    """Writers for each kind of file, with tables at some instants, s, or else at slab ends."""
    from tline.solver.result import save

    return {
        "csv": lambda file: save.save_csv(result, file, times),
        "npz": lambda file: save.save_npz(result, file, times),
        "envelope": lambda file: save.save_envelope(result, file),
        "states": lambda file: save.save_states(result, file),
        "ledger_csv": lambda file: save.save_ledger(result, file),
        "plot": drawn("tline.pictures.traces:plot", result, t=times),
        "profile": drawn("tline.pictures.profile:plot_profile", result, way),
        "map": drawn("tline.pictures.map:plot_map", result),
        "space_time": drawn("tline.pictures.profile:plot_space_time", result, way),
        "plot_waves": drawn("tline.pictures.profile:plot_path_waves", result, way),
        "lattice": drawn("tline.pictures.lattice:plot_lattice", result),
        "load_lines": lambda file: _draw_load_lines(result.scene, file),
        "animate": lambda file: _animate(result, way, file),
    }


def _draw_load_lines(scene: "Scene", file: str) -> None:
    from tline.signal.load_line import bergeron

    found = bergeron(scene)
    drawn(found.picture, found)(file)


def _animate(result: "Result", way: "Route | None", file: str) -> None:
    from tline.pictures.animation import animated

    assert way is not None
    animated(result, way).save(file)
