"""`tline crosstalk`: what a driven conductor sends into those beside it."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from tline.cli.from_signature import Output, command, drawn, picture, table

if TYPE_CHECKING:
    from tline.signal.crosstalk import Crosstalk

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
    modes = {
        ", ".join(pair): {"differential": float(abs(u).max()), "common": float(abs(seen.common[pair]).max())}
        for pair, u in seen.differential.items()
    }
    files = {
        "csv": lambda file: measured.save_crosstalk(seen, file),
        "plot": drawn("tline.pictures.signals:plot_crosstalk", seen, read.title),
    }
    told = {"line": seen.line, "driven": seen.driven, "swing": seen.swing, "near": seen.near, "far": seen.far}
    return Output(_text(seen, modes), lambda: told | {"modes": modes}, files)


def _text(seen: "Crosstalk", modes: dict[str, dict[str, float]]) -> Iterator[str]:
    yield f"'{seen.driven}' of '{seen.line}' swings by {seen.swing:.6g} V"
    for word, shares in (("near end", seen.near), ("far end", seen.far)):
        for node, share in shares.items():
            yield f"{word} '{node}' {share * seen.swing:.6g} V, {100 * share:.4g} %"
    for pair, each in modes.items():
        yield f"{pair}: differential up to {each['differential']:.6g} V, common up to {each['common']:.6g} V"
