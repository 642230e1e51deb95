"""What samples showed, and the nearest passive model: in words, as plain data, and drawn."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter
from numpy.typing import NDArray

from passivity.exact.certificate import verify
from passivity.exact.report import beside_one
from passivity.sampled.check import Band, SampleVerdict, worst_values
from passivity.sampled.enforce import Enforced
from passivity.sampled.extremes import off_poles
from passivity.sampled.model import PartialFractions
from passivity.sampled.response import Parameter

_MOST_BANDS = 6  # bands that are printed
POINTS = 1500
BEYOND = 1.5  # times the highest frequency: how far models are drawn
_INK, _BAD, _BEFORE, _AFTER = "#222222", "#D55E00", "#E69F00", "#0072B2"  # Okabe and Ito
_UNITS = {Parameter.Z: "  [Ω]", Parameter.Y: "  [S]", Parameter.S: ""}


def samples_as_dict(verdict: SampleVerdict, enforced: Enforced | None = None) -> dict[str, Any]:
    """What JSON can hold of a verdict on samples and of a model."""
    response, witness = verdict.response, verdict.witness
    told: dict[str, Any] = {
        "parameter": response.parameter.value,
        "ports": response.ports,
        "z0": response.z0.tolist(),
        "status": verdict.status.value,
        "worst": verdict.worst_value,
        "worst_frequency": verdict.worst_frequency,
        "excess": verdict.worst_excess,
        "allowed": verdict.worst_bar,
        "allowed_by": "digits" if verdict.by_digits else "error",
        "bands": [band._asdict() for band in verdict.bands],
        "caveats": list(verdict.caveats),
        "grid": {"samples": len(response.f), "first": float(response.f[0]), "last": float(response.f[-1])},
    }
    if witness:
        vector = [[v.real, v.imag] for v in witness.vector]
        told["witness"] = witness._asdict() | {"vector": vector}
        told["witness"] |= {name: str(getattr(witness, name)) for name in ("value", "bar")}
    return told | ({} if enforced is None else models_as_dict(enforced))


def models_as_dict(enforced: Enforced) -> dict[str, Any]:
    """The nearest passive model, with its distance and whether its proof was verified, and the model before."""
    certificate, told = enforced.verdict.certificate, {}
    models = {"fitted": (enforced.original, enforced.misfit_before), "model": (enforced.model, enforced.misfit)}
    for (name, (model, misfit)), (worst, frequency) in zip(models.items(), enforced.worst, strict=True):
        told[name] = model.to_dict() | {"misfit": misfit._asdict(), "worst": worst}
        told[name]["worst_frequency"] = frequency if np.isfinite(frequency) else str(frequency)
    told["model"] |= {"status": enforced.status.value, "why": enforced.why, "rounds": enforced.rounds}
    told["model"] |= {"verified": certificate is not None and verify(certificate), "change": enforced.change._asdict()}
    return told


def in_lines(verdict: SampleVerdict, enforced: Enforced | None = None) -> list[str]:
    """What samples showed in words, line by line."""
    response = verdict.response
    name = {"S": "largest singular value of S", "Z": "smallest Re Z", "Y": "smallest Re Y"}[response.parameter.value]
    lines = [
        f"{len(response.f)} samples of {response.parameter.value}, {response.ports} port{'s' * (response.ports > 1)}, "
        f"{response.f[0]:.6g} to {response.f[-1]:.6g} Hz: {verdict.status.value}",
        f"  {name} = {beside_one(verdict.worst_value)} at {verdict.worst_frequency:.6g} Hz",
        *_allowed(verdict),
    ]
    lines += [f"  violated {_band(band, response.parameter)}" for band in verdict.bands[:_MOST_BANDS]]
    if len(verdict.bands) > _MOST_BANDS:
        lines.append(f"  and in {len(verdict.bands) - _MOST_BANDS} more bands")
    lines += [f"  note: {caveat}" for caveat in verdict.caveats]
    return lines + ([] if enforced is None else model_in_lines(enforced))


def model_in_lines(enforced: Enforced) -> list[str]:
    """The nearest passive model and its distance in words, line by line."""
    (before, _), (after, f) = enforced.worst
    ports, parameter = enforced.samples.ports, enforced.samples.parameter.value
    what = f"smallest {'Re ' + parameter if ports == 1 else f'eigenvalue of ({parameter} + {parameter}*)/2'}"
    what = {"S": "largest |S|" if ports == 1 else "largest singular value of S"}.get(parameter, what)
    return [
        f"nearest passive model, {enforced.model.order} poles: {enforced.status.value}",
        f"  because {enforced.why}",
        f"  {what} = {before:.6g} before, {after:.6g} after, at {f:.6g} Hz",
        f"  it misses the samples by {enforced.misfit.rms:.3g} (rms, relative), "
        f"the best fit by {enforced.misfit_before.rms:.3g}; being passive cost {enforced.change.rms:.3g}",
    ]


def _allowed(verdict: SampleVerdict) -> list[str]:
    """How far the worst sample is beyond the bound, and how far it may be off."""
    if verdict.worst_excess <= 0:
        return []
    beyond = "σ − 1" if verdict.response.parameter == "S" else "below 0 by"
    source = "digits of the file allow" if verdict.by_digits else "the error allows"
    consistent = "" if verdict.bands else ": consistent with a passive response"
    equals = " = " if beyond.startswith("σ") else " "
    at = f"{verdict.worst_frequency:.6g} Hz"
    return [f"  {beyond}{equals}{verdict.worst_excess:.2g} at {at}, {source} {verdict.worst_bar:.2g}{consistent}"]


def _band(band: Band, parameter: str) -> str:
    where = f"at {band.first:.6g} Hz" if band.first == band.last else f"from {band.first:.6g} to {band.last:.6g} Hz"
    worst = f"σ − 1 = {band.worst - 1:.3g}" if parameter == "S" else f"{band.worst:.6g}"
    return f"{where}, worst {worst} at {band.frequency:.6g} Hz"


def draw_samples(verdict: SampleVerdict, enforced: Enforced | None = None, ax: Axes | None = None) -> Any:
    """A figure: worst singular value of S or smallest eigenvalue of Z or Y against frequency, violations shaded.

    Parameters
    ----------
    verdict : SampleVerdict
        From `check_samples`.
    enforced : Enforced, optional
        Its models, before and after, are drawn to BEYOND times the highest frequency.
    ax : matplotlib Axes, optional
        Where to draw; without it a new figure.
    """
    response, f = verdict.response, verdict.response.f
    figure = Figure(figsize=(8, 4.6), dpi=150, layout="constrained")
    axes = ax if ax is not None else figure.subplots()
    for k, band in enumerate(verdict.bands):
        label = "" if k else "samples violate the bound"
        axes.axvspan(*_ends(band), facecolor=_BAD, alpha=0.3, hatch="///", edgecolor="white", linewidth=0, label=label)
    axes.errorbar(
        f, verdict.worst, verdict.bars, fmt="o", color=_INK, markersize=3.5, elinewidth=0.8, label="samples", zorder=3
    )
    if enforced is not None:
        _draw_models(axes, enforced, f)
    scattering = response.parameter is Parameter.S
    bound, (bottom, top) = float(scattering), axes.get_ylim()
    bottom, top = (bottom, max(top, 1.06)) if scattering else (min(bottom, -0.04 * top), top)
    axes.axhspan(bound, top if scattering else bottom, color=_BAD, alpha=0.12, linewidth=0, label="forbidden")
    axes.axhline(bound, color=_BAD, linewidth=1.2)
    if f[0] > 0 and f[-1] > 100 * f[0]:
        axes.set_xscale("log")
    m = response.parameter.value
    if response.ports == 1:
        name = "|S|" if scattering else f"Re {m}"
    else:
        name = "largest singular value of S" if scattering else f"smallest eigenvalue of ({m} + {m}*)/2"
    axes.set(xlabel="frequency f", ylabel=name + _UNITS[response.parameter], ylim=(bottom, top))
    axes.xaxis.set_major_formatter(EngFormatter("Hz"))
    usual = float(np.median(np.abs(verdict.worst)))
    if not scattering and top > 20 * usual > 0:  # a resonance would hide what lies near the bound
        axes.set_yscale("symlog", linthresh=usual)
    axes.grid(alpha=0.3)
    axes.legend(loc="best", fontsize=8, frameon=False)
    title = f"samples: {verdict.status.value}"
    title += "" if enforced is None else f"; model: {enforced.status.value}"
    if ax is not None:
        ax.set_title(title, loc="left")
        return ax
    figure.suptitle(title, x=0.02, ha="left", fontweight="bold")
    return figure


def draw_model(model: PartialFractions, ax: Axes | None = None) -> Any:
    """Magnitude of all entries over frequency, from below the slowest to above the fastest pole."""
    figure = Figure(figsize=(8, 4.6), dpi=150, layout="constrained")
    axes = ax if ax is not None else figure.subplots()
    sizes = np.abs(model.poles[model.poles != 0]) if np.any(model.poles) else np.ones(1)
    w = off_poles(model, np.geomspace(sizes.min() / 10, sizes.max() * 10, POINTS))
    axes.loglog(w / (2 * np.pi), np.abs(model.matrices(w)).reshape(len(w), -1), linewidth=1.7)
    axes.set(xlabel="frequency f", ylabel=f"|{model.parameter.value}|" + _UNITS[model.parameter])
    axes.xaxis.set_major_formatter(EngFormatter("Hz"))
    axes.grid(alpha=0.3)
    return figure if ax is None else ax


def _ends(band: Band) -> tuple[float, float]:
    """From halfway to the sample before to halfway to the one after."""
    before = band.first if band.before is None else (band.first + band.before) / 2
    after = band.last if band.after is None else (band.last + band.after) / 2
    return before, after


def _draw_models(axes: Axes, enforced: Enforced, f: NDArray) -> None:
    spread = np.geomspace if f[0] > 0 else np.linspace
    ends = f[0], f[-1] * BEYOND
    w = off_poles(enforced.model, 2 * np.pi * np.array([*f, *np.linspace(*ends, POINTS), *spread(*ends, POINTS)]))
    for model, color, style, name in (
        (enforced.original, _BEFORE, "--", "model as given"),
        (enforced.model, _AFTER, "-", "nearest passive model"),
    ):
        values = worst_values(model.matrices(w), model.parameter)
        axes.plot(w / (2 * np.pi), values, style, color=color, linewidth=1.7, label=name)
