"""Cascades of lines: passive ones are proved, active ones refuted with a point that mpmath finds active."""

import json

import mpmath
import pytest

from passivity import derive, is_positive_real, verify
from passivity.verifier import check

FORMS = (
    "line({z0}, {t}*s, {load})",
    "{z0}*({load} + {z0}*tanh({t}*s))/({z0} + {load}*tanh({t}*s))",
    "{z0}*(1 + exp(-2*{t}*s)*({load} - {z0})/({load} + {z0}))/(1 - exp(-2*{t}*s)*({load} - {z0})/({load} + {z0}))",
)


def cascade(form, count, symbolic, first="Z2"):
    lets, load = [], first
    for k in range(count):
        z0, t = (f"z{k}", f"T{k}") if symbolic else (str(50 + k), f"{k + 1}/7")
        lets.append(f"let w{k} = {form.format(z0=z0, t=t, load=load)}")
        load = f"w{k}"
    names = [f"{x}{k} > 0" for k in range(count) for x in "zT"] if symbolic else []
    return "\n".join([*lets, load]), ["Z2 positive real", *names]


@pytest.mark.parametrize("symbolic", [False, True])
@pytest.mark.parametrize("form", FORMS, ids=("line", "hyperbolic", "exponential"))
def test_passive_cascades_are_proved_in_steps_linear_in_length(form, symbolic):
    counts = []
    for count in (1, 4, 7):
        found = is_positive_real(*cascade(form, count, symbolic))
        assert found.proved
        assert check(json.loads(json.dumps(found.proof))) is None
        counts.append(len(found.proof["steps"]))
    assert counts[2] - counts[1] == counts[1] - counts[0]


@pytest.mark.parametrize("first", ["(Z2 - 80)", "((s + 2)/(s^2 + s + 3) - 1)", "(Z2 - 4/(s + 1))"])
def test_active_cascades_are_refuted(first):
    found = is_positive_real(*cascade(FORMS[0], 6, False, first))
    assert found.refuted
    with mpmath.workdps(60):
        s = mpmath.mpc(*(mpmath.mpf(x.numerator) / x.denominator for x in (found.witness.re, found.witness.im)))
        z2 = found.witness.names["Z2"]
        z = eval(first.replace("^", "**"), {"s": s, "Z2": mpmath.mpf(z2.numerator) / z2.denominator})
        for k in range(6):
            z0, wave = 50 + k, mpmath.tanh(s * (k + 1) / 7)
            z = z0 * (z + z0 * wave) / (z0 + z * wave)
    assert s.real > 0 > z.real


def test_the_theorem_of_the_line_for_any_load():
    derivation = derive()
    assert [conclusion.status.value for _, conclusion in derivation.statements] == ["proved"] * 4
    assert all(holds for _, _, holds in derivation.algebra)


ACTIVE_FORMS = {
    "line": "line({z}, {t}*s, {q})",
    "hyperbolic": "({q} + {z}*tanh({t}*s))/(1 + {q}*tanh({t}*s)/{z})",
    "exponential": "{z}*(1 + exp(-2*{t}*s)*({q} - {z})/({q} + {z}))/(1 - exp(-2*{t}*s)*({q} - {z})/({q} + {z}))",
}
# end, then each line with its delay, and what stands before its far end: nothing, or so many ohm less
COVERED = {
    "20 ohm less where 50 are left": ("50", [(300, "1/10", 0), (10, "1/10", 20)]),
    "5 ohm less behind two lines": ("50", [(300, "1/10", 0), (300, "3/10", 0), (10, "7/10", 5), (75, "1/5", 0)]),
}
ACTIVE = {
    "1 ohm more than is left": ("50", [(300, "1/10", 0), (10, "1/10", 51), (25, "3/10", 0)]),
    "200 ohm less among six lines": ("100 + 1/s", [(40 + 10 * k, f"{k + 1}/10", 200 * (k == 3)) for k in range(6)]),
}
NEGATIVE = ("100 + 1/s", [(-120, "1/10", 0), (75, "7/10", 0), (50, "1/5", 0)])  # all is passive on the axis


def text_of(form, end, lines):
    lets = [f"let q0 = {end}"]
    for k, (z, t, less) in enumerate(lines):
        far = f"(q{k} - {less})" if less else f"q{k}"
        lets.append(f"let q{k + 1} = {ACTIVE_FORMS[form].format(z=f'({z})', t=t, q=far)}")
    return f"{'; '.join(lets)}; q{len(lines)}"


def value(end, lines, s):
    z = eval(end, {"s": s})
    for z0, t, less in lines:
        wave = mpmath.tanh(s * mpmath.mpf(eval(t.replace("/", ",").join(("mpmath.fdiv(", ")")), {"mpmath": mpmath})))
        z = z0 * (z - less + z0 * wave) / (z0 + (z - less) * wave)
    return z


def point(witness):
    return mpmath.mpc(*(mpmath.mpf(x.numerator) / x.denominator for x in (witness.re, witness.im)))


