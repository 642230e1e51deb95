"""Derivation from the load of a line to its input port, each statement proved and each step of algebra checked.

u effort, y flow, both from the input (1) to the load (2): a = u + z0 y, b = u - z0 y; A2 = e^(-Ts) A1, B1 = e^(-Ts) B2.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

from flint import acb

from passivity.calculus.ask import is_bounded_real, is_positive_real
from passivity.calculus.graph import Graph
from passivity.calculus.question import free_names, read
from passivity.expression.number import digits, written
from passivity.status import Decided, Status
from passivity.verdict import Verdict, Witness

# name of the step, both sides, what is put into them
_ALGEBRA = (
    ("a and b at the input", "(U1 - z0*Y1)/(U1 + z0*Y1)", "B1/A1", "let A1 = U1 + z0*Y1; let B1 = U1 - z0*Y1; "),
    ("divide by U1", "(1 - z0*Y1/U1)/(1 + z0*Y1/U1)", "(U1 - z0*Y1)/(U1 + z0*Y1)", ""),
    ("G1 = z0*Y1/U1", "H1", "(1 - G1)/(1 + G1)", "let G1 = z0*Y1/U1; let H1 = (1 - z0*Y1/U1)/(1 + z0*Y1/U1); "),
    ("multiply by 1 + G1", "H1*(1 + G1)", "1 - G1", "let H1 = (1 - G1)/(1 + G1); "),
    ("collect G1", "G1*(1 + H1)", "1 - H1", "let H1 = (1 - G1)/(1 + G1); "),
    ("divide by 1 + H1", "G1", "(1 - H1)/(1 + H1)", "let H1 = (1 - G1)/(1 + G1); "),
)


@dataclass(frozen=True)
class Derivation(Decided):
    """Derivation from the load of a line to its input port: statements, and the algebra of G1 = (1 - H1)/(1 + H1).

    Parameters
    ----------
    statements : tuple of (str, Verdict)
        (a) H2, (b) H1, (c) G1, and (d) all at once; in place of that first the load, where `check_line` answers.
    z0, delay : Fraction or None
        Of the line, where they are numbers.
    witness : Witness or None
        For an active port: s with Re s > 0, H2(s) exactly, and |exp(-2Ts) H2(s)| > 1 shown in ball arithmetic; None
        where a long delay leaves no such point in reach of reasonable numbers.
    input : acb or None
        G1 at the witness, a ball with negative real part.
    """

    statements: tuple[tuple[str, Verdict], ...]
    z0: Fraction | None = None
    delay: Fraction | None = None
    witness: Witness | None = None
    input: acb | None = None

    @property
    def status(self) -> Status:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Status of the last statement."""
        return self.statements[-1][1].status

    @property
    def algebra(self) -> tuple[tuple[str, str, bool], ...]:
        """Algebraic steps: description, equation, and whether it holds."""
        return _algebra()

    @property
    def load(self) -> Verdict:
        """Verdict on Z2 as an impedance, where `check_line` answers."""
        return self.statements[0][1]

    @property
    def reflection(self) -> Verdict:
        """Verdict on H2 as a reflection, where `check_line` answers."""
        return self.statements[1][1]

    def text_lines(self) -> list[str]:
        """Statement after statement, with the algebra between."""
        told = []
        if self.z0 is not None and self.delay is not None:
            told.append(f"through a line of z0 = {digits(self.z0)} and delay T = {digits(self.delay)}:")
        for name, conclusion in self.statements:
            told += [f"({name}) {conclusion.statement}: {conclusion.status.value}", f"    because {conclusion.why}"]
            if name == "b":
                told += [
                    f"    {text:<52} [{what}{'' if holds else ': does not hold'}]" for what, text, holds in self.algebra
                ]
        return told

    def to_dict(self) -> dict[str, Any]:
        """The statements as JSON can hold them."""
        told: dict[str, Any] = {"status": self.status.value}
        if self.z0 is not None and self.delay is not None:
            told |= {"z0": written(self.z0), "delay": written(self.delay)}
        told["steps"] = [{"claim": x.statement, "status": x.status.value, "reason": x.why} for _, x in self.statements]
        return told | ({"witness": self.witness.in_texts()} if self.witness else {})  # the value is that of H2


def derive(load: str = "Z2", z0: str = "z0", delay: str = "T", assume: Iterable[str] = ()) -> Derivation:
    """Is the input port of a lossless line passive because its load is? Step by step, for any such load.

    Parameters
    ----------
    load, z0, delay : str
        Expressions; numbers, names, or for the load a function of s.
    assume : iterable of str
        As in `is_positive_real`, of the names in them; by default of Z2, z0 and T that they fit.

    Examples
    --------
    >>> print(derive().status, [x.status.value for _, x in derive("25 + s", "50", "3").statements])
    proved ['proved', 'proved', 'proved', 'proved']
    """
    known = {"Z2": "Z2 positive real", "z0": "z0 > 0", "T": "T >= 0"}
    assume = list(assume) or [known[x] for x in (load, z0, delay) if x in known]
    given = f"let Z2_ = {load}; let h2 = (Z2_/({z0}) - 1)/(Z2_/({z0}) + 1)"
    h1 = f"{given}; let h1 = exp(-2*({delay})*s)*h2"
    of_delay = [x for x in assume if set(re.findall(r"[^\W\d]\w*", x)) & set(re.findall(r"[^\W\d]\w*", delay))]
    found = (
        ("a", is_bounded_real("(G2 - 1)/(G2 + 1)", ["G2 positive real"])),
        ("b", is_bounded_real(f"exp(-2*({delay})*s)*H2", ["H2 bounded real", *of_delay])),
        ("c", is_positive_real("(1 - H1)/(1 + H1)", ["H1 bounded real"])),
        ("d", is_positive_real(f"{h1}; (1 - h1)/(1 + h1)", assume)),
    )
    return Derivation(found)


