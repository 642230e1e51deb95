"""`tline frequency`: a scene over frequency."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from tline.cli.from_signature import FileKind, Output, command, drawn, picture, table
from tline.errors import InputError
from tline.scene.medium import MEDIA
from tline.words.aligned import aligned

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from tline.frequency.oscillations import Resonance
    from tline.frequency.response import Response
    from tline.scene.scene import Scene

MOST_POINTS = 1_000_000
MOST_MODES = 12  # oscillations that are printed, of those that grow and of the others
EXAMPLES = """\b
Examples:
  tline frequency cable.toml --from "1 MHz" --to "1 GHz" --plot bode.png --csv response.csv
  tline frequency cable.toml --ports near --z0 50 --save port.s1p
  tline frequency network.toml --source pump --to "20 Hz" --points 2001
"""
FILES = {
    "csv": table("Table of the transfer functions, real and imaginary parts"),
    "save": FileKind((), "S-parameters as Touchstone (.s1p, .s2p, …), or as .csv"),
    "plot": picture("Bode plot"),
}


class Curves(NamedTuple):
    """Complex curves over frequency, what they are of, and their unit."""

    told: dict[str, Any]
    values: "dict[str, NDArray]"
    of: str = "S"
    unit: str = "1"
    probes: "dict[str, Response] | None" = None
    matrix: "NDArray | None" = None


@command(names={"low": "from", "high": "to"}, files=FILES, epilog=EXAMPLES)
def frequency(
    scene: "Scene",
    *,
    source: str | None = None,
    ports: str | None = None,
    z0: str | None = None,
    low: str | None = None,
    high: str | None = None,
    points: int = 1001,
    files: dict[str, str],
) -> Output:
    """Transfer functions, S-parameters and natural oscillations of a scene.

    SCENE is a TOML file as for `tline run`. Waveforms do not count: the answer is what each probe sees per unit of the
    source. Natural oscillations are located as zeros of the scene's characteristic function, not read off a curve; left
    out are those that decay by more than exp(-3) within the shortest delay. Those that grow are listed even below the
    lowest frequency.

    Parameters
    ----------
    source : NAME
        Source whose effect is asked for; the others are silent.
    ports : NODE,NODE
        S-parameters between these nodes instead, sources there taken away.
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
    from tline.solver.description.description import describe
    from tline.solver.stability.growth import growth_sentence

    _check({"source": source, "ports": ports, "z0": z0, "points": points} | files)
    f = _frequencies(scene, low, high, points)
    if ports:
        curves = _parameters(scene, f, [name.strip() for name in ports.split(",")], z0)
    elif scene.sources or source or "csv" in files or "plot" in files:
        curves = _responses(scene, f, source)
    else:
        curves = Curves({"source": None}, {})
    modes, description = _modes(scene, f), describe(scene)
    return Output(
        [*_table(f, curves), *_oscillations(modes)],
        lambda: _data(f, curves, modes),
        {
            "csv": lambda file: _save_response(f, curves, scene, file),
            "save": lambda file: _save_parameters(f, curves, file),
            "plot": drawn(
                "tline.pictures.bode:plot_bode", f, curves.values, curves.of, curves.unit, modes, scene.title
            ),
        },
        [growth_sentence(description)] if description.active else [],
    )


def _check(given: dict[str, Any]) -> None:
    if not 2 <= given["points"] <= MOST_POINTS:
        raise InputError("--points", "not a number of frequencies", f"2 to {MOST_POINTS}", f"{given['points']}")
    for option, instead in (("save", ", or --csv"), ("z0", "")):
        if given.get(option) and not given["ports"]:
            raise InputError(f"--{option}", "is about S-parameters", f"--ports beside it{instead}")
    if given["source"] and given["ports"]:
        raise InputError("--source", "between ports no source counts", "either --source or --ports")
    if "csv" in given and given["ports"]:
        raise InputError("--csv", "is about a source", "--save for S-parameters, or no --ports")


def _frequencies(scene: "Scene", low: str | None, high: str | None, points: int) -> "NDArray":
    """Evenly spaced on a logarithmic scale, as most things here are; by default round the lines' own."""
    import numpy as np

    from tline.units import to_si

    delays = [line.parameters.delay or 0.0 for line in scene.lines.values()]
    top = to_si(high, "Hz", "--to") if high else 2.0 / min(delays)
    bottom = to_si(low, "Hz", "--from") if low else min(0.01 / sum(delays), top / 100)
    if not 0 < bottom < math.inf:
        raise InputError("--from", "not a positive frequency", "such as '1 MHz'", f"'{low}'")
    if not bottom < top < math.inf:
        raise InputError("--to", "not above the lowest frequency", f"more than {bottom:.6g} Hz", f"{top:.6g} Hz")
    return np.geomspace(bottom, top, points)


