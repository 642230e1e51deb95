"""What is printed of the model of a Touchstone file, wherever it is used."""

from typing import TYPE_CHECKING, Any

from tline.units import engineering

if TYPE_CHECKING:
    from passivity import DelayedModel, MeasuredNetwork, SampledResponse


def model_as_dict(found: "DelayedModel") -> dict[str, Any]:
    """Delay, poles and verdict, and how far the model is from the samples, in SI."""
    model = found.model
    return {
        "status": found.verdict.status.value,
        "why": found.why,
        "delay": found.delay,
        "z0": float(found.samples.z0[0]),
        "poles": [[a.real, a.imag] for a in model.poles.tolist()],
        "residues": [[r.real, r.imag] for r in model.residues.tolist()],
        "constant": model.constant,
        "order": found.order,
        "error": found.error,
        "cost": found.cost,
        "samples": _band(found.samples),
    }


def network_as_dict(found: "MeasuredNetwork") -> dict[str, Any]:
    """The same of several ports: residues and constant are matrices."""
    model = found.model
    return {
        "status": found.verdict.status.value,
        "why": found.why,
        "z0": found.samples.z0.tolist(),
        "poles": [[a.real, a.imag] for a in model.poles.tolist()],
        "residues": [[[[r.real, r.imag] for r in row] for row in R] for R in model.residues.tolist()],
        "constant": model.constant.tolist(),
        "order": model.order,
        "error": found.error,
        "cost": found.cost,
        "samples": _band(found.samples),
    }


def _band(samples: "SampledResponse") -> dict[str, Any]:
    f = samples.f
    return {"number": len(f), "first": float(f[0]), "last": float(f[-1])}


def _band_in_words(samples: "SampledResponse") -> str:
    f = samples.f
    return f"({len(f)} samples, {engineering(float(f[0]), 'Hz')} to {engineering(float(f[-1]), 'Hz')})"


def _poles(order: int) -> str:
    return f"{order} pole{'s' * (order != 1)}"


def model_in_words(found: "DelayedModel") -> str:
    """The same in one line."""
    z0 = engineering(float(found.samples.z0[0]), "ohm")
    place = f"behind {engineering(found.delay, 's')} of {z0}" if found.delay else f"against {z0}"
    cost = f", of which being passive cost {found.cost:.2g}" if found.cost else ""
    return (
        f"{_poles(found.order)} {place}, {found.verdict.status.value} passive, |ΔS| up to {found.error:.2g}{cost} "
        f"{_band_in_words(found.samples)}"
    ).replace("refuted passive", "not passive")


def network_in_words(found: "MeasuredNetwork") -> str:
    """The same of several ports."""
    cost = f", of which being passive cost {found.cost:.2g}" if found.cost else ""
    return (
        f"{found.samples.ports} ports, {_poles(found.model.order)}, {found.verdict.status.value} passive, "
        f"|ΔS| up to {found.error:.2g}{cost} {_band_in_words(found.samples)}"
    )
