"""Samples from files, and what printed digits leave open: half units, rectangles, verdicts."""

from pathlib import Path

import numpy as np
import pytest

from passivity import ExpressionError, Status, check_samples, fit_scattering, read_csv, read_touchstone
from passivity.sampled.read import MAX_BYTES, MAX_LINE
from passivity.sampled.response import half_unit
from tests.touchstone_files import FILTER, SHIPPED


@pytest.mark.parametrize(
    ("text", "half"),
    [
        (".70711", 5e-6),
        ("0.70711", 5e-6),
        ("0.707110", 5e-7),
        ("-1.50E-3", 5e-6),
        ("+5.", 0.5),
        ("7", 0.5),
        ("1.2e3", 50.0),
        ("1e-400", 0.0),
        ("1e400", 1e150),
    ],
)
def test_half_a_unit_in_the_last_place(text, half):
    assert half_unit(text) == pytest.approx(half, rel=1e-12)


def sampled(tmp_path, name, text):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


def test_a_violation_beyond_the_digits_is_one(tmp_path):
    path = sampled(tmp_path, "a.s2p", "! comment\n# GHz S MA R 50\n1 0.1 0 0.9 10 1.2 10 ! 3\n 0.1 3\n")
    verdict = check_samples(read_touchstone(path))
    assert verdict.status is Status.REFUTED
    assert verdict.worst_excess > verdict.worst_bar > 0
    table = sampled(tmp_path, "a.csv", "f,re,im\n1,-0.1,3\n2,-0.01,1\n")
    assert check_samples(read_csv(table, "Z")).status is Status.REFUTED
    table = sampled(tmp_path, "b.csv", "f,re,im\n1,-0.0,3\n2,-0.01,1.0\n3,-4e-3,1\n4,-0,7\n")
    assert check_samples(read_csv(table, "Z")).bands[0].frequency == 2


@pytest.mark.parametrize("written", [lambda x: str(round(x, 6)), lambda x: f"{x:g}"], ids=["str", "%g"])
def test_writers_that_drop_zeros_have_printed_the_other_digits(tmp_path, written):
    """A column of S of 1 and 0.1 has the norm 1.005, and a lossless response, rounded, none beyond 1."""
    one, turned, other = [], [], np.linspace(0, 80.123, 60)
    for k, angle in enumerate(other):
        one.append((k, 0.1, angle, 1.0, 0.0, 0.0, 0.0, 0.1, -angle))
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        turned.append((k, c, 0.0, s, 90.0, s, 90.0, c, 0.0))
    for rows, status in ((one, Status.REFUTED), (turned, Status.NO_VIOLATION)):
        lines = [" ".join(map(written, map(float, row))) for row in rows]
        path = sampled(tmp_path, "a.s2p", "\n".join(["# GHz S MA R 50", *lines]))
        assert check_samples(read_touchstone(path)).status is status


def test_noise_parameters_after_the_samples_are_none(tmp_path):
    text = "# GHz S MA R 50\n1 .5 0 .7071 0 .7071 0 .5 180\n2 .5 0 .7 0 .7 0 .5 180\n1 1.2 0.3 45 0.2\n"
    assert len(check_samples(read_touchstone(sampled(tmp_path, "a.s2p", text))).bars) == 2


@pytest.mark.parametrize(("kind", "sign"), [("Z", 1), ("Y", -1)])
def test_impedances_and_admittances_are_normalised(tmp_path, kind, sign):
    text = f"# GHz {kind} RI R 75\n1 2.000 0.000\n2 0.00000 1.00000\n3 -1e-3 0.500\n"
    response = read_touchstone(sampled(tmp_path, "a.s1p", text))
    z = np.array([2, 1j, -1e-3 + 0.5j])
    assert response.values[:, 0, 0] == pytest.approx(sign * (z - 1) / (z + 1))
    verdict = check_samples(response)
    assert [verdict.worst_frequency, len(verdict.bands)] == [3e9, 1]
    coarse = read_touchstone(sampled(tmp_path, "b.s1p", f"# GHz {kind} RI R 75\n3 -0.00 0.5\n4 0.00 .70\n"))
    assert check_samples(coarse).status is Status.NO_VIOLATION


def test_hybrid_parameters_are_refused(tmp_path):
    path = sampled(tmp_path, "a.s2p", "# GHz H RI R 50\n1 1 0 2 0 3 0 4 0\n")
    with pytest.raises(ExpressionError, match="hybrid parameters are not read, expected S, Z or Y, got H"):
        read_touchstone(path)


def test_a_model_of_rounded_samples_is_found_not_refused(tmp_path):
    f = np.linspace(0.1, 4, 80)
    values = (1 - 0.5j * f) / (1 + 0.5j * f)  # of modulus 1, to three digits
    rows = (f"{x:.4f} {v.real:.3f} {v.imag:.3f}" for x, v in zip(f, values, strict=True))
    response = read_touchstone(sampled(tmp_path, "a.s1p", "\n".join(["# GHz S RI R 50", *rows])))
    assert check_samples(response, 0.0).status is Status.REFUTED
    assert fit_scattering(response, 1e-4 + 1e-3, delays=0.0).order == 1
    with pytest.raises(ExpressionError, match="no model of up to 60 poles is that near"):
        fit_scattering(response, 1e-5, delays=0.0)


