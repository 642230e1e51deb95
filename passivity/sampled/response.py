"""Response given by samples on the imaginary axis, and the rounding of the digits of its file.

Each number is known to half a unit in the last place that is printed, or would be with the zeros at its end. An entry
of a matrix lies in a rectangle around its value, along and across a direction: the real axis for real and imaginary
part, the entry's own for modulus and angle. With the singular vectors u, v of S the largest singular value of S + E
is at least |u* (S + E) v| >= sigma - |Re u* E v|, and with the eigenvector v the smallest eigenvalue of the Hermitian
part of Z + E is at most that of Z plus Re v* E v. So nothing that is printed the same is missed.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from passivity.errors import ExpressionError, shorten, shown
from passivity.status import Kind

LARGEST = 1e150
MAX_PORTS = 16
ENOUGH = 100  # fractions, of which one in ten ends in 0 if zeros are kept
MAX_NUMBERS = 1_000_000  # complex numbers in all samples together
MAX_SAMPLES = 20_000  # of a response to which a model is fitted


def half_unit(text: str) -> float:
    """Half a unit in the last place of a number as it is written."""
    mantissa, _, exponent = text.lower().partition("e")
    return min(float(f"5e{int(exponent or 0) - len(mantissa.partition('.')[2]) - 1}"), LARGEST)


def half_units(rows: Sequence[Sequence[str]]) -> NDArray:
    """Half units in the last places of numbers as they are written, where the writer may have dropped zeros at the end.

    It has if none of many fractions ends in 0. Each number then has as many decimals as any in its row, or as many
    digits as any, whichever is coarser for it.
    """
    halves = np.array([[half_unit(x) for x in row] for row in rows])
    written = (x.lower().partition("e")[0].lstrip("+-0") for row in rows for x in row)
    several = 0
    for mantissa in written:
        if len(mantissa.partition(".")[2]) > 1:
            if mantissa.endswith("0"):
                return halves
            several += 1
    if several < ENOUGH:
        return halves
    size = np.abs(np.array(rows, float))
    digits = [max(len(x.lower().partition("e")[0].replace(".", "").lstrip("+-0")) for x in row) for row in rows]
    last = np.floor(np.log10(size, out=np.full(size.shape, -np.inf), where=size > 0)) + 1 - np.array(digits)[:, None]
    return np.minimum(halves, np.maximum(halves.min(axis=1, keepdims=True), 0.5 * 10.0**last))


@dataclass(frozen=True, eq=False)
class Rounding:
    """Rectangles in which the entries of matrices lie, all arrays of shape (n, p, p)."""

    direction: NDArray[np.complex128]  # of modulus 1
    along: NDArray  # half the sides, along and across the direction
    across: NDArray
    left: NDArray[np.complex128] | None = None  # L and R, where matrices change by L E R with what is printed
    right: NDArray[np.complex128] | None = None
    second: NDArray | float = 0.0  # bound of the remainder, shape (n,)

    def transposed(self) -> Self:
        """Rounding of the transposed matrices."""
        return type(self)(*(x.swapaxes(1, 2) for x in (self.direction, self.along, self.across)))

    def through(self, left: NDArray, right: NDArray, second: NDArray | float = 0.0) -> Self:
        """Rounding of matrices that change by L E R, and at most `second` beside that, where these change by E."""
        if self.left is None or self.right is None:
            return replace(self, left=left, right=right, second=self.second + second)
        grown = np.linalg.norm(left, axis=(1, 2)) * np.linalg.norm(right, axis=(1, 2))
        return replace(self, left=left @ self.left, right=self.right @ right, second=self.second * grown + second)

    def through_cayley(self, matrices: NDArray[np.complex128]) -> Self:
        """Rounding of S = +-(1 - 2 M), M = (1 + z)^-1, for normalised z of these values.

        S' - S = +-2 M E M' with E = z' - z, which is 2 M E M but for 2 M E M E M'; there M' is bounded by Neumann's
        series.
        """
        one = np.eye(matrices.shape[1])
        inverse = np.linalg.inv(one + matrices)
        before, after = (one if x is None else x for x in (self.left, self.right))
        grown = np.abs(inverse @ before) @ np.hypot(self.along, self.across) @ np.abs(after)
        safe = np.linalg.norm(grown, axis=(1, 2)) < 0.5
        grown = np.where(safe[:, None, None], grown, 0.0)
        second = 2 * np.linalg.norm(grown @ grown @ np.linalg.inv(one - grown) @ np.abs(inverse), axis=(1, 2))
        return self.through(2 * inverse, inverse, np.where(safe, second, LARGEST))

    def reach(self, left: NDArray, right: NDArray) -> NDArray:
        """Bound of |Re u* E v| for vectors u, v at each frequency, shape (n, p); returns shape (n,)."""
        if self.left is not None and self.right is not None:
            left = np.einsum("nki,nk->ni", self.left.conj(), left)
            right = np.einsum("nik,nk->ni", self.right, right)
        weights = left.conj()[:, :, None] * right[:, None, :] * self.direction
        first = (np.abs(weights.real) * self.along + np.abs(weights.imag) * self.across).sum((1, 2))
        return first + self.second


@np.errstate(over="ignore", invalid="ignore")  # numbers that are refused afterwards
def of_tokens(form: str, rows: Sequence[Sequence[str]], ports: int) -> tuple[Rounding, NDArray[np.complex128]]:
    """Rounding and values of rows of 2 ports^2 numbers as they are written, first index slowest.

    The form is ``ri`` for real and imaginary part, ``ma`` for modulus and angle in degrees, or ``db`` for decibels.
    """
    shape = len(rows), ports, ports, 2
    numbers = np.array([[float(x) for x in row] for row in rows]).reshape(shape)
    halves = half_units(rows).reshape(shape)
    (first, second), (one, two) = np.moveaxis(numbers, 3, 0), np.moveaxis(halves, 3, 0)
    if form == "ri":
        return Rounding(np.ones_like(first, dtype=complex), one, two), first + 1j * second
    size = np.abs(first) if form == "ma" else 10 ** (first / 20)
    held = np.minimum(size, LARGEST)
    radial = np.minimum(one if form == "ma" else held * np.expm1(one * np.log(10) / 20), LARGEST)
    direction = np.exp(1j * np.radians(second)) * np.where((form == "ma") & (first < 0), -1, 1)
    turn = np.minimum(np.radians(two), np.pi)
    top = held + radial
    across = top * np.sin(np.minimum(turn, np.pi / 2))
    return Rounding(direction, radial + top * (1 - np.cos(turn)), across), np.asarray(size * direction, complex)


class Parameter(StrEnum):
    """Quantity that is sampled."""

    S = "S"  # scattering matrix or reflection
    Z = "Z"  # impedance
    Y = "Y"  # admittance

    @classmethod
    def _missing_(cls, value: object):
        raise ExpressionError("parameter", "not known", "Z, Y or S", shown(value, repr))

    @property
    def kind(self) -> Kind:
        """Property required of a passive response."""
        return Kind.BR if self is Parameter.S else Kind.PR


@dataclass(frozen=True, eq=False)
class SampledResponse:
    """Z, Y or S of a system with p ports at n frequencies; signals vary as exp(+j 2 pi f t).

    Parameters
    ----------
    f : array_like, shape (n,)
        Frequencies in hertz, increasing, >= 0.
    values : array_like of complex, shape (n,) for one port or (n, p, p)
        Kept as (n, p, p). Z in ohm, Y in siemens; S in power waves.
    parameter : Parameter or str
        "Z", "Y" or "S".
    z0 : float or array_like, shape (p,)
        Reference resistances of S, above zero, ohm; kept as (p,). Without effect on Z and Y.
    rounding : Rounding, optional
        Rounding of the printed digits, where the values were read from text.

    Raises
    ------
    ExpressionError
        Names the fault: shapes, order, numbers that are not finite, more than MAX_PORTS or MAX_NUMBERS.

    Examples
    --------
    >>> response = SampledResponse([1e6, 2e6], [50 + 1j, 50 + 2j], "Z")
    >>> response.values.shape
    (2, 1, 1)
    """

    f: Any
    values: Any
    parameter: Any
    z0: Any = 50.0
    rounding: Rounding | None = None

    def __post_init__(self):
        parameter = Parameter(self.parameter)
        f, values = array(self.f, float, "f"), array(self.values, complex, "values")
        if f.ndim != 1 or not len(f):
            raise ExpressionError("f", "not a list of frequencies", "shape (n,), n > 0", f"{f.shape}")
        if values.ndim == 1:
            values = values[:, None, None]
        if values.ndim != 3 or len(values) != len(f) or values.shape[1] != values.shape[2]:
            expected = f"shape ({len(f)},) or ({len(f)}, p, p)"
            raise ExpressionError(
                "values", "not one number or square matrix for each frequency", expected, f"{values.shape}"
            )
        if not 0 < values.shape[1] <= MAX_PORTS or values.size > MAX_NUMBERS:
            expected = f"1 to {MAX_PORTS} ports and at most {MAX_NUMBERS} numbers"
            raise ExpressionError("values", "too few or too many", expected, f"{values.shape}")
        if f[0] < 0 or (np.diff(f) <= 0).any():
            k = int(np.argmax(np.diff(f, prepend=-0.5 if f[0] >= 0 else 0.0) <= 0))
            raise ExpressionError(f"f[{k}]", "out of order", "increasing frequencies >= 0", f"{f[k]:.6g}")
        z0 = array(self.z0, float, "z0")
        if z0.ndim > 1 or z0.size not in (1, values.shape[1]) or (z0 <= 0).any():
            raise ExpressionError(
                "z0", "not a reference resistance", "a number > 0, or one for each port", shorten(shown(self.z0))
            )
        z0 = np.broadcast_to(z0, (values.shape[1],))
        for name, value in (("f", f), ("values", values), ("parameter", parameter), ("z0", z0)):
            object.__setattr__(self, name, value)

    @property
    def ports(self) -> int:
        """Number of ports."""
        return self.values.shape[1]

    @classmethod
    def from_network(cls, network: Any) -> Self:
        """S of a network of scikit-rf, where networks are cascaded, de-embedded and renormalised.

        Raises
        ------
        ExpressionError
            References that are complex or change with the frequency.
        """
        references: NDArray[np.complex128] = np.asarray(network.z0, complex)
        if (references != references[0]).any() or references.imag.any():
            expected = "resistances that do not change with the frequency; renormalize() changes them"
            raise ExpressionError("z0", "not such reference impedances", expected)
        return cls(network.f, network.s, "S", references[0].real)

    def network(self, name: str = "") -> Any:
        """The samples as a network of scikit-rf (`pip install scikit-rf`).

        Examples
        --------
        >>> half = SampledResponse([1e9, 2e9], [[[0, -0.8j], [-0.8j, 0]]] * 2, "S")
        >>> whole = SampledResponse.from_network(half.network() ** half.network())
        >>> whole.values[0, 1, 0].round(9).item()
        (-0.64+0j)
        """
        from skrf import Network

        return Network(f=self.f, f_unit="Hz", z0=self.z0, name=name, **{self.parameter.value.lower(): self.values})

    def between(self, groups: Sequence[Sequence[int]], where: str = "ports") -> Self:
        """S between single ports, and between the differential modes of pairs, then between the common ones of these.

        Parameters
        ----------
        groups : sequence of sequences of int
            Numbers of one port or of two with the same reference, from 0 on; ports in no group are matched.
        where : str
            Name of the groups, or of the file, in errors.

        Raises
        ------
        ExpressionError
            A port that does not exist or occurs twice, or unlike references.

        References
        ----------
        D. E. Bockelman, W. R. Eisenstadt, "Combined differential and common-mode scattering parameters", IEEE
        Transactions on Microwave Theory and Techniques 43 (1995), 1530-1539, DOI 10.1109/22.392911.
        """
        ports = [port for group in groups for port in group]
        if len({*ports} & {*range(self.ports)}) < len(ports) or not {*map(len, groups)} <= {1, 2}:
            told = " ".join(",".join(f"{port + 1}" for port in group) for group in groups)
            raise ExpressionError(where, "not single ports and pairs", f"of 1 to {self.ports}, each once", told)
        pairs = [group for group in groups if len(group) == 2]
        for a, b in pairs:
            if self.z0[a] != self.z0[b]:
                got = f"{self.z0[a]:g} and {self.z0[b]:g} ohm"
                raise ExpressionError(where, f"unlike references of {a + 1} and {b + 1}", "a pair of like ones", got)
        one, signs = np.eye(self.ports), [-1] * len(groups) + [1] * len(pairs)
        rows = [(one[g[0]] + s * one[g[-1]]) / np.sqrt(2) if len(g) == 2 else one[g[0]]
                for g, s in zip([*groups, *pairs], signs, strict=True)]  # fmt: skip
        factors = [2.0 if len(g) == 2 else 1.0 for g in groups] + [0.5] * len(pairs)
        M, z0 = np.array(rows), [k * self.z0[g[0]] for k, g in zip(factors, [*groups, *pairs], strict=True)]
        return type(self)(self.f, M @ self.values @ M.T, self.parameter, z0)

    def touchstone(self) -> str:
        """Text of a Touchstone file of version 1, from which `read_touchstone` has the same numbers; Z and Y as such.

        Raises
        ------
        ExpressionError
            For S of ports with different reference resistances.
        """
        z0 = float(self.z0[0]) if self.parameter is Parameter.S else 1.0
        if self.parameter is Parameter.S and (self.z0 != z0).any():
            raise ExpressionError("z0", "different reference resistances", "one for all ports", f"{self.z0}")
        lines = [f"# Hz {self.parameter.value} RI R {z0!r}"]
        for f, matrix in zip(self.f.tolist(), self.values, strict=True):
            rows = [matrix.T.ravel()]
            if self.ports > 2:
                rows = [part for row in matrix for part in np.split(row, range(4, self.ports, 4))]
            written = [" ".join(f"{x.real!r} {x.imag!r}" for x in row.tolist()) for row in rows]
            lines += [f"{f!r} {written[0]}", *written[1:]]
        return "\n".join(lines) + "\n"


def array(given: ArrayLike, kind: type, name: str) -> NDArray:
    """Copy to a read-only array of finite numbers; `name` appears in the error."""
    try:
        if kind is float and np.iscomplexobj(given):
            raise TypeError
        found = np.array(given, dtype=kind)
    except (TypeError, ValueError, OverflowError):
        raise ExpressionError(
            name, "not an array of numbers", f"{'real' if kind is float else 'complex'} numbers", type(given).__name__
        ) from None
    good = np.abs(found) <= LARGEST
    if not good.all():
        place = name + "".join(f"[{k}]" for k in np.unravel_index(np.argmin(good), found.shape))
        raise ExpressionError(place, "not a number of reasonable size", f"at most {LARGEST:g}", f"{found[~good][0]:g}")
    found.flags.writeable = False
    return found
