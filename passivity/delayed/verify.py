"""Repeats a proof by composition from its tree: knows each rule, and nothing of how the tree was found."""

from collections.abc import Callable
from fractions import Fraction
from functools import reduce
from math import inf, prod
from operator import add

from flint import acb, arb, ctx

from passivity.ball import Real, of_fraction
from passivity.delayed.disc import RIGHT, UNIT, Disc, power_of_bound
from passivity.delayed.field import Field, TooLargeError
from passivity.delayed.form import ONE, Form, Function, apply, constant, depends_on_s, multiply, of_rational
from passivity.delayed.leaf import moved
from passivity.delayed.proof import ProofStep
from passivity.delayed.value import value
from passivity.one_port.certificate import verify as verify_rational
from passivity.rational.function import RationalFunction
from passivity.status import Kind

_BITS = 256
_PLACES = ((37, 29, 17, 23), (5, 3, 0, 1), (1, 7, 9, 11))  # s = a/b + j c/d, somewhere


def verify_proof(step: ProofStep) -> bool:
    """Whether each step of a proof follows from its premises, and each leaf from its certificate.

    Examples
    --------
    >>> from passivity.delayed.translate import of_text
    >>> from passivity.delayed.prove import prove
    >>> verify_proof(prove(of_text("1/(1 + sqrt(s))"), RIGHT))
    True
    """
    with ctx.workprec(_BITS):
        try:
            return RULES[step.rule](step) and _exists(step.form) and all(map(verify_proof, step.premises))
        except TooLargeError:
            return False


def _exists(form: Form) -> bool:
    return any(value(form, acb(arb(a) / b, arb(c) / d)).is_finite() for a, b, c, d in _PLACES)


def _number(form: Form) -> Fraction | None:
    """The number that a form is written as."""
    r = form.rational
    return r.numerator[0] / r.denominator[0] if r is not None and r.degree == 0 else None


def _constant(step: ProofStep) -> bool:
    if depends_on_s(step.form):
        return False
    if (c := _number(step.form)) is not None:
        return c > 0 if isinstance(step.claim, Fraction) else step.disc.low <= c <= step.disc.high
    x = value(step.form, acb(1))
    if isinstance(step.claim, Fraction):
        return x.imag == 0 and bool(x.real > 0)
    return x.imag == 0 and bool(x.real >= of_fraction(step.disc.low) and x.real <= of_fraction(step.disc.high))


def _rational(step: ProofStep) -> bool:
    r, c = step.form.rational, step.certificate
    if r is None or c is None or c.kind is not Kind.PR or not verify_rational(c):
        return False
    s = RationalFunction.from_coefficients([1, 0], [1])
    if isinstance(step.claim, Disc):
        return step.disc.low < step.disc.high and moved(r, step.disc) == c.function
    return not r.is_zero and c.function in {1: [r], 2: [r / s, r * s]}.get(int(step.turn), [])


def _factors(step: ProofStep) -> bool:
    whole = multiply([(premise.form, 1) for premise in step.premises])
    return whole == step.form and sum(premise.turn for premise in step.premises) <= step.turn


def _sum(step: ProofStep) -> bool:
    if [premise.form for premise in step.premises] != [Form((term,)) for term in step.form.terms]:
        return False
    if isinstance(step.claim, Fraction):
        return all(premise.turn <= min(step.turn, 1) for premise in step.premises)
    discs = [premise.disc for premise in step.premises]
    return reduce(add, discs) <= step.disc


def _multiple(step: ProofStep) -> bool:
    (premise,) = step.premises
    c = _number(multiply([(step.form, 1), (premise.form, -1)]))
    return c is not None and c != 0 and premise.disc.scaled(c) == step.disc


def _inverse(step: ProofStep) -> bool:
    (premise,) = step.premises
    c = _number(multiply([(step.form, 1), (premise.form, 1)]))
    image = premise.disc.inverse()
    return c is not None and image is not None and c != 0 and image.scaled(c) == step.disc


def _pieces(step: ProofStep) -> list[tuple[ProofStep, int]] | None:
    """Each factor of a product with its premise, and the exponent."""
    if len(step.form.terms) != 1:
        return None
    term = step.form.terms[0]
    parts = [(multiply([(base, 1)]), e) for base, e in term.factors]
    if term.rational != ONE:
        parts.insert(0, (of_rational(term.rational), 1))
    if [premise.form for premise in step.premises] != [form for form, _ in parts]:
        return None
    return [(premise, e) for premise, (_, e) in zip(step.premises, parts, strict=True)]


def _moduli(step: ProofStep) -> bool:
    pieces = _pieces(step)
    return pieces is not None and prod(_modulus(p.disc, e) for p, e in pieces) <= min(-step.disc.low, step.disc.high)


def _modulus(disc: Disc, e: int) -> Real:
    image = disc if e > 0 else disc.inverse()
    return power_of_bound(image.radius, abs(e)) if image else inf


def _product(step: ProofStep) -> bool:
    pieces = _pieces(step)
    return pieces is not None and sum(abs(e) * p.turn for p, e in pieces) <= step.turn


