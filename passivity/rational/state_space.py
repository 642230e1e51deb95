"""State spaces with exact entries: construction, controllable part, transfer matrix."""

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import lcm
from typing import Any, Self, TypeAlias

from flint import fmpq, fmpq_mat, fmpq_poly, fmpz_poly, nmod_mat

from passivity.errors import ExpressionError
from passivity.polynomial.sign import UndecidedError
from passivity.rational.evaluate import Exact, exact
from passivity.rational.function import RationalFunction
from passivity.rational.matrix import RationalMatrix, check_shape, table
from passivity.rational.polynomial_matrix import MAX_WORK as MINORS, check_work
from passivity.status import Kind

MAX_STATES = 400
_ZERO = fmpq(0)
MAX_WORK = 40_000_000_000  # states^4 bits: some seconds
MAX_VALUE_WORK = 5_000_000_000  # states^3 bits: half a minute
MAX_BITS = 10_000  # of an entry, and of the denominator common to all of a matrix
PRIME = 2**61 - 1
Rows: TypeAlias = Iterable[Iterable[Exact]]
Parts: TypeAlias = tuple[Fraction, Fraction]  # real and imaginary part


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
        a: Rows,
        b: Rows,
        c: Rows,
        d: Rows,
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

    @classmethod
    def from_descriptor(cls, e: Rows, a: Rows, b: Rows, c: Rows, d: Rows) -> Self:
        """State space of E x' = A x + B u, y = C x + D u, as nodal analysis of a circuit writes it; exactly.

        Parameters
        ----------
        e, a, b, c, d : iterable of iterable of int, float, Fraction, Decimal or str
            E and A of shape (n, n), the rest as of `from_entries`.

        Raises
        ------
        ExpressionError
            As `from_entries`; or if the algebraic equations do not determine the states that E x' leaves free: then
            there is no function, or one that grows with s, whose inverse may have a state space.

        Examples
        --------
        >>> parallel = StateSpace.from_descriptor([[2, 0], [0, 0]], [[0, 1], [1, 3]], [[1], [0]], [[1, 0]], [[0]])
        >>> parallel.transfer.rows[0][0]  # 2 farad beside 3 ohm
        RationalFunction.from_expression('(3)/(6*s + 1)')
        """
        given = cls.from_entries(a, b, c, d)
        n, rows = given.states, table("E", e)
        reduced, _ = side_by_side([_matrix("E", rows, n, n), identity(n)], identity(n)).rref()
        pivots = [k for k in (next((k for k in range(n) if reduced[i, k]), None) for i in range(n)) if k is not None]
        rank, free = len(pivots), [k for k in range(n) if k not in pivots]
        left = columns(reduced, range(n, 2 * n))  # with which E is [1 F; 0 0], columns renumbered
        forward, backward = columns(identity(n), pivots), columns(identity(n), free)
        backward -= forward * columns(columns(reduced, free).transpose(), range(rank)).transpose()  # the kernel of E
        try:
            first, last = (columns(left.transpose(), part).transpose() for part in (range(rank), range(rank, n)))
            within = (last * given.a * backward).inv() * -1
        except ZeroDivisionError:
            expected = "algebraic equations for what E leaves open"
            raise ExpressionError("E", "no state space", expected, f"{n} states, E of rank {rank}") from None
        x = forward + backward * (within * (last * given.a * forward))
        direct = backward * (within * (last * given.b))
        return cls(
            first * given.a * x,
            first * (given.b + given.a * direct),
            given.c * x,
            given.d + given.c * direct,
        )

    @property
    def matrices(self) -> tuple[fmpq_mat, fmpq_mat, fmpq_mat, fmpq_mat]:
        """A, B, C, D."""
        return self.a, self.b, self.c, self.d

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
            If it would take more than MAX_WORK, or its minors would.
        """
        n, m, bits = self.states, self.size, self.bits
        if n**4 * bits > MAX_WORK:
            raise UndecidedError(f"{n} states with {bits} bits take too long; fewer would be decided")
        check_work(m, n, n * bits, 10 * MINORS)  # whose coefficients may be shorter than that, though
        q, markov = self.a.charpoly(), self.markov(n)

        def entry(i: int, k: int) -> RationalFunction:
            series = fmpq_poly([x[i, k] for x in reversed(markov)]) * q
            p = fmpq_poly(series.coeffs()[n:]) + q * self.d[i, k]
            return RationalFunction(p.numer() * q.denom(), q.numer() * p.denom())

        return RationalMatrix(tuple(tuple(entry(i, k) for k in range(m)) for i in range(m)))

    def check_value(self) -> None:
        """Raise UndecidedError if an exact value would take more than MAX_VALUE_WORK."""
        n, bits = self.states, self.bits
        if n**3 * bits > MAX_VALUE_WORK:
            raise UndecidedError(f"one exact value for {n} states with {bits} bits takes too long, too")

    def image(self, re: Fraction, im: Fraction, vector: Iterable[Parts]) -> tuple[Parts, ...] | None:
        """Exact value of the function times a vector, real and imaginary part of each component; None at a pole.

        Examples
        --------
        >>> one, integrator = Fraction(1), StateSpace.from_entries([[0]], [[1]], [[1]], [[0]])
        >>> integrator.image(one, one, [(one, Fraction(0))])  # 1/(1 + j)
        ((Fraction(1, 2), Fraction(-1, 2)),)
        """
        v = fmpq_mat(self.size, 2, [fmpq(x.numerator, x.denominator) for parts in vector for x in parts])
        one, w = identity(self.states), fmpq(im.numerator, im.denominator)
        shifted = one * fmpq(re.numerator, re.denominator) - self.a
        try:  # (G + jw)^-1 b = (G - jw) X
            x = (shifted * shifted + one * (w * w)).solve(self.b * v)
        except ZeroDivisionError:
            return None
        found = self.d * v + self.c * (shifted * x), self.c * x * -w
        u, w = (x.tolist() for x in found)  # of real and imaginary part of the vector
        sums = [(a[0] - b[1], b[0] + a[1]) for a, b in zip(u, w, strict=True)]
        return tuple((Fraction(int(a.p), int(a.q)), Fraction(int(b.p), int(b.q))) for a, b in sums)

    def markov(self, number: int) -> list[fmpq_mat]:
        """Return C B, C A B, C A^2 B, ...: the coefficients of the transfer matrix without D in powers of 1/s."""
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
        whole = _krylov(self.a, self.b, self.states)
        for some in (chosen, range(whole.ncols())):  # all, should the prime have hidden a column
            echelon, rank = columns(whole, some).transpose().rref()
            pivots = [next(k for k in range(self.states) if echelon[i, k]) for i in range(rank)]
            v = fmpq_mat(rank, self.states, echelon.entries()[: rank * self.states]).transpose()
            a, b = (columns(x.transpose(), pivots).transpose() for x in (self.a * v, self.b))
            if self.a * v == v * a and self.b == v * b:
                break
        return v, StateSpace(a, b, self.c * v, self.d)

    def independent_columns(self) -> list[int]:
        """Which columns of [B, A B, A^2 B, ...] are independent modulo a prime, and so at all: n if all is reached."""
        n, m = self.states, self.size
        a, b = (nmod_mat(x.numer_denom()[0], PRIME) for x in (self.a, self.b))
        blocks = -(-n // m)
        while True:
            seen, rank = _krylov(a, b, blocks).rref()
            if rank == n or blocks >= n:
                return [next(k for k in range(seen.ncols()) if seen[i, k] != 0) for i in range(rank)]
            blocks = min(2 * blocks, n)


def from_system(system: Any) -> RationalMatrix | StateSpace:
    """Network of a scipy.signal or python-control system with as many outputs as inputs, of s or of z."""
    kind = type(system).__name__
    if all(hasattr(system, name) for name in "ABCD"):
        return StateSpace.from_entries(system.A, system.B, system.C, system.D)
    if hasattr(system, "ninputs") and hasattr(system, "num"):  # python-control: tables of coefficients
        return RationalMatrix.from_rows(
            [[(p, q) for p, q in zip(*rows, strict=True)] for rows in zip(system.num, system.den, strict=True)]
        )
    if (ports := tuple(getattr(system, name, 1) for name in ("inputs", "outputs"))) != (1, 1):
        raise ExpressionError("system", "too many ports", "one input and one output", f"{ports} of {kind}")
    if hasattr(system, "gain"):
        system = system.to_tf()
    if not hasattr(system, "num"):
        raise ExpressionError("system", "no coefficients", "a scipy.signal.lti or python-control system", kind)
    return RationalMatrix(((RationalFunction.from_coefficients(system.num, system.den),),))


def _krylov(a: Any, b: Any, number: int) -> Any:
    """Return [B, A B, A^2 B, ...] with `number` blocks, over Q or modulo the prime."""
    blocks, x = [], b
    for _ in range(number):
        blocks.append(x)
        x = a * x
    return side_by_side(blocks, b)


def side_by_side(blocks: list[Any], like: Any) -> Any:
    """Matrices of one height as one, of the kind of another."""
    rows = [block.tolist() for block in blocks]
    entries = [c for i in range(like.nrows()) for block in rows for c in block[i]]
    return _like(like, sum(block.ncols() for block in blocks), entries)


def _like(a: Any, width: int, entries: list[Any]) -> Any:
    """A matrix as high as another, over the same field."""
    field = (a.modulus(),) if isinstance(a, nmod_mat) else ()
    return type(a)(a.nrows(), width, entries, *field)


def dissipation(kind: Kind, a: Any, b: Any, c: Any, d: Any, p: Any) -> Any:
    """Return L(P), the growth of the stored energy x^T P x beyond the supply: in fractions or in balls, P symmetric.

    [[A^T P + P A, P B - C^T], [B^T P - C, -D - D^T]] of impedances; else, with waves that enter and leave,
    [[A^T P + P A + C^T C, P B + C^T D], [B^T P + D^T C, D^T D - I]].
    """
    pa, pb, ct, dt = p * a, p * b, c.transpose(), d.transpose()
    loss = pa + pa.transpose()
    if kind is Kind.PR:
        cross, direct = pb - ct, (d + dt) * -1
    else:
        loss, cross, direct = loss + ct * c, pb + ct * d, dt * d - type(d)(identity(d.nrows()))
    rows = [[*x, *y] for x, y in zip(loss.tolist(), cross.tolist(), strict=True)]
    rows += [[*x, *y] for x, y in zip(cross.transpose().tolist(), direct.tolist(), strict=True)]
    return type(p)(rows)


def identity(n: int) -> fmpq_mat:
    """The unit matrix."""
    return fmpq_mat(n, n, [int(i == k) for i in range(n) for k in range(n)])


def columns(a: Any, chosen: Iterable[int]) -> Any:
    """Some columns of a matrix."""
    chosen = list(chosen)
    return _like(a, len(chosen), [a[i, k] for i in range(a.nrows()) for k in chosen])


def _matrix(name: str, rows: list[list[Any]], height: int, width: int) -> fmpq_mat:
    if len(rows) != height or any(len(row) != width for row in rows):
        got = f"{len(rows)} rows of {sorted({len(row) for row in rows})} entries"
        raise ExpressionError(name, "wrong shape", f"{height} by {width}, to fit A and D", got)
    entries, unit = [], 1
    for i, row in enumerate(rows):
        for k, given in enumerate(row):
            if isinstance(given, float) and given == 0.0:  # most are
                entries.append(_ZERO)
                continue
            x = exact(given, f"{name}[{i}][{k}]")
            unit = lcm(unit, x.denominator)
            if max(unit, abs(x.numerator)).bit_length() > MAX_BITS:
                raise ExpressionError(name, "entries too long, or too far apart", f"at most {MAX_BITS} bits")
            entries.append(fmpq(x.numerator, x.denominator))
    return fmpq_mat(height, width, entries)
