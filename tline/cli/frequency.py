"""`tline frequency`: a scene over frequency."""

import json
import math
from typing import TYPE_CHECKING, Any

import click

from tline.cli.options import confined_option
from tline.errors import InputError
from tline.scene.medium import MEDIA
from tline.words.aligned import aligned

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from tline.frequency.oscillations import Resonance
    from tline.scene.scene import Scene

PICTURE = (".png", ".svg", ".pdf")
MOST_POINTS = 1_000_000
MOST_MODES = 12  # oscillations that are printed, of those that grow and of the others
EXAMPLES = """\b
Examples:
  tline frequency cable.toml --from "1 MHz" --to "1 GHz" --plot bode.png --csv response.csv
  tline frequency cable.toml --ports near --z0 50 --save port.s1p
  tline frequency network.toml --source pump --to "20 Hz" --points 2001
"""


@click.command("frequency", epilog=EXAMPLES)
@click.argument("scene")
@click.option("--source", metavar="NAME", help="Source whose effect is asked for; the others are silent.")
@click.option(
    "--ports", metavar="NODE,NODE", help="S-parameters between these nodes instead, sources there taken away."
)
@click.option(
    "--z0", metavar="OHM", help="Reference resistance of the ports; that of the first line there if not given."
)
@click.option("--from", "low", metavar="FREQUENCY", help="Lowest frequency, such as '1 MHz'.")
@click.option("--to", "high", metavar="FREQUENCY", help="Highest frequency.")
@click.option("--points", type=int, default=1001, show_default=True, help="Number of frequencies.")
@click.option("--csv", metavar="FILE.csv", help="Table of the transfer functions, real and imaginary parts.")
@click.option("--save", metavar="FILE.sNp", help="S-parameters as Touchstone, or as .csv.")
@click.option("--plot", metavar="FILE", help="Bode plot; .png, .svg or .pdf.")
@confined_option
@click.option("--json", "as_json", is_flag=True, help="Print all numbers.")
def frequency(scene: str, points: int, confined: bool, as_json: bool, **given: str | None) -> None:
    """Transfer functions, S-parameters and natural oscillations of a scene.

    SCENE is a TOML file as for `tline run`. Waveforms do not count: the answer is what each probe sees per unit of the
    source. Natural oscillations are located as zeros of the scene's characteristic function, not read off a curve; left
    out are those that decay by more than exp(-3) within the shortest delay. Those that grow are listed even below the
    lowest frequency.
    """
    from tline.scene.file import read_scene
    from tline.solver.description.description import describe
    from tline.solver.stability.growth import growth_sentence

    files = {key: given[key] for key in ("csv", "save", "plot") if given[key]}
    _check(given, files, points)
    read = read_scene(scene, confined=confined)
    f = _frequencies(read, given["low"], given["high"], points)
    if given["ports"]:
        told, curves = _parameters(read, f, given)
    elif read.sources or given["source"] or given["csv"] or given["plot"]:
        told, curves = _responses(read, f, given)
    else:
        told, curves = {"source": None}, {}
    modes = _modes(read, f)
    if given["plot"]:
        from tline.pictures.bode import plot_bode
        from tline.pictures.style import save_figure

        save_figure(plot_bode(f, curves, *_asked(read, told), modes, read.title), given["plot"])
    if (description := describe(read)).active:
        click.echo(f"note: {growth_sentence(description)}", err=True)
    if as_json:
        click.echo(_as_json(told, f, curves, modes))
    else:
        written = [f"wrote {file}" for file in files.values()]
        click.echo("\n".join([*_table(f, curves, *_asked(read, told)), *_oscillations(modes), *written]))


def _check(given: dict[str, str | None], files: dict[str, Any], points: int) -> None:
    from tline.solver.result.atomic import check_writable

    if not 2 <= points <= MOST_POINTS:
        raise InputError("--points", "not a number of frequencies", f"2 to {MOST_POINTS}", f"{points}")
    for option, instead in (("save", ", or --csv"), ("z0", "")):
        if given[option] and not given["ports"]:
            raise InputError(f"--{option}", "is about S-parameters", f"--ports beside it{instead}")
    if given["source"] and given["ports"]:
        raise InputError("--source", "between ports no source counts", "either --source or --ports")
    if given["csv"] and given["ports"]:
        raise InputError("--csv", "is about a source", "--save for S-parameters, or no --ports")
    for option, suffixes in (("csv", (".csv",)), ("plot", PICTURE)):
        if option in files and not files[option].lower().endswith(suffixes):
            raise InputError(f"--{option}", "unknown kind of file", " or ".join(suffixes), f"'{files[option]}'")
    for file in files.values():
        check_writable(file)


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