@cache
def _algebra() -> tuple[tuple[str, str, bool], ...]:
    return tuple((what, f"{a} = {b}", is_equation(lets + a, lets + b)) for what, a, b, lets in _ALGEBRA)


def is_equation(left: str, right: str) -> bool:
    """Whether two texts are the same quotient of polynomials in their names, by the rule `equal` of the verifier."""
    names = sorted(free_names(left) | free_names(right))
    graph = Graph(dict.fromkeys(names, ("real", float("-inf"), float("inf"))))
    return graph.is_equal(*(graph.fraction(*read(graph, text)) for text in (left, right)))


class Identity(NamedTuple):
    """An equation between the real parts of complex numbers and functions of these."""

    text: str  # statement in the quantities of the line
    parts: str  # the right side in real and imaginary parts
    definition: str  # the left side from its definition, i being the imaginary unit

    @property
    def holds(self) -> bool:
        """Whether both sides are the same."""
        return is_equation(f"let i = sqrt(-1); {self.definition}", self.parts)

    def __str__(self) -> str:
        return f"{self.text} = {self.parts}"


def reflection_identity() -> list[Identity]:
    """|H2|^2 = 1 - 4 Re G2/|G2 + 1|^2 for G2 = x + jy, H2 = (G2 - 1)/(G2 + 1), the last of several steps.

    So |H2| <= 1 where Re G2 >= 0, and the other way round.

    Examples
    --------
    >>> for step in reflection_identity():
    ...     print(step, step.holds)
    |G2 + 1|^2 = (x + 1)^2 + y^2 True
    |G2 - 1|^2 = (x - 1)^2 + y^2 True
    |G2 + 1|^2 - |G2 - 1|^2 = 4 Re G2 = 4*x True
    |H2|^2 = 1 - 4 Re G2/|G2 + 1|^2 = 1 - 4*x/((x + 1)^2 + y^2) True
    """
    below, above = "(x + i*y + 1)*(x - i*y + 1)", "(x + i*y - 1)*(x - i*y - 1)"
    h2 = "((x + i*y - 1)/(x + i*y + 1))*((x - i*y - 1)/(x - i*y + 1))"
    return [
        Identity("|G2 + 1|^2", "(x + 1)^2 + y^2", below),
        Identity("|G2 - 1|^2", "(x - 1)^2 + y^2", above),
        Identity("|G2 + 1|^2 - |G2 - 1|^2 = 4 Re G2", "4*x", f"{below} - {above}"),
        Identity("|H2|^2 = 1 - 4 Re G2/|G2 + 1|^2", "1 - 4*x/((x + 1)^2 + y^2)", h2),
    ]


def admittance_identity() -> list[Identity]:
    """2 Re G1 = 2 (1 - |H1|^2)/|1 + H1|^2 for H1 = a + jb, G1 = (1 - H1)/(1 + H1), the last of several steps.

    So Re G1 >= 0 where |H1| <= 1, and the other way round.

    Examples
    --------
    >>> for step in admittance_identity():
    ...     print(step, step.holds)
    |1 + H1|^2 = (1 + a)^2 + b^2 True
    Re (1 - H1) conj(1 + H1) = 1 - |H1|^2 = 1 - (a^2 + b^2) True
    Im (1 - H1) conj(1 + H1) = -2 Im H1 = -2*b True
    2 Re G1 = 2 (1 - |H1|^2)/|1 + H1|^2 = 2*(1 - (a^2 + b^2))/((1 + a)^2 + b^2) True
    """
    product, mirrored = "(1 - a - i*b)*(1 + a - i*b)", "(1 - a + i*b)*(1 + a + i*b)"
    twice = "(1 - a - i*b)/(1 + a + i*b) + (1 - a + i*b)/(1 + a - i*b)"
    return [
        Identity("|1 + H1|^2", "(1 + a)^2 + b^2", "(1 + a + i*b)*(1 + a - i*b)"),
        Identity("Re (1 - H1) conj(1 + H1) = 1 - |H1|^2", "1 - (a^2 + b^2)", f"({product} + {mirrored})/2"),
        Identity("Im (1 - H1) conj(1 + H1) = -2 Im H1", "-2*b", f"({product} - {mirrored})/(2*i)"),
        Identity("2 Re G1 = 2 (1 - |H1|^2)/|1 + H1|^2", "2*(1 - (a^2 + b^2))/((1 + a)^2 + b^2)", twice),
    ]
