"""What always holds: networks of positive elements are proved, and the answer does not depend on how it is asked."""

from fractions import Fraction
from itertools import permutations

from flint import fmpq_mat
from hypothesis import given, settings, strategies as st

from passivity import Kind, RationalFunction, RationalMatrix, StateSpace, Status, impedances, scattering
from passivity.exact.certificate import verify
from passivity.exact.margin import margin
from passivity.exact.positive_real import check_bounded_real, check_positive_real, refuted_or_undecided
from passivity.floats.axis import analyse
from passivity.floats.system import FloatSystem

s = RationalFunction.from_expression("s")
ZERO = RationalFunction.constant(Fraction(0))

values = st.fractions(Fraction(1, 9), 9, max_denominator=9)
whole = st.integers(-3, 3)
few = settings(max_examples=15, deadline=None)


@st.composite
def one_ports(draw):
    """A resistor, a coil and up to two resonances, some without loss; in henry or in nanohenry."""
    z, unit = RationalFunction.constant(draw(values | st.just(Fraction(0)))), draw(st.sampled_from([1, 10**9]))
    p = s / unit
    z = z + p * draw(values | st.just(Fraction(0)))
    for _ in range(draw(st.integers(0, 2))):
        z = z + p * draw(values) / (p * p + p * draw(values | st.just(Fraction(0))) + draw(values))
    return z


@st.composite
def passive_matrices(draw):
    """M^T diag(z1, z2, ...) M: transformers before one-ports, and a gyrator beside them."""
    m, parts = draw(st.integers(1, 3)), draw(st.lists(one_ports(), min_size=1, max_size=3))
    ratios = [[draw(whole) for _ in range(m)] for _ in parts]
    skew = {(i, k): draw(whole) for i in range(m) for k in range(i)}

    def entry(i, k):
        z = sum((part * (row[i] * row[k]) for part, row in zip(parts, ratios, strict=True)), ZERO)
        return z + skew.get((i, k), 0) - skew.get((k, i), 0)

    return RationalMatrix(tuple(tuple(entry(i, k) for k in range(m)) for i in range(m)))


@st.composite
def small_matrices(draw):
    """Some are positive real, most are not."""
    coefficients = st.lists(st.integers(-2, 5), min_size=1, max_size=3)
    entries = st.tuples(coefficients, coefficients.filter(any)) | st.integers(0, 4)
    m = draw(st.integers(1, 2))
    return RationalMatrix.from_rows([[draw(entries) for _ in range(m)] for _ in range(m)])


@st.composite
def port_hamiltonian(draw):
    """A = (J - R) Q, C = B^T Q with J skew, R and Q of squares: always passive; sometimes made not to be."""
    n, m = draw(st.integers(1, 5)), draw(st.integers(1, 2))
    j, half = ([[draw(whole) for _ in range(n)] for _ in range(n)] for _ in range(2))
    lossless, spoiled = draw(st.booleans()), draw(st.booleans())
    q = [draw(st.integers(1, 4)) for _ in range(n)]
    b = [[draw(whole) for _ in range(m)] for _ in range(n)]

    def inner(i, k):
        r = 0 if lossless else sum(half[i][x] * half[k][x] for x in range(n))
        return (j[i][k] - j[k][i] - r) * q[k]

    a = [[inner(i, k) for k in range(n)] for i in range(n)]
    c = [[b[k][i] * q[k] for k in range(n)] for i in range(m)]
    skew = draw(whole) if m > 1 else 0
    d = [[-Fraction(spoiled, 1000) if i == k else skew * (i - k) for k in range(m)] for i in range(m)]
    return StateSpace.from_entries(a, b, c, d), spoiled


def value(coefficients, re, im):
    u, v = Fraction(0), Fraction(0)
    for c in coefficients:
        u, v = u * re - v * im + c, u * im + v * re
    return u, v


def power(matrix, kind, witness):
    """v^H (Z + Z^H) v, or |v|^2 - |S v|^2, by complex arithmetic in fractions."""
    re, im, v = witness.re, witness.im, witness.vector
    total = sum(x * x + y * y for x, y in v) if kind is Kind.BR else Fraction(0)
    for row, (vx, vy) in zip(matrix.rows, v, strict=True):
        x, y = Fraction(0), Fraction(0)
        for entry, (wx, wy) in zip(row, v, strict=True):
            (a, b), (c, d) = value(entry.numerator, re, im), value(entry.denominator, re, im)
            p, q = (a * c + b * d) / (c * c + d * d), (b * c - a * d) / (c * c + d * d)
            x, y = x + p * wx - q * wy, y + p * wy + q * wx
        total += -(x * x + y * y) if kind is Kind.BR else 2 * (vx * x + vy * y)
    return total


def is_proved(network, kind=Kind.PR):
    """The answer, once its evidence has been looked at."""
    verdict = (check_positive_real if kind is Kind.PR else check_bounded_real)(network)
    if verdict.status is Status.PROVED:
        assert verify(verdict.certificate)
        return True
    assert verdict.status is Status.REFUTED
    matrix = network.transfer if isinstance(network, StateSpace) else network
    assert verdict.witness.re > 0
    assert power(matrix, kind, verdict.witness) == verdict.witness.form < 0
    return False