def _square(step: ProofStep) -> bool:
    square, *turns = step.premises
    analytic = _product(ProofStep("product", step.form, Fraction(10**9), tuple(turns)))
    root = square.turn <= 2 and square.turn / 2 <= step.turn
    return analytic and root and square.form == multiply([(step.form, 2)]) and bool(value(step.form, acb(1)).real > 0)


def _half_plane(step: ProofStep) -> bool:
    (premise,) = step.premises
    if premise.form != step.form:
        return False
    if isinstance(step.claim, Disc):
        return step.claim == RIGHT and premise.turn <= 1
    nonzero = any(value(step.form, acb(arb(a) / b, arb(c) / d)) != 0 for a, b, c, d in _PLACES)
    return step.turn >= 1 and premise.within(RIGHT) and nonzero


def _root(step: ProofStep) -> bool:
    turn, *more = step.premises
    if step.form != apply("sqrt", turn.form) or turn.turn > 2:
        return False
    if isinstance(step.claim, Fraction):
        return turn.turn <= 2 * step.turn
    (premise,) = more
    above = step.disc.high == inf and step.disc.low >= 0 and step.disc.low**2 <= premise.disc.low
    below = min(-step.disc.low, step.disc.high)
    return premise.form == turn.form and (above or (below >= 0 and below**2 >= premise.disc.radius))


def _logarithm(step: ProofStep) -> bool:
    (premise,) = step.premises
    fits = step.form == apply("log", premise.form) and step.disc.high == inf
    return fits and premise.disc.low > 0 and bool(of_fraction(premise.disc.low).log() >= of_fraction(step.disc.low))


def _hyperbolic(step: ProofStep) -> bool:
    (premise,) = step.premises
    names = [step.form == apply(name, premise.form) for name in ("tanh", "coth")]
    return any(names) and premise.within(RIGHT) and step.claim == RIGHT


def _diffusion(step: ProofStep) -> bool:
    """|cosh(x + jy)|^2 = sinh^2 x + cos^2 y >= x^2 + 1 - y^2 >= 1 where |y| <= x."""
    (premise,) = step.premises
    return step.form == apply("sech", premise.form) and 2 * premise.turn <= 1 and step.claim == UNIT


def _exponential(step: ProofStep) -> bool:
    (premise,) = step.premises
    bound = min(-step.disc.low, step.disc.high)
    fits = step.form == apply("exp", premise.form) and premise.disc.high < inf
    return fits and bool(of_fraction(premise.disc.high).exp() <= of_fraction(bound))


def _power(step: ProofStep) -> bool:
    (premise,) = step.premises
    ((function, _),) = step.form.terms[0].factors
    if not isinstance(function, Function) or step.form != apply("exp", function.argument):
        return False
    c = _number(multiply([(function.argument, 1), (apply("log", premise.form), -1)]))
    return c is not None and premise.turn <= 2 and abs(c) * premise.turn <= step.turn


def _mean(step: ProofStep) -> bool:
    """The mean over t from 0 to 1 of 1/(1 + tX), in the disc on [0, 1], or of exp(-tX), in that on [-1, 1]."""
    (premise,), one = step.premises, constant(1)
    x = premise.form
    for top, low in ((apply("log", one + x), 0), (one - apply("exp", x * constant(-1)), -1)):
        c = _number(multiply([(step.form, 1), (x, 1), (top, -1)]))
        if c is not None and c != 0 and Disc(Fraction(low), Fraction(1)).scaled(c) == step.disc:
            return premise.within(RIGHT)
    return False


def _equal(step: ProofStep) -> bool:
    (premise,) = step.premises
    return step.claim == premise.claim and Field(step.form, premise.form).equal(step.form, premise.form)


def _line(step: ProofStep) -> bool:
    """W = A (1 + E Y)/(1 - E Y), E = exp(-2B), solves dW/dx = A B - (B/A) W^2 along the line, and is the load at x = 0.

    Where Re W = 0, Re dW/dx = Re A B + |W|^2 Re B/A >= 0: W stays in the closed right half plane.
    """
    if step.line is None or step.claim != RIGHT or not all(premise.within(RIGHT) for premise in step.premises):
        return False
    (a, b), (load, series, across), one = step.line, (premise.form for premise in step.premises), constant(1)
    e = apply("exp", b * constant(-2))
    ends = [(load - a) / (load + a)] if load.terms else [constant(-1), one]  # 0 stands for a short or an open end
    field = Field(step.form, a, b, e, load, series, across)
    inputs = [a * (one + e * y) / (one - e * y) for y in ends]
    line = field.equal(series, a * b) and field.equal(across, b / a)
    return line and any(field.equal(step.form, w) for w in inputs)


RULES: dict[str, Callable[[ProofStep], bool]] = {
    "constant": _constant,
    "rational": _rational,
    "factors": _factors,
    "sum": _sum,
    "multiple": _multiple,
    "inverse": _inverse,
    "moduli": _moduli,
    "product": _product,
    "square": _square,
    "half-plane": _half_plane,
    "root": _root,
    "logarithm": _logarithm,
    "hyperbolic": _hyperbolic,
    "diffusion": _diffusion,
    "exponential": _exponential,
    "power": _power,
    "mean": _mean,
    "equal": _equal,
    "line": _line,
}
