"""From the text of an expression to its form."""

from collections.abc import Mapping
from fractions import Fraction

from passivity.delayed.form import Form, add, apply, constant, multiply, of_rational
from passivity.errors import ExpressionError
from passivity.expression.tree import Add, Call, Divide, Multiply, Negate, Node, Power
from passivity.rational.evaluate import Exact, is_rational, of_tree, with_values
from passivity.rational.function import RationalFunction

MAX_DEPTH = 40  # of functions and sums in one another
MAX_SIZE = 150  # functions, sums, products, signs and powers in one expression that is not rational


def of_text(text: str, parameters: Mapping[str, Exact] | None = None) -> Form:
    """The form of an expression in ``s``, with a value for each other name in it and for no more.

    Examples
    --------
    >>> print(of_text("k - sqrt((1 + s)*s)", {"k": 2}))
    2 - sqrt(s^2 + s)
    """
    tree, values = with_values(text, parameters or {})
    return Translation(values).whole(tree)


class Translation:
    """From the tree of an expression to its form."""

    def __init__(self, values: Mapping[str, Fraction]):
        self.values, self.size = values, 0

    def of(self, node: Node) -> Form:
        """The form of a node, refused where it grows too large."""
        if is_rational(node):
            value = of_tree(node, self.values)
            return of_rational(RationalFunction(value.p, value.q))
        self.size += 1
        if self.size > MAX_SIZE:
            raise ExpressionError("", "the expression is too large", f"at most {MAX_SIZE} parts that are not rational")
        match node:
            case Negate(operand):
                return self.of(operand) * constant(-1)
            case Divide(numerator, denominator):
                return self.of(numerator) / self.of(denominator)
            case Power(base, e):
                return multiply([(self.of(base), e)]) if e else constant(1)
            case Add(terms):
                return add(part for term in self.parts(terms, Add) for part in self.of(term).terms)
            case Multiply(factors):
                return multiply((self.of(factor), 1) for factor in self.parts(factors, Multiply))
            case Call(name, argument):
                return apply(name, self.of(argument))
        raise AssertionError(node)

    def whole(self, node: Node) -> Form:
        """The form of a whole expression."""
        form = self.of(node)
        if form.depth > MAX_DEPTH:
            raise ExpressionError("", "nested too deeply", f"at most {MAX_DEPTH} levels of functions and sums")
        return form

    def parts(self, children: tuple[Node, ...], join: type) -> list[Node]:
        """The children, the rational ones together."""
        simple = tuple(child for child in children if is_rational(child))
        joined = [join(simple)] if len(simple) > 1 else list(simple)
        return [*joined, *(child for child in children if not is_rational(child))]
