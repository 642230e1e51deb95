"""`tline tdr`: time-domain reflectometry at a node of a scene."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from tline.cli.from_signature import Output, command, drawn, picture, table

if TYPE_CHECKING:
    from tline.signal.tdr import Reflections

EXAMPLES = """\b
Examples:
  tline tdr cable.toml --port near --rise "50 ps" --plot tdr.png
  tline tdr cable.toml --port near --rise "50 ps" --z0 50 --csv tdr.csv
"""
FILES = {
    "csv": table("Time, incident and reflected wave per step, impedance"),
    "plot": picture("Waves and impedance over time"),
}


@command("tline.signal.tdr:reflectometry", names={"node": "port", "t_end": "to"}, files=FILES, epilog=EXAMPLES)
def tdr(scene: str, *, confined: bool = False, **given: Any) -> Output:
    """Send a step into a node of a scene, and show what comes back.

    The impedance is z0 (1 + ρ)/(1 - ρ) of the reflected wave ρ, as if each reflection had come back on its first way:
    exact up to the first discontinuity, misled by multiple reflections behind it. Other sources are silent.
    """
    from tline.interchange.any_file import read as read_any
    from tline.scene.medium import MEDIA
    from tline.signal.tdr import reflectometry, save_reflections

    read = read_any(scene, confined=confined)
    with tdr.named():
        seen = reflectometry(read, **given, progress=True)
    medium = MEDIA[read.medium]
    files = {
        "csv": lambda file: save_reflections(seen, file),
        "plot": drawn("tline.pictures.signals:plot_reflections", seen, medium, read.title),
    }
    return Output(_text(given["node"], seen, medium.units["resistance"]), lambda: _data(seen), files)


def _impedances(seen: "Reflections") -> list[float | None]:
    return [each if each < float("inf") else None for each in seen.impedance.tolist()]


def _text(port: str, seen: "Reflections", unit: str) -> Iterator[str]:
    yield f"step into '{port}' from {seen.z0:.6g} {unit}, reflected wave per step:"
    z = _impedances(seen)
    for word, k in (("lowest", seen.reflected.argmin()), ("highest", seen.reflected.argmax())):
        size = "open" if z[k] is None else f"{z[k]:.6g} {unit}"
        yield f"  {word} {seen.reflected[k]:.6g} at {seen.t[k]:.6g} s: {size}"


def _data(seen: "Reflections") -> dict[str, Any]:
    waves = {"incident": seen.incident.tolist(), "reflected": seen.reflected.tolist()}
    return {"z0": seen.z0, "t": seen.t.tolist(), **waves, "impedance": _impedances(seen)}
