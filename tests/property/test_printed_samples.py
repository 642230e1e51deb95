"""What is passive stays unrefuted however it is printed; what is far from it does not."""

import numpy as np
import pytest

from passivity import Status, check_samples, read_touchstone

FORMS = ("RI", "MA", "DB")


def contraction(random, ports, n=6):
    """Scattering matrices with largest singular value 1."""
    a = random.normal(size=(n, ports, ports)) + 1j * random.normal(size=(n, ports, ports))
    return a / np.linalg.svd(a, compute_uv=False)[:, :1, None]


def printed(x, form, random):
    """A complex number in two, each with digits of its own."""
    with np.errstate(divide="ignore"):
        size = np.abs(x) if form == "MA" else 20 * np.log10(np.abs(x))
    pair = (x.real, x.imag) if form == "RI" else (size, np.degrees(np.angle(x)))
    style = "fe"[int(random.integers(3) == 1)]
    digits = random.integers(1, 13, size=2)
    return " ".join(f"{v:.{d}{style}}" for v, d in zip(pair, digits, strict=True))


def file_of(path, values, form, random):
    values = np.swapaxes(values, 1, 2) if values.shape[1] == 2 else values
    rows = [f"{k + 1}.0 " + " ".join(printed(x, form, random) for x in m.ravel()) for k, m in enumerate(values)]
    path.write_text("\n".join([f"# GHz S {form} R 50", *rows, ""]), encoding="utf-8")
    return path


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("ports", [1, 2, 3])
def test_passive_samples_are_never_refuted_for_their_digits(tmp_path, form, ports):
    random = np.random.default_rng([ports, FORMS.index(form)])
    for _ in range(25):
        path = file_of(tmp_path / f"a.s{ports}p", contraction(random, ports), form, random)
        verdict = check_samples(read_touchstone(path))
        assert verdict.status is Status.NO_VIOLATION
        assert (verdict.worst - 1 <= verdict.bars).all()


@pytest.mark.parametrize("kind", ["Z", "Y"])
@pytest.mark.parametrize("ports", [1, 2, 3])
def test_passive_impedances_and_admittances_are_never_refuted_for_their_digits(tmp_path, kind, ports):
    random = np.random.default_rng([3, ports, kind == "Z"])
    for _ in range(25):
        S = contraction(random, ports)
        z = np.linalg.solve(np.eye(ports) - S, np.eye(ports) + S)
        path = file_of(tmp_path / f"a.s{ports}p", z, "RI", random)
        path.write_text(path.read_text(encoding="utf-8").replace(" S ", f" {kind} "), encoding="utf-8")
        assert check_samples(read_touchstone(path)).status is Status.NO_VIOLATION


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("ports", [1, 2, 3])
def test_a_refutation_holds_for_all_that_is_printed_the_same(tmp_path, form, ports):
    """Matrices a little beyond the bound, drawn from all that the digits leave open."""
    random = np.random.default_rng([7, ports, FORMS.index(form)])
    for _ in range(10):
        given = contraction(random, ports) * (1 + 10.0 ** random.uniform(-4, -1))
        response = read_touchstone(file_of(tmp_path / f"a.s{ports}p", given, form, random))
        verdict, r = check_samples(response), response.rounding
        sure = verdict.worst - 1 > verdict.bars
        for _ in range(20):
            u, v = random.uniform(-1, 1, (2, *response.values.shape))
            moved = 0.999 * (u * np.minimum(r.along, 1) + 1j * v * np.minimum(r.across, 1))
            other = response.values + r.direction * moved
            assert (np.linalg.svd(other, compute_uv=False)[sure, 0] > 1).all()
