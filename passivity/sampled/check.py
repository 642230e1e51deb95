"""Passivity judged from samples: they can refute it, beyond their error bars; they never prove it."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from passivity.errors import ExpressionError, shorten, shown
from passivity.expression.number import beside_one
from passivity.sampled.response import LARGEST, Parameter, SampledResponse, array
from passivity.status import Decided, Status
from tline.errors import check_kind

SAMPLE_ROUNDING = 2.0**-48  # 16 units in the last place: the error bar that every sample has
_MOST_BANDS = 6  # bands that are printed


class Band(NamedTuple):
    """Neighbouring samples that all violate the bound, in Hz."""

    first: float
    last: float
    before: float | None  # the samples next to them, which do not violate it; None at an end of the data
    after: float | None
    worst: float  # value in between, and where it is
    frequency: float


class SampleWitness(NamedTuple):
    """A sample that violates the bound by more than its error bar, to be checked by hand.

    Sample and vector count as the binary numbers they are. Any matrix within the bar of the sample (spectral norm)
    violates the bound too; where the bar comes from the digits of a file, any that is printed with the same.
    """

    sample: int  # M = values[sample]
    frequency: float  # Hz
    vector: tuple[complex, ...]  # v, one number for each port
    value: Fraction  # Re(v* Z v)/v*v of Z or Y, below -bar; v*S*S v/v*v of S, above (1 + bar)^2
    bar: Fraction


@dataclass(frozen=True, eq=False)
class SampleVerdict(Decided):
    """Result of a passivity test of samples.

    Parameters
    ----------
    response : SampledResponse
        As given.
    status : Status
        `REFUTED` comes with a witness; otherwise `NO_VIOLATION` (at the samples), which is no proof.
    worst : ndarray, shape (n,)
        Largest singular value of S, or smallest eigenvalue of (Z + Z*)/2, at each frequency.
    bars : ndarray, shape (n,)
        Error bar of each: the tolerance, or that of the digits, and SAMPLE_ROUNDING times ports and size of the sample.
    by_digits : bool
        Whether the bars come from the digits of a file.
    bands : tuple of Band
        Where the samples violate the bound, in order.
    witness : SampleWitness or None
        The sample that is furthest beyond its error bar.
    """

    response: SampledResponse
    status: Status
    worst: NDArray
    bars: NDArray
    bands: tuple[Band, ...]
    witness: SampleWitness | None
    by_digits: bool = False
    picture = "passivity.sampled.picture:draw_samples"

    @property
    def why(self) -> str:
        """Worst value and its frequency, in words."""
        name = worst_name(self.response.parameter, self.response.ports)
        return f"{name} = {self.worst_value:.6g} at {self.worst_frequency:.6g} Hz, in {len(self.worst)} samples"

    def text_lines(self) -> list[str]:
        """Violations, their frequencies, and limitations of the samples, as lines of text."""
        r, scattering = self.response, self.response.parameter is Parameter.S
        lines = [
            f"{len(r.f)} samples of {r.parameter}, {r.ports} port{'s' * (r.ports > 1)}, "
            f"{r.f[0]:.6g} to {r.f[-1]:.6g} Hz: {self.status.value}",
            f"  {worst_name(r.parameter, r.ports)} = {beside_one(self.worst_value)} at {self.worst_frequency:.6g} Hz",
        ]
        if self.worst_excess > 0:
            beyond = (
                f"{'σ − 1 =' if scattering else 'below 0 by'} {self.worst_excess:.2g} at {self.worst_frequency:.6g} Hz"
            )
            source = "digits of the file allow" if self.by_digits else "the error allows"
            consistent = "" if self.bands else ": consistent with a passive response"
            lines.append(f"  {beyond}, {source} {self.worst_bar:.2g}{consistent}")
        for band in self.bands[:_MOST_BANDS]:
            single = band.first == band.last
            where = f"at {band.first:.6g} Hz" if single else f"from {band.first:.6g} to {band.last:.6g} Hz"
            worst = f"σ − 1 = {band.worst - 1:.3g}" if scattering else f"{band.worst:.6g}"
            lines.append(f"  violated {where}, worst {worst} at {band.frequency:.6g} Hz")
        if len(self.bands) > _MOST_BANDS:
            lines.append(f"  and in {len(self.bands) - _MOST_BANDS} more bands")
        return lines + [f"  note: {caveat}" for caveat in self.caveats]

    def to_dict(self) -> dict[str, Any]:
        """Verdict as plain values, without the samples."""
        r, witness = self.response, self.witness
        told: dict[str, Any] = {
            "parameter": r.parameter.value,
            "ports": r.ports,
            "z0": r.z0.tolist(),
            "status": self.status.value,
            "worst": self.worst_value,
            "worst_frequency": self.worst_frequency,
            "excess": self.worst_excess,
            "allowed": self.worst_bar,
            "allowed_by": "digits" if self.by_digits else "error",
            "bands": [band._asdict() for band in self.bands],
            "caveats": list(self.caveats),
            "grid": {"samples": len(r.f), "first": float(r.f[0]), "last": float(r.f[-1])},
        }
        if witness:
            exact = {"value": str(witness.value), "bar": str(witness.bar)}
            told["witness"] = witness._asdict() | {"vector": [[v.real, v.imag] for v in witness.vector]} | exact
        return told

    @property
    def worst_value(self) -> float:
        """The worst of `worst`: the largest singular value, or the smallest eigenvalue."""
        return float(self.worst[self._worst])

    @property
    def worst_frequency(self) -> float:
        """Frequency of the worst value, Hz."""
        return float(self.response.f[self._worst])

    @property
    def worst_excess(self) -> float:
        """Excess of the worst value over the bound: sigma - 1, or minus the eigenvalue."""
        return float(excess(self.worst, self.response.parameter)[self._worst])

    @property
    def worst_bar(self) -> float:
        """The error bar there."""
        return float(self.bars[self._worst])

    def refuse_beyond(self, tolerance: float, what: str) -> None:
        """Raise ExpressionError where S is beyond its bound by more than a model may miss it, and the digits allow."""
        beyond = excess(self.worst, self.response.parameter) - np.maximum(tolerance, self.bars)
        k = int(np.argmax(beyond))
        if beyond[k] <= 0:
            return
        value = "|S| =" if self.response.ports == 1 else "S has a singular value of"
        problem = f"{value} {self.worst[k]:.6g} at {self.response.f[k]:.6g} Hz: no passive {what} within the tolerance"
        digits = f", or {1 + self.bars[k]:.6g} by the digits of the file" if self.by_digits else ""
        expected = f"at most 1{digits}, or 'nearest' for the nearest passive model"
        raise ExpressionError("samples", problem, expected)

    @property
    def _worst(self) -> int:
        """Index of the sample furthest beyond its bar, or if none is beyond it, furthest beyond the bound."""
        beyond = excess(self.worst, self.response.parameter)
        return int(np.argmax(beyond - self.bars if self.bands else beyond))

    @property
    def caveats(self) -> tuple[str, ...]:
        """Limitations of a verdict from these samples."""
        f = self.response.f
        k = int(np.argmax(np.diff(f))) if len(f) > 1 else 0
        gap = f", the widest gap from {f[k]:.6g} to {f[k + 1]:.6g} Hz" if len(f) > 1 else ""
        below = f" below {f[0]:.6g} Hz and" if f[0] else ""
        return (
            f"nothing is known between samples{gap}, nor{below} above {f[-1]:.6g} Hz",
            "causality is not tested, and samples alone cannot: through any that keep the bound there is a passive "
            "response (boundary interpolation, Cantor and Phelps 1965); how well a stable model fits is a hint",
        )


def check_samples(response: SampledResponse, tolerance: ArrayLike | None = None) -> SampleVerdict:
    """Do samples of Z, Y or S show more energy leaving the ports than entering?

    Parameters
    ----------
    response : SampledResponse
        With n frequencies.
    tolerance : float or array_like, shape (n,), optional
        How far each sample may be from the truth, >= 0, in the unit of the samples: a bound of the spectral norm of the
        error, for one port of its modulus. If it is not given, the rounding of the printed digits, where the samples
        come from a file, else 0. Some rounding is always allowed for, see `SampleVerdict.bars`.

    Raises
    ------
    ExpressionError
        If the tolerance is negative or has another shape.

    Examples
    --------
    >>> verdict = check_samples(SampledResponse([1, 2, 3], [0.9, 1.2j, -1.0], "S"))
    >>> verdict.status, verdict.worst_value, verdict.worst_frequency
    (<Status.REFUTED: 'refuted'>, 1.2, 2.0)
    >>> check_samples(SampledResponse([1, 2, 3], [0.9, 1.2j, -1.0], "S"), tolerance=0.25).status
    <Status.NO_VIOLATION: 'no violation seen'>
    """
    check_kind("response", response, SampledResponse)
    values, parameter = response.values, response.parameter
    worst, (_, left, right) = worst_values(values, parameter), worst_first(values, parameter)
    if by_digits := tolerance is None and response.rounding is not None:
        assert response.rounding
        tolerance = np.minimum(response.rounding.reach(left[:, :, 0], right[:, :, 0]), LARGEST)
    given = array(0.0 if tolerance is None else tolerance, float, "tolerance")
    if given.shape not in ((), response.f.shape) or (given < 0).any():
        expected = f"a number >= 0, or {len(response.f)} of them"
        raise ExpressionError("tolerance", "not an error bar", expected, shorten(shown(tolerance)))
    bars = given + SAMPLE_ROUNDING * response.ports * np.sqrt((np.abs(values) ** 2).sum((1, 2)))
    beyond = excess(worst, parameter) - bars
    k = int(np.argmax(beyond))
    witness = _witness(response, k, right[k, :, 0], Fraction(float(bars[k]))) if beyond[k] > 0 else None
    status = Status.REFUTED if witness else Status.NO_VIOLATION
    return SampleVerdict(response, status, worst, bars, _bands(response, worst, beyond > 0), witness, by_digits)


def worst_name(parameter: Parameter, ports: int) -> str:
    """Name of the worst value."""
    if parameter is Parameter.S:
        return "largest |S|" if ports == 1 else "largest singular value of S"
    return f"smallest Re {parameter}" if ports == 1 else f"smallest eigenvalue of ({parameter} + {parameter}*)/2"


def worst_values(values: NDArray, parameter: Parameter) -> NDArray:
    """Largest singular value of each S, or smallest eigenvalue of each Hermitian part of Z or Y; values (n, p, p)."""
    if parameter is Parameter.S:
        return np.linalg.svd(values, compute_uv=False)[:, 0]
    return np.linalg.eigvalsh((values + values.conj().swapaxes(1, 2)) / 2)[:, 0]


def worst_first(values: NDArray, parameter: Parameter) -> tuple[NDArray, NDArray, NDArray]:
    """How far each singular value or eigenvalue is beyond the bound; its vectors, left and right, as columns."""
    if parameter is Parameter.S:
        left, sizes, right = np.linalg.svd(values)
        return sizes - 1, left, right.conj().swapaxes(1, 2)
    sizes, vectors = np.linalg.eigh((values + values.conj().swapaxes(1, 2)) / 2)
    return -sizes, vectors, vectors


def excess(worst: NDArray, parameter: Parameter) -> NDArray:
    """How far a worst value is beyond its bound; negative within."""
    return worst - 1 if parameter is Parameter.S else -worst


def _bands(response: SampledResponse, worst: NDArray, violating: NDArray) -> tuple[Band, ...]:
    f, beyond = response.f, excess(worst, response.parameter)
    edges = np.flatnonzero(np.diff(violating, prepend=False, append=False))
    bands = []
    for start, stop in edges.reshape(-1, 2):
        k = start + int(np.argmax(beyond[start:stop]))
        before = float(f[start - 1]) if start else None
        after = float(f[stop]) if stop < len(f) else None
        bands.append(Band(float(f[start]), float(f[stop - 1]), before, after, float(worst[k]), float(f[k])))
    return tuple(bands)


def _witness(response: SampledResponse, k: int, vector: NDArray[np.complex128], bar: Fraction) -> SampleWitness | None:
    """Return the k-th sample as a witness in exact arithmetic; None if it refutes nothing."""
    matrix, scattering = response.values[k], response.parameter is Parameter.S
    exact = np.vectorize(Fraction, otypes=[object])
    v = exact(np.concatenate([vector.real, vector.imag]))
    image = exact(np.block([[matrix.real, -matrix.imag], [matrix.imag, matrix.real]])) @ v
    value = (image @ image if scattering else v @ image) / (v @ v)
    if not (value > (1 + bar) ** 2 if scattering else value < -bar):
        return None
    return SampleWitness(k, float(response.f[k]), tuple(map(complex, vector)), value, bar)
