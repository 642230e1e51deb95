"""Commands `tline tdr`, `tline crosstalk`, `tline eye` and `tline channel`: signals on cables."""

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from tline.cli.from_signature import FileKind, Output, command, drawn, picture, table
from tline.cli.options import options_named
from tline.errors import InputError

if TYPE_CHECKING:
    from tline.scene.scene import Scene
    from tline.signal import Eye, Mask, OperatingMargin, PulseResponse, Reflections, StatisticalEye
    from tline.signal.crosstalk import Crosstalk

OF_EYE = "ber", "dfe", "noise", "jitter", "sinusoidal", "duty_cycle"
OF_STATISTICS = (*OF_EYE, "ffe", "ctle", "low_pass", "neighbours")


@command(
    "tline.signal.tdr:reflectometry",
    names={"node": "port", "t_end": "to"},
    files={
        "csv": table("Time, incident and reflected wave per step, impedance"),
        "plot": picture("Waves and impedance over time"),
    },
    epilog="""\b
Examples:
  tline tdr cable.toml --port near --rise "50 ps" --plot tdr.png
  tline tdr cable.toml --port near --rise "50 ps" --z0 50 --csv tdr.csv
""",
)
def tdr(scene: "Scene", **given: Any) -> "Reflections":
    """Send a step into a node of a scene, and show its reflections.

    The impedance is z0 (1 + ρ)/(1 - ρ) of the reflected wave ρ, as if each reflection had come back on its first way:
    exact up to the first discontinuity, misled by multiple reflections behind it. Other sources are silent.
    """
    from tline.signal import reflectometry

    return reflectometry(scene, **given, progress=True)


@command(
    "tline.signal.crosstalk:crosstalk",
    files={
        "csv": table("Voltages of all conductors, differences and means of pairs"),
        "plot": picture("Driven and quiet conductors, and modes of a pair"),
    },
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
    low_pass: str | None = None,
    neighbours: str | None = None,
    **given: Any,
) -> Output:
    """Send a bit pattern through a scene, and measure the opening of the eye at a probe.

    Of a linear scene with one source that sends, one bit is simulated, and the pattern's answers are added; of others
    the pattern is sent twice, and the second round is measured. The width is taken half way between ones and zeros
    where the eye is highest; the height in the middle of that width, the sampling instant; the jitter is the spread of
    the crossings of that level. A closed eye, or one that touches the mask, exits with 1.

    With --statistical one bit is sent, and the answers of all patterns are added up by their probabilities: the eye of
    a linear channel down to error rates that no run reaches, with equalisers at either end.

    Parameters
    ----------
    mask : TIME,LEVEL
        Width and height of a hexagon in its middle, as '0.4 ns, 0.3 V'.
    statistical
        Use all patterns of a linear scene, from its response to one bit.
    ffe : TAPS
        Weights of the sender's taps, as '-0.1, 0.8, -0.1', or 'best:1,2' for the best weights with one
        tap before and two behind the main one.
    ctle : DB,HZ,HZ,…
        Gain at rest, zero and poles of a receiver's equaliser, as '-6, 2 GHz, 5 GHz, 15 GHz'; 'best' for the gain tries
        0 to -12 dB.
    low_pass : HZ
        Bandwidth of the receiver's noise filter, Butterworth's of fourth order.
    neighbours : SOURCE,…
        Other sources that send bits of their own, of the same levels and edges, through the same equalisers.
    """
    from tline.frequency.response import source_named
    from tline.signal import eye_diagram, mask_hits, pulse_response

    _check_options(statistical, given | {"ffe": ffe, "ctle": ctle, "low_pass": low_pass, "neighbours": neighbours})
    if statistical:
        asked = {key: given.pop(key) for key in OF_EYE if key in given}
        others = [name.strip() for name in (neighbours or "").split(",") if name]
        sender = source_named(scene, given.pop("source", None))
        if len({sender, *others}) <= len(others):
            expected = f"each once, and not the sender '{sender}'"
            raise InputError("--neighbours", "a source occurs twice", expected, f"'{neighbours}'")
        pulses = [pulse_response(scene, source=sender, **given, progress=True)]
        with options_named({"source": "--neighbours"}):
            pulses += [pulse_response(scene, source=name, **given, progress=True) for name in others]
        seen, taps, gain = _equalised(pulses, ffe, ctle, low_pass, asked)
        told, closed = _told(seen, taps, gain, mask)
        plot = drawn(seen.picture, seen, mask=None if mask is None else _mask(mask, seen))
        return eye.shown(seen, *told, told={"ffe": taps, "ctle_gain": gain}, exit_code=closed, plot=plot)
    seen = eye_diagram.eye(scene, **given, progress=True)
    if mask is None:
        return eye.shown(seen, exit_code=int(seen.height <= 0))
    hexagon = _mask(mask, seen)
    hits, plot = mask_hits(seen, hexagon), drawn(seen.picture, seen, mask=hexagon)
    line, closed = f"mask touched by {hits} of {len(seen.bits)} bits", seen.height <= 0 or hits > 0
    return eye.shown(seen, line, told={"mask_hits": hits}, exit_code=int(closed), plot=plot)


