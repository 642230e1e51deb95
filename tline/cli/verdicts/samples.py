"""Measured or computed samples in a Touchstone or CSV file, and the nearest passive model."""

import json
from typing import TYPE_CHECKING

from tline.cli.verdicts.answer import Answer, Asked
from tline.errors import InputError

if TYPE_CHECKING:
    from passivity.sampled.check import Band, SampleVerdict
    from passivity.sampled.enforce import Enforced
    from passivity.sampled.response import SampledResponse

MOST_BANDS = 6


def answer(file: str, asked: Asked) -> Answer:
    """Look at the samples of a file; with --nearest fit a model and make it passive."""
    from passivity.expression.number import double
    from passivity.rational.evaluate import exact
    from passivity.sampled.check import check_samples
    from passivity.sampled.enforce import enforce
    from passivity.sampled.fit import fit
    from passivity.sampled.picture import draw_samples
    from passivity.sampled.report import samples_as_dict

    asked.refuse("samples", "parameters", "delay", "within")
    response = _read(file, asked)
    verdict = check_samples(response, None if asked.error is None else double(exact(asked.error, "tolerance")))
    enforced = enforce(fit(response), response) if asked.nearest else None
    told = samples_as_dict(verdict, enforced)
    lines = _text(verdict, enforced)
    if enforced and asked.nearest:
        from tline.solver.result.atomic import replacing

        with replacing(asked.nearest) as temporary:
            temporary.write_text(json.dumps(told["model"], indent=2) + "\n", encoding="utf-8")
        lines.append(f"wrote {asked.nearest}")
    status = enforced.verdict.status if enforced else verdict.status
    return Answer(status.value, lines, told, lambda: draw_samples(verdict, enforced))


def _read(file: str, asked: Asked) -> "SampledResponse":
    from passivity.expression.number import double
    from passivity.rational.evaluate import exact
    from passivity.sampled.read import read_csv
    from passivity.sampled.touchstone import read_touchstone
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


def _text(verdict: "SampleVerdict", enforced: "Enforced | None") -> list[str]:
    response = verdict.response
    name = {"S": "largest singular value of S", "Z": "smallest Re Z", "Y": "smallest Re Y"}[response.parameter.value]
    lines = [
        f"{len(response.f)} samples of {response.parameter.value}, {response.ports} port{'s' * (response.ports > 1)}, "
        f"{response.f[0]:.6g} to {response.f[-1]:.6g} Hz: {verdict.status.value}",
        f"  {name} = {_value(verdict)} at {verdict.worst_frequency:.6g} Hz",
        *_allowed(verdict),
    ]
    lines += [f"  violated {_band(band, response.parameter)}" for band in verdict.bands[:MOST_BANDS]]
    if len(verdict.bands) > MOST_BANDS:
        lines.append(f"  and in {len(verdict.bands) - MOST_BANDS} more bands")
    lines += [f"  note: {caveat}" for caveat in verdict.caveats]
    if enforced:
        model = enforced.model
        lines += [
            f"nearest passive model, {len(model.poles)} poles: {enforced.verdict.status.value}",
            f"  because {enforced.verdict.why}",
            f"  it misses the samples by {enforced.misfit.rms:.3g} (rms, relative), "
            f"the best fit by {enforced.misfit_before.rms:.3g}; being passive cost {enforced.change.rms:.3g}",
        ]
    return lines


def _value(verdict: "SampleVerdict") -> str:
    """Six digits, and more where they would hide on which side of 1 it lies."""
    text = f"{verdict.worst_value:.6g}"
    off = verdict.worst_value - 1
    return f"1 {'-' if off < 0 else '+'} {abs(off):.3g}" if text == "1" and off else text


def _allowed(verdict: "SampleVerdict") -> list[str]:
    """How far the worst sample is beyond the bound, and how far it may be off."""
    if verdict.worst_excess <= 0:
        return []
    beyond = "σ − 1" if verdict.response.parameter == "S" else "below 0 by"
    source = "digits of the file allow" if verdict.by_digits else "the error allows"
    consistent = "" if verdict.bands else ": consistent with a passive response"
    equals = " = " if beyond.startswith("σ") else " "
    at = f"{verdict.worst_frequency:.6g} Hz"
    return [f"  {beyond}{equals}{verdict.worst_excess:.2g} at {at}, {source} {verdict.worst_bar:.2g}{consistent}"]


def _band(band: "Band", parameter: str) -> str:
    where = f"at {band.first:.6g} Hz" if band.first == band.last else f"from {band.first:.6g} to {band.last:.6g} Hz"
    worst = f"σ − 1 = {band.worst - 1:.3g}" if parameter == "S" else f"{band.worst:.6g}"
    return f"{where}, worst {worst} at {band.frequency:.6g} Hz"