@pytest.mark.parametrize("form", ACTIVE_FORMS)
@pytest.mark.parametrize("case", COVERED)
def test_what_is_covered_is_proved(form, case):
    found = is_positive_real(text_of(form, *COVERED[case]))
    assert found.proved
    assert verify(found.proof)
    with mpmath.workdps(60):
        assert all(value(*COVERED[case], mpmath.mpc(1e-9, w / 7)).real > 0 for w in range(1, 100))


@pytest.mark.parametrize("form", ACTIVE_FORMS)
@pytest.mark.parametrize("case", ACTIVE)
def test_what_is_not_is_refuted(form, case):
    found = is_positive_real(text_of(form, *ACTIVE[case]))
    assert found.refuted
    with mpmath.workdps(60):
        s = point(found.witness)
        assert s.real > 0 > value(*ACTIVE[case], s).real


def test_a_pole_that_is_hardly_seen_from_the_input():
    """e^(2Ts) grows behind two lines: no frequency tells, a value below zero is found in a spot of some 1e-15."""
    found = is_positive_real(text_of("line", *NEGATIVE))
    assert found.refuted
    with mpmath.workdps(200):
        s = point(found.witness)
        assert s.real > 0 > value(*NEGATIVE, s).real
        assert all(value(*NEGATIVE, mpmath.mpc(1e-9, w / 7)).real > 0 for w in range(1, 100))


@pytest.mark.parametrize("form", ACTIVE_FORMS)
@pytest.mark.parametrize("lines", [[(120, "3/10", 0), (-120, "1/5", 0)], [(-120, "1/5", 0), (120, "3/10", 0)]])
def test_a_negative_line_undoes_as_much_of_one(form, lines):
    """A line of z0 < 0 is one of negative length: behind 3/10 one of 1/5 leaves 1/10; the other way nothing passive."""
    before, after = [(75, "1/10", 0)], [(50, "1/5", 0)]
    found = is_positive_real(text_of(form, "25 + s", before + lines + after))
    assert found.proved
    assert verify(found.proof)
    with mpmath.workdps(30):
        s, left = mpmath.mpc(3, 71) / 10, [(120, "1/10", 0)]
        whole, short = (value("25 + s", before + middle + after, s) for middle in (lines, left))
        assert abs(whole - short) < 1e-25 * abs(short)
    longer = [(z, "3/10" if z < 0 else "1/10", less) for z, _, less in lines]
    found = is_positive_real(text_of(form, "25 + s", before + longer + after))
    assert found.refuted
    with mpmath.workdps(200):
        assert point(found.witness).real > 0 > value("25 + s", before + longer + after, point(found.witness)).real


@pytest.mark.parametrize("form", ACTIVE_FORMS)
def test_a_load_that_long_lines_hide(form):
    """1 - s/9 is -7 at s = 72, where waves lose 2*72*5 nepers on their way to the input and back."""
    end, lines = "1 - s/9", [(7, "5/2", 0), (3, "1/1", 0), (2, "3/2", 0)]
    verdict = is_positive_real(text_of(form, end, lines))
    assert verdict.refuted
    with mpmath.workdps(1500):
        assert value(end, lines, point(verdict.witness)).real < 0


COUNT = 100
LONG_FORMS = {
    "line": "line({z}, {t}*s, q{k})",
    "hyperbolic": "(q{k} + {z}*tanh({t}*s))/(1 + q{k}*tanh({t}*s)/{z})",
    "exponential": "{z}*(1 + exp(-2*{t}*s)*(q{k} - {z})/(q{k} + {z}))/(1 - exp(-2*{t}*s)*(q{k} - {z})/(q{k} + {z}))",
}


def long_cascade(form, load, symbolic):
    name = (
        (lambda x, k: f"{x}{k}") if symbolic else (lambda x, k: f"{40 + 7 * (k % 5)}" if x == "z" else f"0.{k % 9 + 1}")
    )
    lets = [f"let q{k + 1} = {LONG_FORMS[form].format(z=name('z', k), t=name('T', k), k=k)}; " for k in range(COUNT)]
    assume = [f"{x}{k} > 0" for k in range(COUNT) for x in "zT"] if symbolic else []
    return f"let q0 = {load}; {''.join(lets)} q{COUNT}", assume


@pytest.mark.parametrize("load", ["25 + s", "Z2"])
@pytest.mark.parametrize("symbolic", [False, True], ids=["numbers", "symbols"])
@pytest.mark.parametrize("form", LONG_FORMS)
def test_passive(form, symbolic, load):
    text, assume = long_cascade(form, load, symbolic)
    found = is_positive_real(text, [*assume, *(["Z2 positive real"] if load == "Z2" else [])])
    assert found.proved
    assert check(json.loads(json.dumps(found.proof))) is None


@pytest.mark.parametrize("form", LONG_FORMS)
def test_active(form):
    found = is_positive_real(long_cascade(form, "-25 + s", False)[0])
    assert found.refuted
    with mpmath.workdps(60):
        s = mpmath.mpc(*(mpmath.mpf(x.numerator) / x.denominator for x in (found.witness.re, found.witness.im)))
        z = -25 + s
        for k in range(COUNT):
            z0, wave = 40 + 7 * (k % 5), mpmath.tanh(s * (k % 9 + 1) / 10)
            z = z0 * (z + z0 * wave) / (z0 + z * wave)
    assert s.real > 0 > z.real
