"""What `tline eye --statistical` prints: the eye of all bit patterns, from the response to one bit."""

from typing import TYPE_CHECKING, Any

from tline.cli.from_signature import Output, drawn
from tline.errors import InputError
from tline.scene.scene import Scene

if TYPE_CHECKING:
    from tline.signal.pulse import PulseResponse

OF_PATTERNS = "bits", "mask"
OF_STATISTICS = "ber", "dfe", "noise", "jitter", "ffe", "ctle"


def check_options(statistical: bool, given: dict[str, Any]) -> None:
    """Refuse options of the other kind of eye."""
    for name in OF_PATTERNS if statistical else OF_STATISTICS:
        if given.get(name) is not None:
            problem = "is for one pattern, not for all of them" if statistical else "is for --statistical alone"
            raise InputError(f"--{name}", problem)


def output_of(scene: Scene, ffe: str | None, ctle: str | None, given: dict[str, Any]) -> Output:
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
    files = {"plot": drawn(seen.picture, seen)}
    return Output(
        [*seen.text_lines(), *more], lambda: seen.to_dict() | {"ffe": taps}, files, exit_code=int(seen.height <= 0)
    )


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
