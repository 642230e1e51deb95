"""State spaces with exact entries: where they come from, what their inputs reach, their transfer matrix."""

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import lcm
from typing import Any, Self

from flint import fmpq, fmpq_mat, fmpq_poly, fmpz_poly, nmod_mat

from passivity.errors import ExpressionError
from passivity.polynomial.sign import UndecidedError
from passivity.rational.evaluate import Exact, exact
from passivity.rational.function import RationalFunction
from passivity.rational.matrix import RationalMatrix, check_shape, table

MAX_STATES = 400
MAX_WORK = 40_000_000_000  # states^4 bits: some seconds
MAX_VALUE_WORK = 5_000_000_000  # states^3 bits: half a minute
MAX_BITS = 10_000  # of an entry, and of the denominator common to all of a matrix
_PRIME = 2**61 - 1


@dataclass(frozen=True, eq=False)
class StateSpace:
    """x' = A x + B u, y = C x + D u, with as many outputs as inputs and exact entries.

    Parameters
    ----------
    a, b, c, d : flint.fmpq_mat
        Shapes (n, n), (n, m), (m, n), (m, m). Use `from_entries` for other numbers.
    """

    a: fmpq_mat
    b: fmpq_mat
    c: fmpq_mat
    d: fmpq_mat

    @classmethod
    def from_entries(
        cls,
        a: Iterable[Iterable[Exact]],
        b: Iterable[Iterable[Exact]],
        c: Iterable[Iterable[Exact]],
        d: Iterable[Iterable[Exact]],
    ) -> Self:
        """State space of the given entries.

        Parameters
        ----------
        a, b, c, d : iterable of iterable of int, float, Fraction, Decimal or str
            Shapes (n, n), (n, m), (m, n), (m, m), with n from 0 to MAX_STATES. A float counts as its exact binary
            value, text as the exact decimal written.

        Raises
        ------
        ExpressionError
            For other shapes, naming the matrix; or naming the entry that is not a number.

        Examples
        --------
        >>> StateSpace.from_entries([[-1]], [[1]], [[1]], [[0]]).transfer.rows[0][0] * 2
        RationalFunction.from_expression('(2)/(s + 1)')
        """
        rows = {name: table(name, given) for name, given in zip("ABCD", (a, b, c, d), strict=True)}
        check_shape("D", rows["D"])
        n, m = len(rows["A"]), len(rows["D"])
        if n > MAX_STATES:
            raise ExpressionError("A", "too many states", f"at most {MAX_STATES}", f"{n}")
        shapes = {"A": (n, n), "B": (n, m), "C": (m, n), "D": (m, m)}
        return cls(*(_matrix(name, rows[name], *shape) for name, shape in shapes.items()))

    @property
    def size(self) -> int:
        """Number of ports."""
        return self.d.nrows()

    @property
    def states(self) -> int:
        """Number of states."""
        return self.a.nrows()

    @cached_property
    def bits(self) -> int:
        """Length of the longest whole number in A, B and C, each brought to its common denominator."""
        wholes = (y.numer_denom()[0].entries() for y in (self.a, self.b, self.c))
        return max((abs(x).bit_length() for entries in wholes for x in entries), default=0)

    @cached_property
    def modes(self) -> fmpz_poly:
        """det(sI - A), with whole coefficients."""
        return self.a.charpoly().numer()

    @cached_property
    def transfer(self) -> RationalMatrix:
        """D + C (sI - A)^-1 B; modes that do not show at the ports stay as common factors.

        Raises
        ------
        UndecidedError
            If it would take more than MAX_WORK.
        """
        n, m, bits = self.states, self.size, self.bits
        if n**4 * bits > MAX_WORK:
            raise UndecidedError(f"{n} states with {bits} bits take too long; fewer would be decided")
        q, markov = self.a.charpoly(), self.markov(n)

        def entry(i: int, k: int) -> RationalFunction:
            series = fmpq_poly([x[i, k] for x in reversed(markov)]) * q
            p = fmpq_poly(series.coeffs()[n:]) + q * self.d[i, k]
            return RationalFunction(p.numer() * q.denom(), q.numer() * p.denom())

        return RationalMatrix(tuple(tuple(entry(i, k) for k in range(m)) for i in range(m)))

    def at(self, re: Fraction, im: Fraction) -> fmpq_mat | None:
        """Exact value U + jV at s = re + j im as [[U, -V], [V, U]]; None at an eigenvalue of A.

        Raises
        ------
        UndecidedError
            If it would take more than MAX_VALUE_WORK.

        Examples
        --------
        >>> StateSpace.from_entries([[0]], [[1]], [[1]], [[0]]).at(Fraction(1), Fraction(1))  # 1/s
        [ 1/2, 1/2]
        [-1/2, 1/2]
        """
        n, bits = self.states, self.bits
        if n**3 * bits > MAX_VALUE_WORK:
            raise UndecidedError(f"one exact value for {n} states with {bits} bits takes too long, too")
        w, shifted = fmpq(im.numerator, im.denominator), identity(n) * fmpq(re.numerator, re.denominator) - self.a
        try:  # (G + jw)^-1 B = (G - jw) X
            x = (shifted * shifted + identity(n) * (w * w)).solve(self.b)
        except ZeroDivisionError:
            return None
        u, v = (self.d + self.c * (shifted * x)).tolist(), (self.c * x * -w).tolist()
        upper = [[*row, *(-y for y in other)] for row, other in zip(u, v, strict=True)]
        return fmpq_mat(upper + [[*other, *row] for row, other in zip(u, v, strict=True)])

    def markov(self, number: int) -> list[fmpq_mat]:
        """C B, C A B, C A^2 B, ...: what remains of the transfer matrix without D, in powers of 1/s."""
        found, x = [], self.b
        for _ in range(number):
            found.append(self.c * x)
            x = self.a * x
        return found

    def dual(self) -> "StateSpace":
        """(A^T, C^T, B^T, D^T)."""
        return StateSpace(self.a.transpose(), self.c.transpose(), self.b.transpose(), self.d.transpose())

    def reached(self) -> tuple[fmpq_mat, "StateSpace"]:
        """V and (A1, B1, C V, D) with A V = V A1 and B = V B1: V spans the states that B reaches.

        Examples
        --------
        >>> system = StateSpace.from_entries([[-1, 0], [0, 2]], [[1], [0]], [[1, 1]], [[0]])
        >>> basis, part = system.reached()
        >>> basis.tolist(), part.a
        ([[1], [0]], [-1])
        """
        chosen = self.independent_columns()
        if len(chosen) == self.states:
            return identity(self.states), self
        krylov = _krylov(self.a, self.b)
        for some in (chosen, range(krylov.ncols())):  # all, should the prime have hidden a column
            echelon, rank = columns(krylov, some).transpose().rref()
            pivots = [next(k for k in range(self.states) if echelon[i, k]) for i in range(rank)]
            v = fmpq_mat(rank, self.states, echelon.entries()[: rank * self.states]).transpose()
            a, b = (columns(x.transpose(), pivots).transpose() for x in (self.a * v, self.b))
            if self.a * v == v * a and self.b == v * b:
                break
        return v, StateSpace(a, b, self.c * v, self.d)

    def independent_columns(self) -> list[int]:
        """Which columns of [B, A B, A^2 B, ...] are independent modulo a prime, and so at all: n if all is reached."""
        (a, _), (b, _) = self.a.numer_denom(), self.b.numer_denom()
        seen, rank = _krylov(nmod_mat(a, _PRIME), nmod_mat(b, _PRIME)).rref()
        return [next(k for k in range(seen.ncols()) if seen[i, k] != 0) for i in range(rank)]

    def krylov(self, chosen: list[int]) -> fmpq_mat:
        """Some columns of [B, A B, A^2 B, ...]."""
        return columns(_krylov(self.a, self.b), chosen)


