"""`tline tdr`, `tline crosstalk` and `tline eye`: signals on cables."""

from typing import TYPE_CHECKING, Any

from tline.cli.from_signature import Output, command, drawn, picture, table
from tline.errors import InputError

if TYPE_CHECKING:
    from tline.scene.scene import Scene
    from tline.signal import Eye, Mask, PulseResponse, Reflections
    from tline.signal.crosstalk import Crosstalk

REFLECTIONS = {
    "csv": table("Time, incident and reflected wave per step, impedance"),
    "plot": picture("Waves and impedance over time"),
}
CONDUCTORS = {
    "csv": table("Voltages of all conductors, differences and means of pairs"),
    "plot": picture("Driven and quiet conductors, and modes of a pair"),
}
OF_PATTERNS = "bits", "mask"
OF_STATISTICS = "ber", "dfe", "noise", "jitter", "ffe", "ctle"


@command(
    "tline.signal.tdr:reflectometry",
    names={"node": "port", "t_end": "to"},
    files=REFLECTIONS,
    epilog="""\b
Examples:
  tline tdr cable.toml --port near --rise "50 ps" --plot tdr.png
  tline tdr cable.toml --port near --rise "50 ps" --z0 50 --csv tdr.csv
""",
)
def tdr(scene: "Scene", **given: Any) -> "Reflections":
    """Send a step into a node of a scene, and show what comes back.

    The impedance is z0 (1 + ρ)/(1 - ρ) of the reflected wave ρ, as if each reflection had come back on its first way:
    exact up to the first discontinuity, misled by multiple reflections behind it. Other sources are silent.
    """
    from tline.signal import reflectometry

    return reflectometry(scene, **given, progress=True)


@command(
    "tline.signal.crosstalk:crosstalk",
    files=CONDUCTORS,
    epilog="""\b
Examples:
  tline crosstalk scenes/skin_pair.toml --plot crosstalk.png
  tline crosstalk scenes/coupled_pair.toml --csv crosstalk.csv --json
""",
)
def crosstalk(scene: "Scene", **given: Any) -> "Crosstalk":
    """Run a scene with coupled conductors, one of which is driven, and compare the others with it.

    Near-end crosstalk (NEXT) is the largest change of voltage of a quiet conductor at the driven side, far-end
    crosstalk (FEXT) that at the other side, both over the swing of the driven end. Differential and common mode are
    the difference and the mean of two conductors at one end.
    """
    from tline.signal.crosstalk import crosstalk as compared

    return compared(scene, **given, progress=True)


@command(
    "tline.signal.eye_diagram:eye",
    "tline.signal.all_patterns:statistical_eye",
    names={"period": "bit"},
    files={"plot": picture("Eye diagram")},
    omit=["pulse", "aggressors"],
    epilog="""\b
Examples:
  tline eye cable.toml --probe far --bit "1 ns" --rise "0.2 ns" --plot eye.png
  tline eye cable.toml --probe far --bit "1 ns" --rise "0.2 ns" --bits 00101110 --high "3.3 V" --json
  tline eye cable.toml --probe far --bit "0.1 ns" --rise "20 ps" --statistical --ffe best:1,2 --dfe 2 --plot eye.png
  tline eye scenes/ddr_ibis.toml --probe die --bit "1 ns" --plot eye.png
""",
)
def eye(
    scene: "Scene",
    *,
    mask: str | None = None,
    statistical: bool = False,
    ffe: str | None = None,
    ctle: str | None = None,
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
    from tline.signal import eye_diagram, mask_hits

    given |= {key: _number_or_text(given[key]) for key in ("low", "high") if key in given}
    _check_options(statistical, given | {"mask": mask, "ffe": ffe, "ctle": ctle})
    if statistical:
        return _of_all_patterns(scene, ffe, ctle, given)
    seen = eye_diagram.eye(scene, **given, progress=True)
    if mask is None:
        return eye.shown(seen, exit_code=int(seen.height <= 0))
    hexagon = _mask(mask, seen)
    hits, plot = mask_hits(seen, hexagon), drawn(seen.picture, seen, mask=hexagon)
    line, closed = f"mask touched by {hits} of {len(seen.bits)} bits", seen.height <= 0 or hits > 0
    return eye.shown(seen, line, told={"mask_hits": hits}, exit_code=int(closed), plot=plot)


def _mask(text: str, seen: "Eye") -> "Mask":
    from tline.signal.eye_statistics import mask_of

    parts = [_number_or_text(part.strip()) for part in text.split(",")]
    if len(parts) != 2:
        raise InputError("--mask", "not a width and a height", "such as '0.4 ns, 0.3 V'", f"'{text}'")
    return mask_of(parts[0], parts[1], seen, seen.medium.units["effort"])


def _number_or_text(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def _check_options(statistical: bool, given: dict[str, Any]) -> None:
    """Refuse options of the other kind of eye."""
    for name in OF_PATTERNS if statistical else OF_STATISTICS:
        if given.get(name) is not None:
            problem = "is for one pattern, not for all of them" if statistical else "is for --statistical alone"
            raise InputError(f"--{name}", problem)


def _of_all_patterns(scene: "Scene", ffe: str | None, ctle: str | None, given: dict[str, Any]) -> Output:
    """Pulse, equalisers, statistics: their numbers, and the picture."""
    from tline.signal import pulse_response, statistical_eye

    asked = {key: given.pop(key) for key in ("ber", "dfe", "noise", "jitter") if key in given}
    pulse = pulse_response(scene, **given, progress=True)
    if ctle is not None:
        pulse = pulse.with_ctle(*_numbers(ctle, "ctle", "dB", "Hz"))
    taps = [1.0] if ffe is None else _taps(ffe, pulse, int(asked.get("dfe", 0)))
    pulse = pulse.with_ffe(taps)
    seen = statistical_eye(pulse, **asked)
    more = ["sender's taps " + ", ".join(f"{tap:.4g}" for tap in taps)] if len(taps) > 1 else []
    return eye.shown(seen, *more, told={"ffe": taps}, exit_code=int(seen.height <= 0))


def _taps(text: str, pulse: "PulseResponse", dfe: int) -> list[float]:
    """As they are given, or the best."""
    from tline.signal import best_ffe

    kind, _, numbers = text.partition(":")
    if kind.strip() != "best":
        return _numbers(text, "ffe")
    parts = numbers.split(",")
    if len(parts) != 2 or not all(part.strip().isdigit() and int(part) < 20 for part in parts):
        raise InputError("--ffe", "not how many taps before and behind the main one", "such as best:1,2", f"'{text}'")
    return best_ffe(pulse, *map(int, parts), dfe=dfe).tolist()


def _numbers(text: str, name: str, *units: str) -> list[float]:
    """Numbers with commas between, the first of the first unit, others of the last."""
    from tline.units import to_si

    found = []
    for k, part in enumerate(text.split(",")):
        part, unit = part.strip(), units[min(k, len(units) - 1)] if units else ""
        if unit == "dB":
            part, unit = part.lower().removesuffix("db").strip(), ""
        try:
            found.append(float(part))
        except ValueError:
            found.append(to_si(part, unit, name))
    return found