def _mask(text: str, seen: "Eye | StatisticalEye") -> "Mask":
    from tline.signal.eye_statistics import mask_of

    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 2:
        raise InputError("--mask", "not a width and a height", "such as '0.4 ns, 0.3 V'", f"'{text}'")
    return mask_of(parts[0], parts[1], seen, seen.medium.units["effort"])


def _check_options(statistical: bool, given: dict[str, Any]) -> None:
    """Raise an error for options of the other kind of eye."""
    for name in ("bits",) if statistical else OF_STATISTICS:
        if given.get(name) is not None:
            problem = "is for one pattern, not for all of them" if statistical else "is for --statistical alone"
            raise InputError(f"--{name.replace('_', '-')}", problem)


def _equalised(
    pulses: "list[PulseResponse]", ffe: str | None, ctle: str | None, low_pass: str | None, asked: dict[str, Any]
) -> "tuple[StatisticalEye, list[float], float | None]":
    """Highest eye of all equalisers tried, sender's taps, and gain of the receiver's filter."""
    from tline.signal import statistical_eye

    if low_pass is not None:
        pulses = [each.with_low_pass(low_pass) for each in pulses]
    gains: list[float | None] = [None]
    corners: list[float] = []
    if ctle is not None:
        first, _, rest = ctle.partition(",")
        corners = _numbers(rest, "ctle", "Hz")
        gains = [0.0 - k for k in range(13)] if first.strip() == "best" else [*_numbers(first, "ctle", "dB")]
    best = None
    for gain in gains:
        own, *others = pulses if gain is None else [each.with_ctle(gain, *corners) for each in pulses]
        taps = [1.0] if ffe is None else _taps(ffe, own, int(asked.get("dfe", 0)))
        seen = statistical_eye(own.with_ffe(taps), aggressors=[each.with_ffe(taps) for each in others], **asked)
        if best is None or seen.height > best[0].height:
            best = seen, taps, gain
    assert best is not None, "some gain is tried"
    return best


def _told(seen: "StatisticalEye", taps: list[float], gain: float | None, mask: str | None) -> tuple[list[str], int]:
    """Describe equalisers and mask for the text of an eye, and return the exit status."""
    from tline.signal import mask_margin

    told = ["sender's taps " + ", ".join(f"{tap:.4g}" for tap in taps)] if len(taps) > 1 else []
    told += [] if gain is None else [f"receiver's gain at rest {gain:g} dB"]
    margin = None if mask is None else mask_margin(seen, _mask(mask, seen))
    if margin is not None:
        word = f"free by {margin:.4g}" if margin > 0 else f"entered by {-margin:.4g}"
        told.append(f"mask {word} {seen.medium.units['effort']}")
    return told, int(seen.height <= 0 or (margin is not None and margin <= 0))


