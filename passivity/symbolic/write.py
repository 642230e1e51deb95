"""Polynomials as text that can be read in again."""

from flint import fmpz_mpoly


def polynomial(f: fmpz_mpoly, s: str = "s") -> str:
    """A polynomial in s, or what it stands for, and the parameters, a positive term first if there is one."""
    names = (s, *f.context().names()[1:])
    text, terms = "", list(f.terms())
    first = next((k for k, (_, c) in enumerate(terms) if c > 0), 0)
    for monomial, c in [terms[first], *terms[:first], *terms[first + 1 :]] if terms else []:
        factors = [name if k == 1 else f"{name}^{k}" for name, k in zip(names, map(int, monomial), strict=True) if k]
        if abs(c) != 1 or not factors:
            factors = [str(abs(c)), *factors]
        text += (" - " if c < 0 else " + ") + "*".join(factors)
    return text[3:] if text.startswith(" + ") else "-" + text[3:] if text else "0"


def factor(f: fmpz_mpoly, power: int = 1) -> str:
    """A power of a polynomial as part of a product."""
    text = polynomial(f)
    text = f"({text})" if len(f) > 1 or (power > 1 and "*" in text) else text
    return text if power == 1 else f"{text}^{power}"


def quotient(p: fmpz_mpoly, q: fmpz_mpoly) -> str:
    """p/q."""
    over, under = factor(p), polynomial(q)
    if under == "1":
        return polynomial(p)
    return f"{over}/({under})" if len(q) > 1 or "*" in under else f"{over}/{under}"


def cut(text: str, length: int) -> str:
    """The beginning of a text that is too long."""
    return text if len(text) <= length else text[: length - 3] + "..."
