"""Command `tline frequency`: a scene over frequency."""

from typing import TYPE_CHECKING

from tline.cli.from_signature import FileKind, command, picture, table
from tline.errors import InputError

if TYPE_CHECKING:
    from tline.presentation import Presentation
    from tline.scene.scene import Scene

EXAMPLES = """\b
Examples:
  tline frequency cable.toml --from "1 MHz" --to "1 GHz" --plot bode.png --csv response.csv
  tline frequency cable.toml --ports near --z0 50 --save port.s1p
  tline frequency scenes/skin_pair.toml --ports driver,near,receiver,far --mixed --z0 50 --save modes.csv
  tline frequency network.toml --source pump --to "20 Hz" --points 2001
"""
FILES = {
    "csv": table("Table of the transfer functions, real and imaginary parts"),
    "save": FileKind((), "S-parameters as Touchstone (.s1p, .s2p, …), or as .csv"),
    "plot": picture("Bode plot"),
}


@command(names={"low": "from", "high": "to"}, files=FILES, epilog=EXAMPLES)
def frequency(
    scene: "Scene",
    *,
    source: str | None = None,
    ports: str | None = None,
    mixed: bool = False,
    z0: str | None = None,
    low: str | None = None,
    high: str | None = None,
    points: int = 1001,
    files: dict[str, str],
) -> "Presentation":
    """Transfer functions, S-parameters and natural oscillations of a scene.

    SCENE is a TOML file as for `tline run`. Waveforms are ignored: the answer is the response of each probe per unit of
    the source. Natural oscillations are located as zeros of the scene's characteristic function, not read off a curve;
    those that decay by more than exp(-3) within the shortest delay are left out. Growing ones are listed even below the
    lowest frequency.

    Parameters
    ----------
    source : NAME
        Source of the responses; the others are silent.
    ports : NODE,NODE
        S-parameters between these nodes instead, sources there taken away.
    mixed
        Differential and common modes of the ports instead, which come in pairs.
    z0 : OHM
        Reference resistance of the ports; that of the first line there if not given.
    low : FREQUENCY
        Lowest frequency, such as '1 MHz'.
    high : FREQUENCY
        Highest frequency.
    points : NUMBER
        Number of frequencies.
    as_json
        Print all numbers.
    """
    import numpy as np

    from tline.frequency.ports import scattering_parameters
    from tline.frequency.response import Curves, frequencies, respond

    given = {"save": files.get("save"), "z0": z0, "mixed": mixed}
    for option, instead in (("save", ", or --csv"), ("z0", ""), ("mixed", "")):
        if given[option] and not ports:
            raise InputError(f"--{option}", "is about S-parameters", f"--ports beside it{instead}")
    if source and ports:
        raise InputError("--source", "between ports no source counts", "either --source or --ports")
    if "csv" in files and ports:
        raise InputError("--csv", "is about a source", "--save for S-parameters, or no --ports")
    s = 2j * np.pi * frequencies(scene, low, high, points)
    if ports:
        found = scattering_parameters(scene, ports, s, z0)
        return found.mixed() if mixed else found
    if scene.sources or source or "csv" in files or "plot" in files:
        return respond(scene, s, source)
    return Curves(scene, s, {}, "", "")
