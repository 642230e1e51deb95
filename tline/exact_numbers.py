"""Numbers, polynomials and matrices of python-flint that can be copied and sent to other processes.

Python-flint itself lets only integers and fractions be pickled. Importing this module teaches `copyreg` the others, as
which results of `passivity` and `drives` hold them; their names are taken from here when they are loaded.
"""

import copyreg
from typing import Any

from flint import (
    acb,
    acb_mat,
    acb_poly,
    arb,
    arb_mat,
    arb_poly,
    fmpq_mat,
    fmpq_poly,
    fmpz_mat,
    fmpz_mpoly,
    fmpz_mpoly_ctx,
    fmpz_poly,
)

BITS = 30  # of a radius


def _radius_below(man: int, exp: int) -> tuple[int, int]:
    """Invert flint's rounding of a radius: return the next smaller number of as many bits."""
    shift = BITS - man.bit_length()
    man, exp = man << shift, exp - shift
    return (2 * man - 1, exp - 1) if man == 1 << (BITS - 1) else (man - 1, exp)


def ball(mid: tuple[int, int], rad: tuple[int, int]) -> arb:
    """Create a real ball with midpoint and radius man·2^exp.

    Examples
    --------
    >>> third = arb(1) / 3
    >>> same = ball(*((int(m), int(e)) for m, e in (third.mid().man_exp(), third.rad().man_exp())))
    >>> same.rad().man_exp() == third.rad().man_exp(), same.mid() == third.mid()
    (True, True)
    """
    if not rad[0]:
        return arb(mid)
    found = arb(mid, arb(_radius_below(*rad)))  # a radius is rounded up, even where it is exact
    return found if found.rad() >= arb(rad) else arb(mid, arb(rad))


def _reduce_ball(x: arb) -> tuple[Any, ...]:
    if not x.is_finite():
        return arb, (str(x),)
    mid, rad = x.mid().man_exp(), x.rad().man_exp()
    return ball, ((int(mid[0]), int(mid[1])), (int(rad[0]), int(rad[1])))


def _polynomial(values: Any, context: tuple[tuple[str, ...], Any]) -> fmpz_mpoly:
    return fmpz_mpoly_ctx.get(*context).from_dict(values)


def _context(x: fmpz_mpoly_ctx) -> tuple[tuple[str, ...], Any]:
    return x.names(), x.ordering()


def _of_coefficients(x: Any) -> tuple[Any, ...]:
    return type(x), (x.coeffs(),)


def _of_entries(x: Any) -> tuple[Any, ...]:
    return type(x), (x.nrows(), x.ncols(), x.entries())


for _kind in (fmpz_poly, fmpq_poly, arb_poly, acb_poly):
    copyreg.pickle(_kind, _of_coefficients)
for _kind in (fmpz_mat, fmpq_mat, arb_mat, acb_mat):
    copyreg.pickle(_kind, _of_entries)
copyreg.pickle(arb, _reduce_ball)
copyreg.pickle(acb, lambda x: (acb, (x.real, x.imag)))
copyreg.pickle(fmpz_mpoly_ctx, lambda x: (fmpz_mpoly_ctx.get, _context(x)))
copyreg.pickle(fmpz_mpoly, lambda x: (_polynomial, (x.to_dict(), _context(x.context()))))
