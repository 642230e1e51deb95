"""What is printed of the model of a Touchstone file, wherever it is used."""

from typing import TYPE_CHECKING, Any

from tline.units import engineering

if TYPE_CHECKING:
    from passivity.sampled.behind_delay import DelayedModel


def model_as_dict(found: "DelayedModel") -> dict[str, Any]:
    """Delay, poles and verdict, and how far the model is from the samples, in SI."""
    model, f = found.model, found.samples.f
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
        "samples": {"number": len(f), "first": float(f[0]), "last": float(f[-1])},
    }


def model_in_words(found: "DelayedModel") -> str:
    """The same in one line."""
    f, z0 = found.samples.f, engineering(float(found.samples.z0[0]), "ohm")
    poles = f"{found.order} pole{'s' * (found.order != 1)}"
    place = f"behind {engineering(found.delay, 's')} of {z0}" if found.delay else f"against {z0}"
    cost = f", of which being passive cost {found.cost:.2g}" if found.cost else ""
    return (
        f"{poles} {place}, {found.verdict.status.value} passive, |ΔS| up to {found.error:.2g}{cost} "
        f"({len(f)} samples, {engineering(float(f[0]), 'Hz')} to {engineering(float(f[-1]), 'Hz')})"
    ).replace("refuted passive", "not passive")
