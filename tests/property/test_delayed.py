"""What always holds: verdicts agree with values, and do not depend on how expressions are written."""

import math
from fractions import Fraction

import mpmath
from hypothesis import given, settings, strategies as st

from passivity import Kind, Status, verify
from passivity.calculus.ask import ask

positive = st.fractions(Fraction(1, 20), 20, max_denominator=20).map(lambda x: f"({x})")
loads = st.builds("({0} + {1}*s + 1/({2}*s))".format, positive, positive, positive) | positive
STATUS = {Status.PROVED, Status.REFUTED, Status.UNDECIDED}
FUNCTIONS = {name: getattr(mpmath, name) for name in ("exp", "log", "sqrt", "tanh", "coth", "sinh", "cosh")}
POINTS = [complex(r * math.cos(a), r * math.sin(a)) for r in (0.03, 0.7, 3.1, 24) for a in (0.0, 0.8, 1.4, 1.56)]


def passive(parts):
    """Impedances made of impedances by rules of networks."""
    return st.one_of(
        st.builds("({0} + {1})".format, parts, parts),
        st.builds("1/({0} + {1})".format, parts, positive),
        st.builds("{0}*{1}".format, positive, parts),
        st.builds("sqrt({0})".format, parts),
        st.builds("sqrt({0}*{1})".format, parts, parts),
        st.builds("tanh({0})".format, parts),
        st.builds("log(1 + {0})".format, parts),
        st.builds("(1 + exp(-{0}))".format, parts),
        st.builds("(1 - exp(-{0})/2)".format, parts),
        st.builds("1/(1/{0} + 1/({1}))".format, parts, parts),
    )


impedances = st.recursive(loads | st.just("s"), passive, max_leaves=5)
leaves = st.sampled_from(["s", "1", "2", "1/2", "(s + 1)", "1/(s + 1)", "exp(-s)", "exp(-2*s)", "sqrt(s)", "(1 - s)"])
wild = st.recursive(
    leaves,
    lambda x: st.one_of(
        st.builds("({0} + {1})".format, x, x),
        st.builds("({0} - {1})".format, x, x),
        st.builds("{0}*{1}".format, x, x),
        st.builds("{0}/(3 + {1})".format, x, x),
        st.builds("sqrt({0})".format, x),
        st.builds("tanh({0})".format, x),
        st.builds("exp(-({0}))".format, x),
        st.builds("log({0} + 1)".format, x),
    ),
    max_leaves=6,
)


def value(text, s):
    """By mpmath, from the text; None where it has no value."""
    try:
        return eval(text, FUNCTIONS | {"s": mpmath.mpc(s)})
    except (ZeroDivisionError, ValueError, OverflowError):
        return None


def excess(kind, found):
    return -found.real if kind is Kind.PR else abs(found) - 1


@settings(max_examples=10, deadline=None)
@given(impedances)
def test_networks_are_proved(text):
    verdict = ask(text, Kind.PR)
    assert verdict.status is Status.PROVED
    assert verify(verdict.certificate)


@settings(max_examples=7, deadline=None)
@given(wild, st.sampled_from(Kind))
def test_verdicts_agree_with_values(text, kind):
    verdict = ask(text, kind)
    assert verdict.status in STATUS
    if verdict.status is Status.PROVED:
        for s in POINTS:
            found = value(text, s)
            assert found is None or excess(kind, found) <= 1e-9 * (1 + abs(found))
    elif verdict.witness:
        with mpmath.workdps(60):
            s = mpmath.mpc(*(mpmath.mpf(x.numerator) / x.denominator for x in (verdict.witness.re, verdict.witness.im)))
            found = value(text, s)
            assert s.real > 0
            assert excess(kind, found) > 0 or (s.imag == 0 and found.imag != 0)


@settings(max_examples=4, deadline=None)
@given(loads, positive, positive)
def test_lines_with_loads_in_four_writings(load, z0, delay):
    """Input impedance of a lossless line, by tanh, by cosh and sinh, by reflections, and their reflection."""
    x, h2 = f"({delay})*s", f"(({load}) - {z0})/(({load}) + {z0})"
    writings = [
        f"{z0}*({load} + {z0}*tanh({x}))/({z0} + {load}*tanh({x}))",
        f"({load}*cosh({x}) + {z0}*sinh({x}))/(cosh({x}) + {load}/{z0}*sinh({x}))",
        f"{z0}*(1 + exp(-2*{x})*{h2})/(1 - exp(-2*{x})*{h2})",
    ]
    assert {ask(text, Kind.PR).status for text in writings} == {Status.PROVED}
    z = writings[0]
    assert ask(f"({z} - {z0})/({z} + {z0})", Kind.BR).status is Status.PROVED


@settings(max_examples=4, deadline=None)
@given(positive, positive, positive, positive, loads, positive)
def test_lossy_lines_with_loads(r, x, g, c, load, length):
    a, b = f"sqrt(({r} + {x}*s)/({g} + {c}*s))", f"{length}*sqrt(({r} + {x}*s)*({g} + {c}*s))"
    verdict = ask(f"{a}*({load} + {a}*tanh({b}))/({a} + {load}*tanh({b}))", Kind.PR)
    assert verdict.status is Status.PROVED
    assert verify(verdict.proof)


@settings(max_examples=6, deadline=None)
@given(st.integers(-300, 300), st.fractions(Fraction(1, 20), 50, max_denominator=20), st.integers(-9, 9))
def test_scales_do_not_matter(k, delay, decade):
    """H2 = k/100/(1 + s) through a line: passive for |k| <= 100, in whatever unit of time."""
    unit = Fraction(10) ** decade
    text = f"({k})/100/(1 + s*({unit}))*exp(-({delay * unit})*s)"
    for expression, kind in ((text, Kind.BR), (f"(1 - {text})/(1 + {text})", Kind.PR)):
        verdict = ask(expression, kind)
        assert verdict.status is (Status.PROVED if abs(k) <= 100 else Status.REFUTED)
        assert verdict.proof is None or verify(verdict.proof)
