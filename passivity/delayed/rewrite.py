"""The same function written differently: so that its parts occur once, or that a line and its end stand apart."""

from collections.abc import Iterator
from fractions import Fraction

from flint import fmpz_mpoly

from passivity.delayed.disc import UNIT, Disc
from passivity.delayed.field import Element, Field
from passivity.delayed.form import ONE, Form, Function, constant, depends_on_s, multiply, of_rational


def rewritings(form: Form) -> Iterator[Form]:
    """Other forms of the same function, the promising first."""
    if len(form.terms) == 1:
        yield from _divided(form)
    yield from _reflections(form)
    if len(form.terms) == 1:
        yield from _spread(form)
    if len(form.terms) == 2:
        yield from _conjugate(form)


def _divided(form: Form) -> Iterator[Form]:
    """S1/S2 as n + (S1 - n S2)/S2, where S1 - n S2 has fewer terms than S1."""
    (term,) = form.terms
    sums = [(base, e) for base, e in term.factors if isinstance(base, Form)]
    for above in (base for base, e in sums if e == 1):
        for below in (base for base, e in sums if e == -1):
            rest = multiply([(form, 1), (below, 1), (above, -1)])
            for leading in (t for t in above.terms if t.factors):
                partner = next((t for t in below.terms if t.factors == leading.factors), None)
                if partner is None:
                    continue
                n = (leading.rational / partner.rational).reduced()
                quotient = of_rational(n)
                remainder = above - below * quotient if n.degree == 0 else None
                if remainder is not None and len(remainder.terms) < len(above.terms):
                    yield rest * (quotient + remainder / below)


def _spread(form: Form) -> Iterator[Form]:
    """A sum in the numerator spread over the terms; one in the denominator, over the terms of the inverse."""
    (term,) = form.terms
    for base, e in term.factors:
        if isinstance(base, Form) and e in (1, -1):
            rest = multiply([(form, e), (base, -1)])
            if rest.rational is None or rest.rational.degree > 0:
                total = Form(())
                for part in base.terms:
                    total = total + rest * Form((part,))
                yield multiply([(total, e)])


def _conjugate(form: Form) -> Iterator[Form]:
    """a + b, with rational squares, as (a^2 - b^2)/(a - b)."""
    a, b = (Form((term,)) for term in form.terms)
    difference = a * a - b * b
    if difference.terms and (a * a).rational is not None and (b * b).rational is not None:
        yield difference / (a - b)


def _reflections(form: Form) -> Iterator[Form]:
    """What is rational after all; A (1 + X)/(1 - X), X divided by its delay; and 1 - 2/(1 + (1 + X)/(1 - X))."""
    field = Field(form)
    f = field.of(form)
    if (simple := field.form(f)).rational is not None:
        yield simple
    for a, y, delay in _ends(field, f):
        a_form = field.form(a)
        if not depends_on_s(a_form):
            one, moving = constant(1), multiply([(delay, 1), (field.form(y), 1)])
            yield a_form * (constant(2) / (one - moving) - one)
    g = field.cancelled(Element(f.d + f.n, f.d - f.n)) if f.d - f.n else None
    if g and any(_ends(field, g)):
        yield constant(1) - constant(2) / (constant(1) + field.form(g))


def line(form: Form) -> Iterator[tuple[tuple[Form, Form], tuple[Form, Form, Form]]]:
    """What makes a form the input impedance of a line with a load, F = A (1 + exp(-2B) Y)/(1 - exp(-2B) Y).

    A and B; and the load A (1 + Y)/(1 - Y), or its inverse if that is 0, the impedance A B of the whole line in series
    and its admittance B/A across.
    """
    field = Field(form)
    for a, y, delay in _ends(field, field.of(form)):
        (term,) = delay.terms
        ((function, _),) = term.factors
        a_form = field.form(a)
        if not depends_on_s(a_form) or not isinstance(function, Function):
            continue
        b = function.argument * constant(Fraction(-1, 2))
        load = Element(field.product(a.n, y.d + y.n), field.product(a.d, y.d - y.n))
        load = field.cancelled(load if load.d else Element(load.d, load.n))
        through = field.of(b)
        series, across = field.times(through, a), field.times(through, Element(a.d, a.n))
        yield (a_form, b), (field.form(load), field.form(series), field.form(across))


def means(form: Form) -> Iterator[tuple[Fraction, Form, Disc]]:
    """c, X and a disc, if a product is c times the mean of 1/(1 + tX) or of exp(-tX) over t from 0 to 1.

    The one is log(1 + X)/X, the other (1 - exp(-X))/X; for Re X >= 0 each value lies in the disc, and so does the mean.
    """
    for base, e in form.terms[-1].factors:
        if e != 1:
            continue
        if isinstance(base, Function) and base.name == "log":
            x, disc = base.argument - constant(1), Disc(Fraction(0), Fraction(1))
        elif isinstance(base, Form) and (found := _exponent(constant(1) - base)):
            x, disc = found, UNIT
        else:
            continue
        r = multiply([(form, 1), (x, 1), (base, -1)]).rational if x.terms else None
        if r is not None and r.degree == 0:
            yield r.numerator[0] / r.denominator[0], x, disc


def _exponent(form: Form) -> Form | None:
    """X, if the form is exp(-X)."""
    if len(form.terms) != 1 or form.terms[0].rational != ONE or len(form.terms[0].factors) != 1:
        return None
    ((base, e),) = form.terms[0].factors
    return base.argument * constant(-e) if isinstance(base, Function) and base.name == "exp" else None


def _ends(field: Field, f: Element) -> Iterator[tuple[Element, Element, Form]]:
    """For each delay z: A = F at z = 0, Y with (F - A)/(F + A) = z^k Y, and z^k."""
    for k, g in enumerate(field.generators):
        if g.name != "exp" or not depends_on_s(g.argument):
            continue
        n0, d0 = (_without(field, x, k) for x in f)
        if not n0 or not d0:
            continue
        up = field.product(f.n, d0) - field.product(n0, f.d)
        down = field.product(f.n, d0) + field.product(n0, f.d)
        if not up or not down:
            continue
        e = min(exponents[k + 1] for exponents in up.to_dict())
        y = field.cancelled(Element(up // field.gens[k] ** e, down))
        yield field.cancelled(Element(n0, d0)), y, field.power(g, e)


def _without(field: Field, f: fmpz_mpoly, k: int) -> fmpz_mpoly:
    return field.ring.from_dict({x: c for x, c in f.to_dict().items() if x[k + 1] == 0})
