"""A hundred lines in a row, in three writings: proved with any passive load, refuted with an active one by mpmath."""

import json

import mpmath
import pytest

from passivity import is_positive_real
from passivity.verifier import check

COUNT = 100
FORMS = {
    "line": "line({z}, {t}*s, q{k})",
    "hyperbolic": "(q{k} + {z}*tanh({t}*s))/(1 + q{k}*tanh({t}*s)/{z})",
    "exponential": "{z}*(1 + exp(-2*{t}*s)*(q{k} - {z})/(q{k} + {z}))/(1 - exp(-2*{t}*s)*(q{k} - {z})/(q{k} + {z}))",
}


def cascade(form, load, symbolic):
    name = (
        (lambda x, k: f"{x}{k}") if symbolic else (lambda x, k: f"{40 + 7 * (k % 5)}" if x == "z" else f"0.{k % 9 + 1}")
    )
    lets = [f"let q{k + 1} = {FORMS[form].format(z=name('z', k), t=name('T', k), k=k)}; " for k in range(COUNT)]
    assume = [f"{x}{k} > 0" for k in range(COUNT) for x in "zT"] if symbolic else []
    return f"let q0 = {load}; {''.join(lets)} q{COUNT}", assume


@pytest.mark.parametrize("load", ["25 + s", "Z2"])
@pytest.mark.parametrize("symbolic", [False, True], ids=["numbers", "symbols"])
@pytest.mark.parametrize("form", FORMS)
def test_passive(form, symbolic, load):
    text, assume = cascade(form, load, symbolic)
    found = is_positive_real(text, [*assume, *(["Z2 positive real"] if load == "Z2" else [])])
    assert found.proved
    assert check(json.loads(json.dumps(found.proof))) is None


@pytest.mark.parametrize("form", FORMS)
def test_active(form):
    found = is_positive_real(cascade(form, "-25 + s", False)[0])
    assert found.refuted
    with mpmath.workdps(60):
        s = mpmath.mpc(*(mpmath.mpf(x.numerator) / x.denominator for x in (found.witness.re, found.witness.im)))
        z = -25 + s
        for k in range(COUNT):
            z0, wave = 40 + 7 * (k % 5), mpmath.tanh(s * (k % 9 + 1) / 10)
            z = z0 * (z + z0 * wave) / (z0 + z * wave)
    assert s.real > 0 > z.real
