"""What is printed of the model of a Touchstone file, wherever it is used."""

from typing import TYPE_CHECKING, Any

from tline.units import engineering

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from passivity import DelayedModel


def as_dict(found: "DelayedModel") -> dict[str, Any]:
    """Poles and verdict, and how far the model is from the samples, in SI.

    With one port also its delay; with several, residues and constant are matrices.
    """
    model, samples = found.model, found.samples
    one = samples.ports == 1
    return {
        "status": found.verdict.status.value,
        "why": found.why,
        **({"delay": found.delay} if one else {}),
        "z0": float(samples.z0[0]) if one else samples.z0.tolist(),
        "poles": _parts(model.poles),
        "residues": _parts(model.residues),
        "constant": model.constant if one else model.constant.tolist(),
        "order": found.order,
        "error": found.error,
        "cost": found.cost,
        "samples": {"number": len(samples.f), "first": float(samples.f[0]), "last": float(samples.f[-1])},
    }


def in_words(found: "DelayedModel") -> str:
    """Poles, verdict and distance from the samples in one line."""
    samples, order = found.samples, found.order
    one = samples.ports == 1
    poles = f"{order} pole{'s' * (order != 1)}"
    if one:
        z0 = engineering(float(samples.z0[0]), "ohm")
        place = f"behind {engineering(found.delay, 's')} of {z0}" if found.delay else f"against {z0}"
        told = f"{poles} {place}, {found.verdict.status.value} passive".replace("refuted passive", "not passive")
    else:
        told = f"{samples.ports} ports, {poles}, {found.verdict.status.value} passive"
    cost = f", of which being passive cost {found.cost:.2g}" if found.cost else ""
    first, last = (engineering(float(f), "Hz") for f in samples.f[[0, -1]])
    return f"{told}, |ΔS| up to {found.error:.2g}{cost} ({len(samples.f)} samples, {first} to {last})"


def _parts(values: "NDArray[np.complex128]") -> list[Any]:
    """Real and imaginary part of each."""
    import numpy as np

    return np.stack([values.real, values.imag], axis=-1).tolist()