@pytest.mark.parametrize("path", [SHIPPED, FILTER])
def test_the_shipped_files_are_not_refuted(path):
    assert check_samples(read_touchstone(Path(path))).status is Status.NO_VIOLATION


def test_csv(tmp_path):
    path = tmp_path / "z.csv"
    path.write_text("\ufeff# an impedance\nf, re, im\n0,50,0\n\n1e3, 49.5,-2e-1\n", encoding="utf-8")
    response = read_csv(path, "Z")
    assert response.f.tolist() == [0, 1000]
    assert response.values.ravel().tolist() == [50, 49.5 - 0.2j]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "f: not a list"),
        ("f,re,im\n", "f: not a list"),
        ("1,2,3\n", "line 1: not a sample, expected the header"),
        ("f,re,im\n1,2\n", "line 2: not a sample, expected three numbers"),
        ("f,re,im\n1,2,x\n", "line 2"),
        ("f,re,im\n1,nan,0\n", "reasonable size"),
        ("f,re,im\n" + "1" * (MAX_LINE + 1), "too long"),
    ],
)
def test_bad_csv(tmp_path, text, said):
    path = tmp_path / "z.csv"
    path.write_text(text)
    with pytest.raises(ExpressionError, match=said):
        read_csv(path, "Z")


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(ExpressionError, match="cannot be read"):
        read_csv(tmp_path / "none.csv", "Z")
    with pytest.raises(ExpressionError, match="cannot be read"):
        read_csv(tmp_path, "Z")
    (tmp_path / "long.csv").write_bytes(b"\n" * (MAX_BYTES + 1))
    with pytest.raises(ExpressionError, match="too long"):
        read_csv(tmp_path / "long.csv", "Z")


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.txt", "", "expected .s1p to .s16p"),
        ("a.s99p", "", "expected .s1p to .s16p"),
        ("a.s1p", "", "f: not a list|not a Touchstone file"),
        ("a.s1p", "# Hz S RI R 50\n1 0.5\n", "line 2 has 2 numbers, expected a frequency, and pairs"),
        ("a.s1p", "# Hz S XX R 50\n1 0.5 0\n", "not a Touchstone file"),
        ("a.s1p", "# Hz S RI R 50\n1 hello 0\n", "not a Touchstone file"),
        ("a.s1p", "1 0.5 0\n", "line 1 is before the option line"),
        ("a.s2p", "# Hz S RI R 50\n1 0.5 0\n", "sample 1, expected 9, a frequency and .* 2 ports, got 3, as of 1 port"),
        ("a.s2p", "# Hz S RI R 50\n1 0 0 0 0\n0 0 0 0\n2" + 32 * " 0", "sample 2.* got 33, as of 4 ports"),
        ("a.s2p", "[Version] 2.0\n# Hz\n[Number of Ports] 2\n1 0 0 0 0 0 0 0 0", "Two-Port Data Order.*12_21 or 21_12"),
        ("a.s1p", "[Number of Frequencies] 3\n# Hz\n1 1 0\n2 1 0", "samples, expected 3 by .*, got 2"),
        ("a.s2p", "# Hz R 50 60 70\n1 0 0 0 0 0 0 0 0", "expected one, or 2 for the ports, got 3"),
        ("a.s1p", "# Hz\n! Port Impedance 50 0\n1 1 0\n2 1 0", "port impedances, expected 2 of 2 numbers"),
        ("a.s1p", "# Hz\n! Port Impedance 50 0\n! 3 .\n1 1 0", "in a comment, expected numbers"),
        ("a.s1p", "# Hz\n[Matrix Format] Left\n1 1 0", "Matrix Format.* expected Full, Lower or Upper"),
        ("a.s1p", "# Hz S RI R -5\n1 0.5 0\n", "reference impedance"),
        ("a.s1p", "# Hz S RI R nan\n1 0.5 0\n", "reference impedance"),
        ("a.s1p", "# Hz S RI R inf\n1 0.5 0\n", "reference impedance"),
        ("a.s1p", "# Hz S RI R 50\n2 0.5 0\n1 0.5 0\n", "out of order"),
        (
            "a.s1p",
            "[Version] 2.0\n# Hz S RI R 50\n[Number of Ports] 1\n[Reference]\n",
            "Reference.*expected 1 resistance.*got 0",
        ),
        ("a.ts", "[Version] 2.0\n# Hz S RI R 50\n1 0.5 0\n", "Number of Ports.*expected 1 to 16, got nothing"),
        ("a.ts", "[Version] 2.0\n[Number of Ports] 99999999\n", "expected 1 to 16, got 99999999"),
        *(
            ("a.s2p", f"# Hz\n[Mixed-Mode Order] {modes}\n1" + 8 * " 0", "expected 2 modes of 2 ports")
            for modes in ("", "D1,2", "D1,2 D1,2", "D1,3 C1,3", "S1 D1,2", "D1,2 X", "D1,1 C1,1")
        ),
        ("a.s2p", "# Hz R 50 75\n[Mixed-Mode Order] D1,2 C1,2\n1" + 8 * " 0", "ports of the same reference in a pair"),
        ("a.s1p", "# Hz S RI R 50\n! Port Impedance -40 5\n1 0.5 0\n", "reference impedance"),
    ],
)
def test_bad_touchstone(tmp_path, name, text, said):
    (tmp_path / name).write_text(text)
    with pytest.raises(ExpressionError, match=said):
        read_touchstone(tmp_path / name)