def _responses(scene: "Scene", f: "NDArray", given: dict[str, str | None]) -> "tuple[dict[str, Any], dict[str, Any]]":
    import numpy as np

    from tline.frequency.response import respond
    from tline.frequency.save import save_response

    seen = respond(scene, 2j * np.pi * f, given["source"])
    name, units = given["source"] or next(iter(scene.sources)), MEDIA[scene.medium].units
    source = units["effort" if scene.sources[name].is_effort else "flow"]
    per = f"({source})" if "/" in source else source
    unit = f"{units['effort']}/{per}"
    if given["csv"]:
        save_response(f, seen, (unit, f"{units['flow']}/{per}"), given["csv"])
    return {"source": name, "unit": unit}, {name: probe.u for name, probe in seen.items()}


def _parameters(scene: "Scene", f: "NDArray", given: dict[str, str | None]) -> "tuple[dict[str, Any], dict[str, Any]]":
    import numpy as np

    from tline.frequency.ports import scattering_parameters
    from tline.frequency.save import save_parameters
    from tline.units import to_si

    ports = [name.strip() for name in (given["ports"] or "").split(",")]
    first = next((line.parameters.z0 for line in scene.lines.values() if ports[0] in line.nodes), 1.0)
    z0 = to_si(given["z0"], MEDIA[scene.medium].units["resistance"], "--z0") if given["z0"] else first
    S = scattering_parameters(scene, ports, 2j * np.pi * f, z0)
    if given["save"]:
        save_parameters(f, S, ports, z0, given["save"])
    curves = {f"S({i},{j})": S[:, m, n] for m, i in enumerate(ports) for n, j in enumerate(ports)}
    return {"ports": ports, "z0": z0}, curves


def _modes(scene: "Scene", f: "NDArray") -> "list[Resonance]":
    """Natural oscillations in the range, and those that grow below it; none, and a note, if they are not found."""
    from tline.frequency.oscillations import resonances

    try:
        return [mode for mode in resonances(scene, float(f[-1])) if mode.frequency >= f[0] or mode.decay_time < 0]
    except InputError as error:
        click.echo(f"note: no natural oscillations are listed: {error.problem}", err=True)
        return []


def _asked(scene: "Scene", told: dict[str, Any]) -> tuple[str, str]:
    """What the curves are, and their unit."""
    return (f"{MEDIA[scene.medium].effort} / source", told["unit"]) if "unit" in told else ("S", "1")


def _as_json(told: dict[str, Any], f: "NDArray", curves: dict[str, Any], modes: "list[Resonance]") -> str:
    import numpy as np

    found = [{key: _text(getattr(mode, key)) for key in ("frequency", "quality", "decay_time")} for mode in modes]
    values = {name: {"re": np.real(c).tolist(), "im": np.imag(c).tolist()} for name, c in curves.items()}
    numbers = {"natural_oscillations": found, "frequency": f.tolist(), "values": values}
    return json.dumps(told | numbers, indent=2, ensure_ascii=False)


def _table(f: "NDArray", curves: dict[str, Any], what: str, unit: str) -> list[str]:
    import numpy as np

    if not curves:
        return ["no source: natural oscillations only"]
    rows = [(what, f"lowest size [{unit}]", "at [Hz]", f"highest size [{unit}]", "at [Hz]")]
    for name, values in curves.items():
        size = np.abs(values)
        low, high = int(np.nanargmin(size)), int(np.nanargmax(size))
        rows.append((name, f"{size[low]:.4g}", f"{f[low]:.6g}", f"{size[high]:.4g}", f"{f[high]:.6g}"))
    return aligned(rows, 1)


def _oscillations(modes: "list[Resonance]") -> list[str]:
    """Those that grow, and the others, each the slowest first."""
    lines = []
    for title, growing in (("waves that grow:", True), ("natural oscillations:", False)):
        found = [mode for mode in modes if (mode.decay_time < 0) == growing]
        more = [f"  and {len(found) - MOST_MODES} more"] * (len(found) > MOST_MODES)
        lines += ["", title, *(f"  {_described(mode)}" for mode in found[:MOST_MODES]), *more] if found else []
    return lines


def _described(mode: "Resonance") -> str:
    turning = f"{mode.frequency:.6g} Hz"
    if mode.decay_time < 0:
        return f"{turning}, grow by a factor e in {-mode.decay_time:.4g} s"
    if math.isinf(mode.decay_time):
        return f"{turning}, undamped"
    return f"{turning}, Q = {mode.quality:.4g}, decays by a factor e in {mode.decay_time:.4g} s"


def _text(number: float) -> float | str:
    return number if math.isfinite(number) else "inf"
