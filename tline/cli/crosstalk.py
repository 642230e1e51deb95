"""`tline crosstalk`: what a driven conductor sends into those beside it."""

from typing import Any

from tline.cli.from_signature import Output, command, drawn, picture, table

EXAMPLES = """\b
Examples:
  tline crosstalk scenes/skin_pair.toml --plot crosstalk.png
  tline crosstalk scenes/coupled_pair.toml --csv crosstalk.csv --json
"""
FILES = {
    "csv": table("Voltages of all conductors, differences and means of pairs"),
    "plot": picture("Driven and quiet conductors, and modes of a pair"),
}


@command("tline.signal.crosstalk:crosstalk", files=FILES, epilog=EXAMPLES)
def crosstalk(scene: str, *, confined: bool = False, **given: Any) -> Output:
    """Run a scene with coupled conductors, one of which is driven, and compare the others with it.

    Near-end crosstalk (NEXT) is the largest change of voltage of a quiet conductor at the driven side, far-end
    crosstalk (FEXT) that at the other side, both over the swing of the driven end. Differential and common mode are
    the difference and the mean of two conductors at one end.
    """
    from tline.interchange.any_file import read as read_any
    from tline.signal import crosstalk as measured

    read = read_any(scene, confined=confined)
    with crosstalk.named():
        seen = measured.crosstalk(read, **given, progress=True)
    files = {"csv": lambda file: measured.save_crosstalk(seen, file), "plot": drawn(seen.picture, seen)}
    return Output(seen.text_lines(), seen.to_dict, files)
