"""The value of a form at a point, as a ball that contains it."""

from fractions import Fraction

from flint import acb, ctx

from passivity.ball import of_point
from passivity.budget import spend
from passivity.delayed.form import Base, Form, Product

_MOST_BITS = 4096


def value(form: Form, s: acb) -> acb:
    """A ball with the values of the form at all points of a ball; not finite where that may hold a pole.

    Examples
    --------
    >>> from passivity.delayed.translate import of_text
    >>> value(of_text("exp(-s)*sqrt(4*s)"), acb(1))
    [0.735758882342885 +/- 5.56e-16]
    """
    return sum((_product(term, s) for term in form.terms), acb(0))


def exact_value(form: Form, re: Fraction, im: Fraction) -> acb:
    """Value at a rational point, to 60 certain bits where some thousand bits of precision give them.

    Examples
    --------
    >>> from passivity.delayed.translate import of_text
    >>> exact_value(of_text("exp(-s)"), Fraction(1), Fraction(0)).rel_accuracy_bits() >= 60
    True
    """
    bits = 128
    while True:
        # the precision is global to the process: what counts is the accuracy found, not asked for
        spend(form.size * (2_000 + bits * 20), "a value")
        with ctx.workprec(bits):
            found = value(form, of_point(re, im))
        if bits >= _MOST_BITS or all(x.rel_accuracy_bits() >= 60 or x == 0 for x in (found.real, found.imag)):
            return found
        bits *= 2


def _product(term: Product, s: acb) -> acb:
    r = term.rational
    result = r.p(s) / r.q(s)
    for base, e in term.factors:
        result *= _base(base, s) ** e
    return result


def _base(base: Base, s: acb) -> acb:
    if isinstance(base, Form):
        return value(base, s)
    return getattr(value(base.argument, s), base.name)()
