"""Whatever the parameters: laws and their circuits are passive, and lines behave like lines."""

import math

import numpy as np
from hypothesis import given, settings, strategies as st

from passivity import Status
from passivity.exact.certificate import verify
from tline.loss import (
    ChangingLaminarFriction,
    ConstantLoss,
    DielectricLoss,
    Foster,
    LaminarFriction,
    LossyLine,
    RoundWire,
    SkinEffect,
    TurbulentFriction,
    kelvin_voigt_wall,
    realise,
    tabulated,
)


def decades(low, high):
    return st.floats(low, high).map(lambda x: 10.0**x)


FLUID = {"density": decades(2.5, 3.2), "viscosity": decades(-4, 0), "radius": decades(-3, 0)}
SERIES = st.one_of(
    st.builds(ConstantLoss, decades(-3, 3), decades(-9, 6)),
    st.builds(SkinEffect, st.just(0.0) | decades(-3, 2), decades(-6, 0)),
    st.builds(RoundWire, decades(-5, -2), decades(5, 8)),
    st.builds(LaminarFriction, **FLUID),
    st.builds(ChangingLaminarFriction, **FLUID),
    st.builds(TurbulentFriction, **FLUID, reynolds=decades(3.4, 7.9)),
)
SHUNT = st.one_of(
    st.builds(ConstantLoss, decades(-12, -6), decades(-12, -9)),
    st.builds(DielectricLoss, decades(-12, -9), decades(-4, -2), decades(7, 10), st.just((1e4, 1e12))),
    st.builds(
        kelvin_voigt_wall,
        decades(-12, -9),
        decades(-2, 0),
        decades(-3, -1),
        st.lists(st.tuples(decades(-11, -9), decades(-3, 1)), min_size=1, max_size=4),
    ),
)
ANGLE = st.floats(0, 0.99 * math.pi)


@settings(max_examples=15, deadline=None)
@given(law=SERIES | SHUNT, low=decades(-2, 7), span=decades(0.3, 5), tolerance=decades(-6, -1))
def test_every_realisation_is_proved_positive_real_and_within_its_tolerance(law, low, span, tolerance):
    found = realise(law, (low, low * span), tolerance)
    assert found.error <= tolerance
    assert (found.circuit.strengths > 0).all()
    assert (found.circuit.rates > 0).all()
    assert (found.circuit.loss, found.circuit.storage) == (law.loss, law.storage)
    assert found.verdict.status is Status.PROVED
    assert verify(found.verdict.certificate)


@settings(max_examples=25, deadline=None)
@given(law=SERIES | SHUNT, size=decades(-3, 11), angle=ANGLE)
def test_the_angle_of_a_law_is_between_zero_and_that_of_s(law, size, angle):
    s = size * np.exp(1j * angle)
    assert -1e-12 <= np.angle(law.at(s)) <= np.angle(s) + 1e-12
    assert abs(law.at(s.conjugate()) - law.at(s).conjugate()) <= 1e-12 * abs(law.at(s))


@settings(max_examples=15, deadline=None)
@given(series=SERIES, shunt=SHUNT, size=decades(-1, 6), angle=st.floats(0, math.pi / 2), share=st.floats(0.1, 0.9))
def test_a_line_is_reciprocal_and_its_parts_make_the_whole(series, shunt, size, angle, share):
    s = size * np.exp(1j * angle)
    per_metre = abs(LossyLine(series, shunt, 1).gamma(s))
    whole, one, other = (LossyLine(series, shunt, 2 * x / per_metre).chain(s) for x in (1, share, 1 - share))
    a, b, c, d = whole.ravel()
    assert abs(a * d - b * c - 1) < 1e-12 * abs(a * d) + 1e-12
    largest = np.abs(one) @ np.abs(other)
    assert (np.abs(one @ other - whole) < 1e-12 * largest).all()


@settings(max_examples=15, deadline=None)
@given(series=SERIES, shunt=SHUNT, size=decades(-1, 8), angle=st.floats(0, math.pi / 2), load=decades(-3, 6))
def test_a_passive_load_is_seen_as_a_passive_impedance(series, shunt, size, angle, load):
    s = size * np.exp(1j * angle)
    line = LossyLine(series, shunt, 1 / abs(LossyLine(series, shunt, 1).gamma(s)))
    z = complex(line.input_impedance(s, load))
    assert z.real >= -1e-12 * abs(z)


@settings(max_examples=5, deadline=None)
@given(
    terms=st.lists(st.tuples(decades(-1, 1), decades(4, 7)), max_size=5), loss=decades(-1, 1), storage=decades(-7, -5)
)
def test_a_table_of_a_passive_law_gives_it_back(terms, loss, storage):
    law = Foster(loss, storage, [r for r, _ in terms], [p for _, p in terms])
    f = np.geomspace(1e2, 1e7, 60)
    z = law.at(2j * np.pi * f)
    found = tabulated(f, z.real, z.imag / (2 * np.pi * f), 0.02)
    between = 2j * np.pi * np.sqrt(f[1:] * f[:-1])
    assert np.abs(found.at(between) / law.at(between) - 1).max() < 0.03
    assert found.verdict.status is Status.PROVED
