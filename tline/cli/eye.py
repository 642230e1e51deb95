"""`tline eye`: a bit pattern as a probe sees it."""

from typing import TYPE_CHECKING, Any

from tline.cli.from_signature import Output, command, drawn, picture
from tline.cli.statistical_eye import check_options, output_of
from tline.errors import InputError

if TYPE_CHECKING:
    from tline.signal.eye_diagram import Eye
    from tline.signal.eye_statistics import Mask

EXAMPLES = """\b
Examples:
  tline eye cable.toml --probe far --bit "1 ns" --rise "0.2 ns" --plot eye.png
  tline eye cable.toml --probe far --bit "1 ns" --rise "0.2 ns" --bits 00101110 --high "3.3 V" --json
  tline eye cable.toml --probe far --bit "0.1 ns" --rise "20 ps" --statistical --ffe best:1,2 --dfe 2 --plot eye.png
  tline eye scenes/ddr_ibis.toml --probe die --bit "1 ns" --plot eye.png
"""


@command(
    "tline.signal.eye_diagram:eye",
    "tline.signal.all_patterns:statistical_eye",
    names={"period": "bit"},
    files={"plot": picture("Eye diagram")},
    omit=["pulse", "aggressors"],
    epilog=EXAMPLES,
)
def eye(
    scene: str,
    *,
    mask: str | None = None,
    statistical: bool = False,
    ffe: str | None = None,
    ctle: str | None = None,
    confined: bool = False,
    **given: Any,
) -> Output:
    """Send a bit pattern through a scene, and measure how far the eye opens at a probe.

    The pattern is sent twice, and the second round is measured. The width is taken half way between ones and zeros
    where the eye is highest; the height in the middle of that width, the sampling instant; the jitter is the spread of
    the crossings of that level. A closed eye, or one that touches the mask, exits with 1.

    With --statistical one bit is sent, and the answers of all patterns are added up by their probabilities: the eye of
    a linear channel down to error rates that no run reaches, with equalisers at either end.

    Parameters
    ----------
    mask : TIME,LEVEL
        Width and height of a hexagon in its middle, as '0.4 ns, 0.3 V'.
    statistical
        The eye of all patterns of a linear scene, from its response to one bit.
    ffe : TAPS
        Factors by which the sender adds up bits, as '-0.1, 0.8, -0.1', or 'best:1,2' for the best of so many taps
        before and behind the main one.
    ctle : DB,HZ,HZ,…
        Gain at rest, zero and poles of a receiver's equaliser, as '-6, 2 GHz, 5 GHz, 15 GHz'.
    """
    from tline.interchange.any_file import read as read_any
    from tline.signal import eye_diagram
    from tline.signal.eye_statistics import mask_hits

    read = read_any(scene, confined=confined)
    given |= {key: _number_or_text(given[key]) for key in ("low", "high") if key in given}
    check_options(statistical, given | {"mask": mask, "ffe": ffe, "ctle": ctle})
    if statistical:
        with eye.named():
            return output_of(read, ffe, ctle, given)
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
