"""Printed description of the model of a Touchstone file, for all commands that use it."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from tline.units import engineering

MOST_BANDS = 4

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from passivity import DelayedModel


def as_dict(found: "DelayedModel") -> dict[str, Any]:
    """Poles and verdict, and distance of the model from the samples, in SI.

    With several ports residues and constant are matrices, and there is a delay for each. The distance is the largest of
    an entry at each frequency of the file.
    """
    model, samples = found.model, found.samples
    one = samples.ports == 1
    return {
        "status": found.verdict.status.value,
        "why": found.why,
        "delay": found.delay if one else found.delay.tolist(),
        "z0": float(samples.z0[0]) if one else samples.z0.tolist(),
        "poles": _parts(model.poles),
        "residues": _parts(model.residues),
        "constant": model.constant if one else model.constant.tolist(),
        "order": found.order,
        "error": found.error,
        "cost": found.cost,
        "distance": found.distance.tolist(),
        "samples": {"number": len(samples.f), "first": float(samples.f[0]), "last": float(samples.f[-1])},
    }


def bands_in_words(found: "DelayedModel", tolerance: float) -> Iterator[str]:
    """Describe where model and samples differ by more than the tolerance, in a line for each of the worst bands."""
    import numpy as np

    f, distance = found.samples.f, found.distance
    edges = np.flatnonzero(np.diff(distance > tolerance, prepend=False, append=False)).reshape(-1, 2)
    bands = sorted(edges, key=lambda edge: -distance[slice(*edge)].max())
    for start, stop in bands[:MOST_BANDS]:
        k = start + int(distance[start:stop].argmax())
        low, high, at = (engineering(float(x), "Hz") for x in f[[start, stop - 1, k]])
        yield f"  beyond the tolerance from {low} to {high}, by up to |ΔS| = {distance[k]:.3g} at {at}"
    if len(bands) > MOST_BANDS:
        yield f"  and in {len(bands) - MOST_BANDS} more bands"


def _parts(values: "NDArray[np.complex128]") -> list[Any]:
    """Real and imaginary part of each value."""
    import numpy as np

    return np.stack([values.real, values.imag], axis=-1).tolist()
