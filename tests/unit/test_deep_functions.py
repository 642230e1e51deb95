"""Questions of high degree, or of many parts within parts: an answer, no fault and no endless work."""

from passivity import Kind, Status
from passivity.calculus.ask import ask
from passivity.calculus.proof import proved_by, verify


def test_a_proof_of_very_high_degree_is_not_begun():
    """Rational of degree 299 in exp(-s): Routh's scheme in whole numbers would take hours."""
    text = "*".join(f"({k} + exp(-{k}*s))" for k in range(2, 25))
    assert ask(text, Kind.PR).status is Status.UNDECIDED


def test_a_function_too_deep_to_be_multiplied_out_is_no_error():
    """A ladder of 80 steps, of which Python's stack does not hold all."""
    steps = "".join(f"let z{k + 1} = 1 + 1/(s + 1/z{k}); " for k in range(80))
    assert ask(f"let z0 = 1; {steps}z80*(2 + exp(-s))", Kind.PR).status is not Status.REFUTED


def test_what_a_long_proof_proves_is_told():
    """300 lines one behind the other, each in the text of the next."""
    lines = "".join(f"let z{k + 1} = line({1 + k % 3}, s/{k + 2}, z{k}); " for k in range(300))
    found = ask(f"let z0 = 1 + s; {lines}z300", Kind.PR).proof
    assert verify(found)
    assert proved_by(found).startswith("line(3, 1/301*s, line(2, 1/300*s, line(1, ")


def test_digits_lost_along_many_lines_are_found_again():
    """600 lossy lines one behind the other: balls of 53 bits hold everything."""
    z0, through = "sqrt((1 + s)/(2 + s))", "sqrt((1 + s)*(2 + s))"
    lines = "".join(f"let z{k + 1} = line({z0}, {through}/{k + 1}, z{k}); " for k in range(600))
    assert ask(f"let z0 = 1 + s; {lines}z600", Kind.PR).proved
