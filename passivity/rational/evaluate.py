"""The exact value of an expression, refused where it would take too long or too much memory."""

import re
from collections.abc import Iterable, Mapping
from decimal import Decimal
from fractions import Fraction
from typing import TypeAlias

from flint import fmpz_poly

from passivity.budget import check_size
from passivity.errors import ExpressionError, shown
from passivity.expression.number import fraction, not_a_number
from passivity.expression.parse import parse
from passivity.expression.tree import Add, Call, Divide, Line, Multiply, Negate, Node, Number, Power, Symbol, symbols
from passivity.rational.function import RationalFunction

MAX_WORK = 300_000_000  # bits in all intermediate results of one expression: half a second

Exact: TypeAlias = int | float | Fraction | Decimal | str

_WHOLE = re.compile(r"\s*[0-9]{1,30}\s*")  # numbers that need no parser
_S = RationalFunction(fmpz_poly([0, 1]), fmpz_poly([1]))


def evaluate(text: str, parameters: Mapping[str, Exact], variable: str = "s") -> RationalFunction:
    """Rational function of an expression in ``s``, with a value for each other name in it and for no more."""
    tree = parse(text)
    check_names(symbols(tree) - {variable}, parameters, "no value")
    return of_tree(tree, {name: exact(x, f"parameter {name}") for name, x in parameters.items()}, variable)


def check_names(names: set[str], given: Mapping[str, object], missing: str) -> None:
    """Raise an error if a name in an expression is given nothing, or if a given name is not in the expression."""
    if lost := sorted(names - set(given)):
        expected = f"one for each of {_list(names)}"
        if lost[0] == "pi":
            expected = "a rational number for it, such as pi=3.14159265358979; the verdict is then about that number"
        raise ExpressionError(f"parameter {lost[0]:.60}", missing, expected, _list(given))
    if unused := sorted(set(given) - names, key=str):
        where = f"parameter{'s' * (len(unused) > 1)} {', '.join(map(shown, unused)):.60}"
        problem = "s is the Laplace variable" if unused == ["s"] else "not in the expression"
        wanted = "values" if missing == "no value" else "values or assumptions"
        raise ExpressionError(where, problem, f"{wanted} for {_list(names)}", _list(given))


def of_tree(tree: Node, values: Mapping[str, Fraction], variable: str = "s") -> RationalFunction:
    """Rational function of a tree, refused where it would take too long or too much memory."""
    return _Evaluation({name: RationalFunction.constant(x) for name, x in values.items()} | {variable: _S}).of(tree)


def exact(value: Exact, where: str) -> Fraction:
    """The exact value of a number or of a constant expression; `where` names it in the error."""
    if isinstance(value, Decimal):
        value = str(value)  # within the limits of text: Decimal("1e999999999") would fill the memory
    if not isinstance(value, str):
        return fraction(value, where)
    if _WHOLE.fullmatch(value):
        return Fraction(int(value))
    try:
        tree = parse(value)
        constant = None if symbols(tree) else _Evaluation({}).of(tree)
    except ExpressionError as error:
        raise error.within(where) from None
    if constant is None or constant.is_infinite:
        raise not_a_number(value, where)
    return constant.numerator[0] / constant.denominator[0]


def positive(value: Exact, where: str) -> Fraction:
    """Return a number as a Fraction; raise an error unless it is above zero."""
    found = exact(value, where)
    if found <= 0:
        raise ExpressionError(where, "not positive", "more than 0", shown(value))
    return found


class _Evaluation:
    """Value of a tree, refused where results outgrow MAX_DEGREE, MAX_BITS or, all together, MAX_WORK."""

    def __init__(self, values: Mapping[str, RationalFunction]):
        self.values, self.work = values, 0

    def of(self, node: Node) -> RationalFunction:
        match node:
            case Number(value):
                return RationalFunction.constant(value)
            case Symbol(name):
                return self.values[name]
            case Negate(operand):
                return -self.of(operand)
            case Divide(numerator, denominator):
                return self.kept(self.of(numerator) / self.of(denominator))
            case Power(operand, exponent):
                return self.kept(self.of(operand) ** exponent)
            case Add(children) | Multiply(children):
                result = self.of(children[0])
                for child in children[1:]:
                    operand = self.of(child)
                    result = self.kept(result + operand if isinstance(node, Add) else result * operand)
                return result
            case Call() | Line():
                name = node.name if isinstance(node, Call) else "line"
                problem = f"{name}(...) is not rational in s"
                raise ExpressionError("", problem, "only + - * / and whole powers")

    def kept(self, result: RationalFunction) -> RationalFunction:
        bits = result.bits
        check_size(result.degree, bits)
        self.work += (result.degree + 1) * bits
        if self.work > MAX_WORK:
            raise ExpressionError("", "the expression is too laborious", "fewer terms, or shorter numbers")
        return result


def _list(names: Iterable[str]) -> str:
    return f"{', '.join(sorted(map(str, names))) or 'no names':.200}"
