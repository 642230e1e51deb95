"""Measured or computed samples in a Touchstone or CSV file, and the nearest passive model."""

import json
from typing import TYPE_CHECKING

from tline.cli.verdicts.answer import Answer, Asked
from tline.errors import InputError

if TYPE_CHECKING:
    from passivity.sampled.response import SampledResponse


def answer(file: str, asked: Asked) -> Answer:
    """Look at the samples of a file; with --nearest fit a model and make it passive."""
    from passivity.expression.number import double
    from passivity.rational.evaluate import exact
    from passivity.sampled.check import check_samples
    from passivity.sampled.enforce import nearest
    from passivity.sampled.report import draw_samples, in_lines, samples_as_dict

    asked.refuse("samples", "parameters", "delay", "within")
    response = _read(file, asked)
    verdict = check_samples(response, None if asked.error is None else double(exact(asked.error, "tolerance")))
    if asked.nearest and not asked.nearest.lower().endswith(wanted := (".json", f".s{response.ports}p")):
        raise InputError("--nearest", "not a file for these ports", " or ".join(wanted), f"'{asked.nearest}'")
    enforced = nearest(response) if asked.nearest else None
    told = samples_as_dict(verdict, enforced)
    lines = in_lines(verdict, enforced)
    if enforced is not None and asked.nearest:
        from tline.solver.result.atomic import replacing

        with replacing(asked.nearest) as temporary:
            touchstone = not asked.nearest.lower().endswith(".json")
            text = enforced.response.touchstone() if touchstone else json.dumps(told["model"], indent=2) + "\n"
            temporary.write_text(text, encoding="utf-8")
        lines.append(f"wrote {asked.nearest}")
    status = verdict.status if enforced is None else enforced.status
    return Answer(status.value, lines, told, lambda: draw_samples(verdict, enforced))


def _read(file: str, asked: Asked) -> "SampledResponse":
    from passivity.expression.number import double
    from passivity.rational.evaluate import exact
    from passivity.sampled.read import read_csv, read_touchstone
    from tline.cli.options import check_readable

    check_readable(file)
    if not file.lower().endswith(".csv"):
        asked.refuse("Touchstone files, which say so themselves", "kind", "z0")
        return read_touchstone(file)
    if asked.kind == "chain":
        raise InputError("--kind", "samples are of an impedance or a reflection", "pr or br", "'chain'")
    return read_csv(
        file, "S" if asked.kind == "br" else "Z", double(exact("50" if asked.z0 is None else asked.z0, "z0"))
    )