def changed(matrix, entry):
    """The matrix with entry(i, k) in the place of each of its own."""
    m = matrix.size
    return RationalMatrix(tuple(tuple(entry(i, k) for k in range(m)) for i in range(m)))


@few
@given(passive_matrices())
def test_one_ports_behind_transformers_are_proved(z):
    assert is_proved(z)


@few
@given(passive_matrices(), values)
def test_what_is_taken_away_beyond_the_margin_is_missing(z, more):
    found = margin(z, Kind.PR)
    low, high = Fraction(found.bound), Fraction(found.value) + (1 + abs(Fraction(found.value))) * more / 10**6
    assert is_proved(changed(z, lambda i, k: z.rows[i][k] - low * (i == k)))
    assert not is_proved(changed(z, lambda i, k: z.rows[i][k] - high * (i == k)))


@few
@given(passive_matrices(), st.sampled_from(["-s", "-1/s", "s^2", "1/(s - 1)", "s/(s^2 + 1)^2"]))
def test_an_active_part_that_nothing_makes_good_is_refuted(z, part):
    """In the first port, where the rest has been taken away."""
    bad = RationalFunction.from_expression(part) - Fraction(1, 100)
    assert not is_proved(changed(z, lambda i, k: bad if i == k == 0 else z.rows[i][k] * (i > 0 and k > 0)))


@few
@given(small_matrices())
def test_impedances_and_scattering_have_one_answer(z):
    proved = is_proved(z)
    assert proved == is_proved(changed(z, lambda i, k: z.rows[k][i]))
    n, d = z.fraction
    if all(n[i][k] == -d * (i == k) for i in range(z.size) for k in range(z.size)) or not invertible(z):
        assert not proved
        return
    waves = scattering(z)
    assert is_proved(waves, Kind.BR) == proved
    assert impedances(waves).rows == z.rows


def invertible(z):
    a = changed(z, lambda i, k: z.rows[i][k] + (i == k)).rows
    det = a[0][0] if z.size == 1 else a[0][0] * a[1][1] - a[0][1] * a[1][0]
    return not det.is_zero


@few
@given(small_matrices())
def test_bounded_real_evidence_holds(waves):
    assert is_proved(waves, Kind.BR) == is_proved(changed(waves, lambda i, k: -waves.rows[k][i]), Kind.BR)


@few
@given(small_matrices() | passive_matrices(), st.data())
def test_ports_may_be_renumbered_and_turned(z, data):
    order = data.draw(st.sampled_from(list(permutations(range(z.size)))))
    signs = [data.draw(st.sampled_from([-1, 1])) for _ in order]
    other = changed(z, lambda i, k: z.rows[order[i]][order[k]] * (signs[i] * signs[k]))
    assert is_proved(other) == is_proved(z)


@few
@given(one_ports() | small_matrices().map(lambda z: z.rows[0][0]))
def test_one_port_is_a_matrix_too(z):
    assert is_proved(RationalMatrix(((z,),))) == (check_positive_real(z).status is Status.PROVED)


@few
@given(port_hamiltonian())
def test_state_spaces_and_their_transfer_matrices_have_one_answer(given_system):
    system, spoiled = given_system
    proved = is_proved(system)
    assert proved == is_proved(system.transfer)
    assert proved or spoiled
    limit = [[system.d[i, k] + system.d[k, i] for k in range(system.size)] for i in range(system.size)]
    assert not (proved and limit[0][0] < 0)


@few
@given(port_hamiltonian())
def test_floating_point_never_contradicts_a_proof_and_sees_what_is_refuted_clearly(given_system):
    system, _ = given_system
    answer = refuted_or_undecided(Kind.PR, system, "no exact test")
    analysis = answer.analysis
    assert answer.status is not Status.PROVED
    if is_proved(system):
        assert answer.status is Status.UNDECIDED
        assert analysis.bands == ()
    else:  # by 1/1000 at infinity
        assert answer.status is Status.REFUTED
        w = answer.witness
        assert w.re > 0
        assert power(system.transfer, Kind.PR, w) == w.form < 0


@few
@given(port_hamiltonian(), values)
def test_floating_point_has_the_exact_margin(given_system, more):
    """D + more I: the smallest eigenvalue is enclosed by an exact test from below."""
    system, _ = given_system
    direct = [[system.d[i, k] + (i == k) * int(more * 100) for k in range(system.size)] for i in range(system.size)]
    raised = StateSpace(system.a, system.b, system.c, fmpq_mat(direct))
    found, exact = analyse(FloatSystem.of(Kind.PR, raised)), margin(raised, Kind.PR)
    assert found.agree
    assert exact.bound - 1e-9 * (1 + abs(exact.bound)) <= found.value <= exact.value + 1e-7 * (1 + abs(exact.value))
