"""Square matrices of exact rational functions: where they come from, their values, S from impedances and back.

S = (Z - I)(Z + I)^-1, Z = (I + S)(I - S)^-1: all flows are counted into the network, and the waves a and b are those of
ports with the same reference resistance.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, Self, TypeAlias

from flint import fmpq_mat, fmpz_poly

from passivity.errors import ExpressionError, shown
from passivity.expression.parse import parse
from passivity.expression.tree import symbols
from passivity.polynomial.roots import to_fmpq, value
from passivity.polynomial.sign import UndecidedError, coprime
from passivity.rational.evaluate import Exact, evaluate, positive
from passivity.rational.function import RationalFunction
from passivity.rational.polynomial_matrix import PolynomialMatrix, add, identity, minor_sums, scaled
from tline.errors import check_kind

MAX_PORTS = 12
MAX_DEGREE = 1000  # of the common denominator
MAX_BITS = 100_000  # of its coefficients
MAX_WORK = 5_000_000_000  # degree^2 bits, over all entries: some seconds
Entry: TypeAlias = RationalFunction | Exact | tuple[Iterable[Exact], Iterable[Exact]]


@dataclass(frozen=True, eq=False)
class RationalMatrix:
    """A square matrix of rational functions p(s)/q(s) with exact coefficients.

    Parameters
    ----------
    rows : tuple of tuple of RationalFunction
        As many as columns, from 1 to MAX_PORTS; no entry infinite. Use `from_rows` for other entries.

    Raises
    ------
    ExpressionError
        For another shape, or an infinite entry.

    Examples
    --------
    >>> z = RationalMatrix.from_rows([["R + s*L", "s*M"], ["s*M", "s*L"]], {"R": 1, "L": "2 nH", "M": "1 nH"})
    >>> z.size, str(z.rows[0][1])
    (2, '(s)/(1000000000)')
    """

    rows: tuple[tuple[RationalFunction, ...], ...]

    def __post_init__(self):
        check_shape("matrix", self.rows)
        for i, row in enumerate(self.rows, 1):
            for k, entry in enumerate(row, 1):
                check_kind(f"entry ({i}, {k})", entry, RationalFunction)
                if entry.is_infinite:
                    expected = "a function; an ideal element without impedances may have a scattering matrix"
                    raise ExpressionError(f"entry ({i}, {k})", "infinite", expected)

    @classmethod
    def from_rows(
        cls, rows: Iterable[Iterable[Entry]], parameters: Mapping[str, Exact] | None = None, variable: str = "s"
    ) -> Self:
        """Matrix of the given entries.

        Parameters
        ----------
        rows : iterable of iterable
            Each entry a `RationalFunction`, a number, an expression in ``s``, or a pair of coefficients, highest
            power first.
        parameters : mapping of str to number or text, optional
            A value for every name in the expressions but the variable, and for no other.
        variable : str
            Of the functions; see `passivity.discrete` of "z".

        Raises
        ------
        ExpressionError
            Naming the entry, counted from 1.
        """
        given = table("matrix", rows)
        check_shape("matrix", given)
        named = parameters or {}
        used: set[str] = set()
        done = tuple(
            tuple(_entry(x, named, variable, used, f"entry ({i}, {k})") for k, x in enumerate(row, 1))
            for i, row in enumerate(given, 1)
        )
        if unused := sorted(set(named) - used, key=str):
            raise ExpressionError(f"parameter {shown(unused[0])}", "not in the matrix", "only names that are in it")
        return cls(done)

    @property
    def size(self) -> int:
        """Number of ports."""
        return len(self.rows)

    @cached_property
    def fraction(self) -> tuple[PolynomialMatrix, fmpz_poly]:
        """N and d, the matrix being N/d; d has the poles of all entries, as often as the entry with most of them.

        Raises
        ------
        UndecidedError
            If it would take more than MAX_WORK.
        """
        entries = [entry for row in self.rows for entry in row]
        if sum((x.degree + 1) ** 2 * max(x.p.height_bits(), x.q.height_bits()) for x in entries) > MAX_WORK:
            raise UndecidedError("the entries are too long; shorter ones would be decided")
        reduced = [[entry if coprime(entry.p, entry.q) else entry.reduced() for entry in row] for row in self.rows]
        d = fmpz_poly([1])
        for entry in (entry for row in reduced for entry in row):
            d *= entry.q // d.gcd(entry.q)
            if d.degree() > MAX_DEGREE or d.height_bits() > MAX_BITS:
                text = f"the entries have over {MAX_DEGREE} poles or {MAX_BITS} bits in all; less would be decided"
                raise UndecidedError(text)
        return [[entry.p * (d // entry.q) for entry in row] for row in reduced], d

    def at(self, re: Fraction, im: Fraction) -> fmpq_mat | None:
        """Exact value U + jV at s = re + j im as [[U, -V], [V, U]]; None where an entry, as given, is divided by zero.

        Examples
        --------
        >>> RationalMatrix.from_rows([["s"]]).at(Fraction(1), Fraction(2))
        [1, -2]
        [2,  1]
        """
        n, d = self.fraction
        c, e = value(d, re, im)
        size = c * c + e * e
        if not size or not all(any(value(entry.q, re, im)) for row in self.rows for entry in row):
            return None
        parts = [[value(x, re, im) for x in row] for row in n]
        u = [[(a * c + b * e) / size for a, b in row] for row in parts]
        v = [[(b * c - a * e) / size for a, b in row] for row in parts]
        rows = [[*a, *(-x for x in b)] for a, b in zip(u, v, strict=True)]
        return fmpq_mat([[*map(to_fmpq, row)] for row in [*rows, *([*b, *a] for a, b in zip(u, v, strict=True))]])

    def __call__(self, s: complex) -> list[list[complex]]:
        """Evaluate at a finite `s`, entry by entry (see `RationalFunction`)."""
        return [[entry(s) for entry in row] for row in self.rows]

    def __str__(self) -> str:
        return "[" + "; ".join(", ".join(map(str, row)) for row in self.rows) + "]"


def table(name: str, rows: Any) -> list[list[Any]]:
    """Return the rows of a nested iterable as lists."""
    expected = "a sequence of rows, each a sequence of entries"
    if isinstance(rows, str) or not isinstance(rows, Iterable):
        raise ExpressionError(name, "not a matrix", expected, shown(rows, repr))
    done = []
    for row in rows:
        if isinstance(row, str) or not isinstance(row, Iterable):
            raise ExpressionError(name, "not a matrix", expected, shown(row, repr))
        done.append(list(row))
    return done


def check_shape(name: str, rows: Sequence[Sequence[object]]) -> None:
    """Raise an error unless a matrix is square and has at most MAX_PORTS ports."""
    for each in (rows, *rows) if isinstance(rows, list | tuple) else (rows,):
        check_kind(name, each, list, tuple)
    if not 0 < len(rows) <= MAX_PORTS:
        raise ExpressionError(name, "wrong number of ports", f"from 1 to {MAX_PORTS}", f"{len(rows)}")
    for k, row in enumerate(rows, 1):
        if len(row) != len(rows):
            raise ExpressionError(f"{name}, row {k}", "not square", f"{len(rows)} entries", f"{len(row)}")


def _entry(given: Any, parameters: Mapping[str, Exact], variable: str, used: set[str], where: str) -> RationalFunction:
    try:
        if isinstance(given, RationalFunction):
            return given
        if isinstance(given, str):
            names = symbols(parse(given)) & set(parameters)
            used |= names
            return evaluate(given, {name: parameters[name] for name in names}, variable)
        if not isinstance(given, Iterable):
            return RationalFunction.from_coefficients([given], [1])
        sides = list(given)
        if len(sides) != 2:
            raise ExpressionError("", "not a rational function", "numerator and denominator", f"{len(sides)} parts")
        return RationalFunction.from_coefficients(*sides)
    except ExpressionError as error:
        raise error.within(where) from None


def scattering(z: RationalMatrix, z0: Exact = 1) -> RationalMatrix:
    """Scattering matrix of a network with these impedances, all ports referred to the same resistance.

    Parameters
    ----------
    z : RationalMatrix
        Of the network.
    z0 : int, float, Fraction, Decimal or str
        Above zero.

    Raises
    ------
    ExpressionError
        If z0 is not above zero, or Z + z0 I has no inverse.

    Examples
    --------
    >>> print(scattering(RationalMatrix.from_rows([["100"]]), "50 ohm"))
    [(1)/(3)]
    """
    n, d = z.fraction
    reference = positive(z0, "z0")
    c, x = inverted(scaled(n, reference.denominator), d * reference.numerator)
    if not c:
        raise ExpressionError("Z + z0 I", "has no inverse", "a network that is not active everywhere")
    return _quotient(add(identity(z.size, c), scaled(x, -2)), c)


def impedances(s: RationalMatrix, z0: Exact = 1) -> RationalMatrix:
    """Impedances of a network with this scattering matrix; the inverse of `scattering`.

    Parameters
    ----------
    s : RationalMatrix
        Of the network.
    z0 : int, float, Fraction, Decimal or str
        Reference resistance of all ports, above zero.

    Raises
    ------
    ExpressionError
        If z0 is not above zero, or I - S has no inverse: an ideal transformer, for one, has no impedances.

    Examples
    --------
    >>> print(impedances(RationalMatrix.from_rows([["(1 - s)/(1 + s)"]])))
    [(1)/(s)]
    """
    n, d = s.fraction
    reference = positive(z0, "z0")
    c, x = inverted(scaled(n, -1), d)
    if not c:
        raise ExpressionError("I - S", "has no inverse: there are no impedances", "a network that has them")
    top = scaled(add(scaled(x, 2), identity(s.size, -c)), reference.numerator)
    return _quotient(top, c * reference.denominator)


def inverted(n: PolynomialMatrix, d: fmpz_poly) -> tuple[fmpz_poly, PolynomialMatrix]:
    """c and X, coprime, with (n/d + I)^-1 = X/c; c is zero if there is no inverse."""
    unit = d // d.content()
    sums, (adjugate, power) = minor_sums(add(n, identity(len(n), d)), unit)
    c, more = sums[-1]
    if not c:
        return c, adjugate
    x = scaled(adjugate, d * unit ** max(power - more, 0))
    c = common = c * unit ** max(more - power, 0)
    for entry in (entry for row in x for entry in row):
        common = common.gcd(entry)
    return c // common, [[entry // common for entry in row] for row in x]


def _quotient(n: PolynomialMatrix, d: fmpz_poly) -> RationalMatrix:
    return RationalMatrix(tuple(tuple(RationalFunction(x, d).reduced() for x in row) for row in n))
