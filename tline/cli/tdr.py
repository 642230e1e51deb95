"""`tline tdr`: time-domain reflectometry at a node of a scene."""

from typing import Any

from tline.cli.from_signature import Output, command, drawn, picture, table

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
    from tline.signal.tdr import reflectometry, save_reflections

    read = read_any(scene, confined=confined)
    with tdr.named():
        seen = reflectometry(read, **given, progress=True)
    files = {"csv": lambda file: save_reflections(seen, file), "plot": drawn(seen.picture, seen)}
    return Output(seen.text_lines(), seen.to_dict, files)
