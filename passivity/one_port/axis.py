"""What counts on the imaginary axis, as a polynomial in x = w^2."""

from flint import fmpz_poly

from passivity.status import Kind

_X = fmpz_poly([0, 1])


def parts(f: fmpz_poly) -> tuple[fmpz_poly, fmpz_poly]:
    """Polynomials u and v with f(jw) = u(x) + j w v(x), x = w^2.

    Examples
    --------
    >>> parts(fmpz_poly([1, 2, 3, 4]))
    ((-3)*x + 1, (-4)*x + 2)
    """
    c = f.coeffs()
    c[2::4], c[3::4] = [-a for a in c[2::4]], [-a for a in c[3::4]]
    return fmpz_poly(c[::2]), fmpz_poly(c[1::2])


def product(f: fmpz_poly, g: fmpz_poly) -> fmpz_poly:
    """Re f(jw) conj g(jw).

    Examples
    --------
    >>> product(fmpz_poly([1, 1]), fmpz_poly([1, 1]))  # |1 + jw|^2
    x + 1
    """
    (a, b), (c, d) = parts(f), parts(g)
    return a * c + _X * (b * d)


def allowance(kind: Kind, p: fmpz_poly, q: fmpz_poly) -> fmpz_poly:
    """A(x): Re p conj q of an impedance p/q, |q|^2 - |p|^2 of a reflection; must not be negative.

    Examples
    --------
    >>> allowance(Kind.PR, fmpz_poly([1, 1, 1]), fmpz_poly([4, 1, 1]))  # touches zero at x = 2
    x^2 + (-4)*x + 4
    """
    return product(p, q) if kind is Kind.PR else product(q + p, q - p)
