"""`tline eye`: a bit pattern as a probe sees it."""

from typing import TYPE_CHECKING, Any

from tline.cli.from_signature import Output, command, drawn, picture
from tline.errors import InputError

if TYPE_CHECKING:
    from tline.signal.eye_diagram import Eye
    from tline.signal.eye_statistics import Mask

EXAMPLES = """\b
Examples:
  tline eye cable.toml --probe far --bit "1 ns" --rise "0.2 ns" --plot eye.png
  tline eye cable.toml --probe far --bit "1 ns" --rise "0.2 ns" --bits 00101110 --high "3.3 V" --json
  tline eye scenes/ddr_ibis.toml --probe die --bit "1 ns" --plot eye.png
"""


@command(
    "tline.signal.eye_diagram:eye", names={"period": "bit"}, files={"plot": picture("Eye diagram")}, epilog=EXAMPLES
)
def eye(scene: str, *, mask: str | None = None, confined: bool = False, **given: Any) -> Output:
    """Send a bit pattern through a scene, and measure how far the eye opens at a probe.

    The pattern is sent twice, and the second round is measured. The width is taken half way between ones and zeros
    where the eye is highest; the height in the middle of that width, the sampling instant; the jitter is the spread of
    the crossings of that level. A closed eye, or one that touches the mask, exits with 1.

    Parameters
    ----------
    mask : TIME,LEVEL
        Width and height of a hexagon in its middle, as '0.4 ns, 0.3 V'.
    """
    from tline.interchange.any_file import read as read_any
    from tline.signal import eye_diagram
    from tline.signal.eye_statistics import mask_hits

    read = read_any(scene, confined=confined)
    given |= {key: _number_or_text(given[key]) for key in ("low", "high") if key in given}
    with eye.named():
        seen = eye_diagram.eye(read, **given, progress=True)
    unit = seen.medium.units["effort"]
    hexagon = None if mask is None else _mask(mask, seen, unit)
    hits = 0 if hexagon is None else mask_hits(seen, hexagon)
    told = f"mask touched by {hits} of {len(seen.bits)} bits"
    return Output(
        [*seen.text_lines(), *([told] if hexagon else [])],
        lambda: seen.to_dict() | ({"mask_hits": hits} if hexagon else {}),
        {"plot": drawn(seen.picture, seen, mask=hexagon)},
        exit_code=int(seen.height <= 0 or hits > 0),
    )


def _mask(text: str, seen: "Eye", unit: str) -> "Mask":
    from tline.signal.eye_statistics import mask_of

    parts = [_number_or_text(part.strip()) for part in text.split(",")]
    if len(parts) != 2:
        raise InputError("--mask", "not a width and a height", "such as '0.4 ns, 0.3 V'", f"'{text}'")
    with eye.named():
        return mask_of(parts[0], parts[1], seen, unit)


def _number_or_text(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text