def _responses(scene: "Scene", f: "NDArray", source: str | None) -> Curves:
    import numpy as np

    from tline.frequency.response import respond

    seen = respond(scene, 2j * np.pi * f, source)
    name, medium = source or next(iter(scene.sources)), MEDIA[scene.medium]
    unit = medium.units["effort"] + _per(scene, name)
    told = {"source": name, "unit": unit}
    return Curves(told, {key: probe.u for key, probe in seen.items()}, f"{medium.effort} / source", unit, seen)


def _per(scene: "Scene", source: str) -> str:
    """Divisor of a unit: that of a source."""
    unit = MEDIA[scene.medium].units["effort" if scene.sources[source].is_effort else "flow"]
    return f"/({unit})" if "/" in unit else f"/{unit}"


def _parameters(scene: "Scene", f: "NDArray", ports: list[str], z0: str | None) -> Curves:
    import numpy as np

    from tline.frequency.ports import scattering_parameters
    from tline.units import to_si

    first = next((line.parameters.z0 for line in scene.lines.values() if ports[0] in line.nodes), 1.0)
    reference = to_si(z0, MEDIA[scene.medium].units["resistance"], "--z0") if z0 else first
    S = scattering_parameters(scene, ports, 2j * np.pi * f, reference)
    values = {f"S({i},{j})": S[:, m, n] for m, i in enumerate(ports) for n, j in enumerate(ports)}
    return Curves({"ports": ports, "z0": reference}, values, matrix=S)


def _save_response(f: "NDArray", curves: Curves, scene: "Scene", file: str) -> None:
    from tline.frequency.response import save_response

    assert curves.probes is not None
    flow = MEDIA[scene.medium].units["flow"] + _per(scene, curves.told["source"])
    save_response(f, curves.probes, (curves.unit, flow), file)


def _save_parameters(f: "NDArray", curves: Curves, file: str) -> None:
    from tline.frequency.response import save_parameters

    assert curves.matrix is not None
    save_parameters(f, curves.matrix, curves.told["ports"], curves.told["z0"], file)


def _modes(scene: "Scene", f: "NDArray") -> "list[Resonance]":
    """Natural oscillations in the range, and those that grow below it; none, and a note, if they are not found."""
    from tline.frequency.oscillations import resonances

    try:
        return [mode for mode in resonances(scene, float(f[-1])) if mode.frequency >= f[0] or mode.decay_time < 0]
    except InputError as error:
        click.echo(f"note: no natural oscillations are listed: {error.problem}", err=True)
        return []


def _data(f: "NDArray", curves: Curves, modes: "list[Resonance]") -> dict[str, Any]:
    import numpy as np

    def finite(number: float) -> float | str:
        return number if math.isfinite(number) else "inf"

    found = [{key: finite(getattr(mode, key)) for key in ("frequency", "quality", "decay_time")} for mode in modes]
    values = {name: {"re": np.real(c).tolist(), "im": np.imag(c).tolist()} for name, c in curves.values.items()}
    return curves.told | {"natural_oscillations": found, "frequency": f.tolist(), "values": values}


def _table(f: "NDArray", curves: Curves) -> list[str]:
    import numpy as np

    if not curves.values:
        return ["no source: natural oscillations only"]
    unit = curves.unit
    rows = [(curves.of, f"lowest size [{unit}]", "at [Hz]", f"highest size [{unit}]", "at [Hz]")]
    for name, values in curves.values.items():
        size = np.abs(values)
        low, high = int(np.nanargmin(size)), int(np.nanargmax(size))
        rows.append((name, f"{size[low]:.4g}", f"{f[low]:.6g}", f"{size[high]:.4g}", f"{f[high]:.6g}"))
    return aligned(rows, 1)


def _oscillations(modes: "list[Resonance]") -> Iterator[str]:
    """Those that grow, and the others, each the slowest first."""
    for title, growing in (("waves that grow:", True), ("natural oscillations:", False)):
        found = [mode for mode in modes if (mode.decay_time < 0) == growing]
        more = [f"  and {len(found) - MOST_MODES} more"] * (len(found) > MOST_MODES)
        yield from ["", title, *(f"  {_described(mode)}" for mode in found[:MOST_MODES]), *more] if found else []


def _described(mode: "Resonance") -> str:
    turning = f"{mode.frequency:.6g} Hz"
    if mode.decay_time < 0:
        return f"{turning}, grow by a factor e in {-mode.decay_time:.4g} s"
    if math.isinf(mode.decay_time):
        return f"{turning}, undamped"
    return f"{turning}, Q = {mode.quality:.4g}, decays by a factor e in {mode.decay_time:.4g} s"
