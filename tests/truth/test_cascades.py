"""Cascades of lines: passive ones are proved, active ones refuted with a point that mpmath finds active."""

import json

import mpmath
import pytest

from passivity import derive, is_positive_real
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