def _krylov(a: Any, b: Any) -> Any:
    """[B, A B, A^2 B, ...] with n blocks, over Q or modulo the prime."""
    blocks, x = [], b
    for _ in range(a.nrows()):
        blocks.append(x.tolist())
        x = a * x
    entries = [c for i in range(a.nrows()) for block in blocks for c in block[i]]
    shape = a.nrows(), a.nrows() * b.ncols()
    return nmod_mat(*shape, entries, _PRIME) if isinstance(a, nmod_mat) else fmpq_mat(*shape, entries)


def identity(n: int) -> fmpq_mat:
    """The unit matrix."""
    return fmpq_mat(n, n, [int(i == k) for i in range(n) for k in range(n)])


def columns(a: fmpq_mat, chosen: Iterable[int]) -> fmpq_mat:
    """Some columns of a matrix."""
    chosen = list(chosen)
    return fmpq_mat(a.nrows(), len(chosen), [a[i, k] for i in range(a.nrows()) for k in chosen])


def _matrix(name: str, rows: list[list[Any]], height: int, width: int) -> fmpq_mat:
    if len(rows) != height or any(len(row) != width for row in rows):
        got = f"{len(rows)} rows of {sorted({len(row) for row in rows})} entries"
        raise ExpressionError(name, "wrong shape", f"{height} by {width}, to fit A and D", got)
    entries, unit = [], 1
    for i, row in enumerate(rows):
        for k, given in enumerate(row):
            x = exact(given, f"{name}[{i}][{k}]")
            unit = lcm(unit, x.denominator)
            if max(unit, abs(x.numerator)).bit_length() > MAX_BITS:
                raise ExpressionError(name, "entries too long, or too far apart", f"at most {MAX_BITS} bits")
            entries.append(fmpq(x.numerator, x.denominator))
    return fmpq_mat(height, width, entries)