@command(
    "tline.signal.channel:measured_channel",
    "tline.signal.pulse:pulse_response",
    "tline.signal.all_patterns:statistical_eye",
    names={"": "channel", "near": "next"},
    files={
        "plot": picture("Losses, crosstalk and conversion; with --com alone the equalised pulse"),
        "report": FileKind((".html", ".pdf"), "Losses, impedances, eye, margin, passivity, inputs, versions"),
    },
    omit=["pulse", "aggressors", "period", "rise", "probe", "source"],
    epilog="""\b
Examples:
  tline channel scenes/filter.s2p --plot losses.png
  tline channel backplane.s4p --ports "1,3 2,4" --report channel.html
  tline channel backplane.s8p --ports "1,3 2,4 5,7 6,8" --bit "40 ps" --ffe best:1,2 --dfe 3 --report channel.html
  tline channel thru.s4p --ports "1,3 2,4" --com 100GBASE-KR4 --fext fext.s4p --next next.s4p --plot pulse.png
""",
)
def channel(
    file: str,
    *,
    com: str | None = None,
    fext: tuple[str, ...] = (),
    near: tuple[str, ...] = (),
    bit: str | None = None,
    rise: str | None = None,
    ffe: str | None = None,
    ctle: str | None = None,
    low_pass: str | None = None,
    mask: str | None = None,
    files: Mapping[str, str],
    **given: Any,
) -> Output:
    """Report on a measured channel: losses, crosstalk, impedances, and the eye of all bit patterns.

    S of a Touchstone file between single ports or differential modes of pairs, with the nearest passive model of it,
    which is proved. With --bit its eye, exact for that model, down to error rates that no run reaches. A closed eye,
    one that enters the mask, and a model farther from the file than the tolerance exit with 1.

    With --com its channel operating margin as of IEEE 802.3, annex 93A, from the samples themselves, with packages and
    the best equalisers of a clause; a margin below the clause's exits with 1. Without --bit and --report this is all.

    Parameters
    ----------
    com : CLAUSE
        Parameters of the margin: 100GBASE-KR4, 100GBASE-CR4, 100GBASE-KP4, 200GAUI-4, or a .toml or .json file of them.
    fext : FILE
        Way from a far-end aggressor to the receiver, at the first two of --ports; may be repeated.
    near : FILE
        Way from a near-end aggressor likewise, or which neighbour of --ports is one; may be repeated.
    bit : TIME
        Time of a bit; without it no eye is computed.
    rise : TIME
        Time of a change of bits, and of the step for impedances; half a period of the highest frequency if not
        given.
    ffe : TAPS
        As of `tline.cli.signal.eye`.
    ctle : DB,HZ,HZ,…
        As of `tline.cli.signal.eye`.
    low_pass : HZ
        As of `tline.cli.signal.eye`.
    mask : TIME,LEVEL
        As of `tline.cli.signal.eye`.
    """
    from tline.cli.fit import trying
    from tline.signal import measured_channel

    asked = {key: given.pop(key) for key in OF_EYE if key in given}
    levels = {key: given.pop(key) for key in ("low", "high") if key in given}
    equalisers = {"ffe": ffe, "ctle": ctle, "low_pass": low_pass, "mask": mask}
    for name, value in (asked | levels | equalisers).items():
        if bit is None and value is not None:
            raise InputError(f"--{name.replace('_', '-')}", "is of an eye", "--bit beside it")
    alone = com is not None and bit is None and "report" not in files
    for name, value in {"rise": rise, "tol": given.get("tol")}.items():
        if alone and value is not None:
            raise InputError(f"--{name}", "is not of a margin alone", "--bit or --report beside it")
    margin = _margin(file, com, given.get("ports", "1 2"), fext, near)
    exit_code = int(margin is not None and margin.margin < float(margin.clause.least))
    if margin is not None and alone:
        return channel.shown(margin, exit_code=exit_code, report=None)
    with trying() as tried:
        found = measured_channel(file, progress=tried, **given)
    edge = 0.5 / float(found.measured.f[-1]) if rise is None else rise
    exit_code = max(exit_code, int(not found.found.meets(found.tol)))
    eye_seen, lines, more = None, [], {}
    if margin is not None:
        lines, more = [*margin.text_lines()], {"margin": margin.to_dict()}
    if bit is not None:
        neighbours = range(2, len(found.names))
        with options_named({"period": "--bit", "rise": "--rise"}):
            pulses = [found.pulse(bit, edge, source=k, **levels) for k in (0, *neighbours)]
        eye_seen, taps, gain = _equalised(pulses, ffe, ctle, low_pass, asked)
        told, closed = _told(eye_seen, taps, gain, mask)
        exit_code = max(exit_code, closed)
        lines += [*eye_seen.text_lines(), *told]
        more |= {"eye": eye_seen.to_dict() | {"ffe": taps, "ctle_gain": gain}}
    inputs = given | {"bit": bit, "rise": edge, "com": com} | asked | levels | equalisers
    inputs |= {"fext": ", ".join(fext) or None, "next": ", ".join(near) or None}
    shown = {name: str(value) for name, value in inputs.items() if value is not None}
    page = partial(found.save, seen=eye_seen, margin=margin, rise=edge, inputs=shown)
    return channel.shown(found, *lines, told=more, exit_code=exit_code, report=page)


def _margin(
    file: str, com: str | None, ports: str, fext: tuple[str, ...], near: tuple[str, ...]
) -> "OperatingMargin | None":
    """Margin by the parameters that are named, if any."""
    from tline.scene.text_file import check_readable

    for each in (file, *fext, *(each for each in near if each not in ports.split())):
        check_readable(each)
    if com is not None:
        from tline.signal import operating_margin

        with options_named({"clause": "--com", "file": file}):
            return operating_margin(file, com, ports, fext=fext, near=near)
    if fext or near:
        raise InputError("--fext" if fext else "--next", "is of a margin", "--com beside it")
    return None


def _taps(text: str, pulse: "PulseResponse", dfe: int) -> list[float]:
    """Parse the taps given, or find the best."""
    from tline.signal import best_ffe

    kind, _, numbers = text.partition(":")
    if kind.strip() != "best":
        return _numbers(text, "ffe")
    parts = numbers.split(",")
    if len(parts) != 2 or not all(part.strip().isdigit() and int(part) < 20 for part in parts):
        raise InputError("--ffe", "not how many taps before and behind the main one", "such as best:1,2", f"'{text}'")
    return best_ffe(pulse, *map(int, parts), dfe=dfe).tolist()


def _numbers(text: str, name: str, *units: str) -> list[float]:
    """Parse numbers with commas between, the first of the first unit, others of the last."""
    from tline.units import to_si

    found = []
    for k, part in enumerate(text.split(",")):
        unit = units[min(k, len(units) - 1)] if units else ""
        part, unit = (part.lower().replace("db", ""), "") if unit == "dB" else (part, unit)
        found.append(to_si(part.strip(), unit, name))
    return found
