"""Positive roots of integer polynomials, each in an interval of its own, as narrow as wanted."""

from itertools import pairwise
from typing import NamedTuple

from flint import arb, arb_poly, ctx, fmpq, fmpz_poly

from passivity.budget import spend
from passivity.one_port.polynomial_sign import MAX_PIECES, UndecidedError, half_line, split


class Root(NamedTuple):
    """The only root of `f` between `low` and `high`, or both; f changes its sign there, upwards if `rising`."""

    f: fmpz_poly
    low: fmpq
    high: fmpq
    rising: bool

    def refined(self, bits: int) -> "Root":
        """The same root within a relative width of 2^-bits, found exactly if it is met on the way.

        Examples
        --------
        >>> root = Root(fmpz_poly([-2, 0, 1]), fmpq(0), fmpq(4), True).refined(20)
        >>> root.low, root.high
        (741455/524288, 1482911/1048576)
        """
        f, low, high, rising = self
        working = 2 * bits + 2 * f.degree()
        with ctx.workprec(working):
            rounded = arb_poly(f)
        while low < high and (low == 0 or (high - low) * 2**bits > low):
            middle = (low + high) / 2
            spend(1000 + len(f) * (100 + working // 10), f"a root of a polynomial of degree {f.degree()}")
            with ctx.workprec(working):
                value: arb | fmpq = rounded(arb(middle))
            if value.contains(0):
                exactly = len(f) * (f.height_bits() + len(f) * middle.height_bits())
                spend(exactly, f"a root of a polynomial of degree {f.degree()}")
                value = f(middle)
            if value == 0:
                low = high = middle
            elif (value > 0) == rising:
                high = middle
            else:
                low = middle
        return Root(f, low, high, rising)

    def sign_of(self, g: fmpz_poly) -> int:
        """Sign of another polynomial at the root, which must not be a root of both.

        Examples
        --------
        >>> Root(fmpz_poly([-2, 0, 1]), fmpq(0), fmpq(4), True).sign_of(fmpz_poly([-3, 2]))  # 2 sqrt(2) - 3
        -1
        """
        root, bits = self, 40
        while True:
            root = root.refined(bits)
            with ctx.workprec(4 * bits + g.height_bits()):
                value = g(arb(root.low).union(arb(root.high)))
            if value > 0 or value < 0:
                return 1 if value > 0 else -1
            bits *= 2

    def __float__(self) -> float:
        return float(arb(self._near()))

    @property
    def frequency(self) -> float:
        """Square root of the root, which may be beyond the doubles."""
        return sqrt(self._near())

    def _near(self) -> fmpq:
        root = self.refined(60)
        return (root.low + root.high) / 2


def sqrt(x: fmpq) -> float:
    """Square root of x >= 0, which may be beyond the doubles.

    Examples
    --------
    >>> sqrt(fmpq(10) ** 400)
    1e+200
    """
    with ctx.workprec(100):
        return float(arb(x).sqrt())


def positive_roots(f: fmpz_poly) -> list[Root]:
    """All positive roots, increasing.

    Parameters
    ----------
    f : fmpz_poly
        Without double roots, f(0) not zero.

    Examples
    --------
    >>> [(root.low, root.high) for root in positive_roots(fmpz_poly([-3, 4, -1]))]  # (x - 1)(3 - x)
    [(1, 1), (1, 16)]
    """
    pieces, found = [half_line(f)], []
    while pieces:
        piece = pieces.pop()
        if piece.f[0] == 0:  # the cut is a root
            cut = fmpq(*piece.left)
            found.append(Root(f, cut, cut, bool(piece.f[1] > 0)))
            piece = piece._replace(f=piece.f.right_shift(1))
        c = [x for x in piece.f.coeffs() if x]
        changes = sum((a > 0) != (b > 0) for a, b in pairwise(c))
        if changes == 1:
            high = fmpq(*piece.right) if piece.right[1] else _bound(f)
            found.append(Root(f, fmpq(*piece.left), high, bool(c[-1] > 0)))
        elif changes:
            if len(pieces) + len(found) > MAX_PIECES:
                raise UndecidedError(f"the roots of a polynomial of degree {f.degree()} take over {MAX_PIECES} pieces")
            pieces += reversed(split(piece))
    return found


def _bound(f: fmpz_poly) -> fmpq:
    """A power of two above all roots (Cauchy's bound)."""
    return fmpq(2) ** (f.height_bits() - f.leading_coefficient().bit_length() + 2)
