"""Samples from files: CSV and Touchstone."""

import pytest

from passivity import ExpressionError
from passivity.sampled.read import MAX_BYTES, MAX_LINE, read_csv, read_touchstone


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
