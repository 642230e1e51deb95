"""A matrix of impedances or of scattering parameters, written [a, b; c, d]."""

from tline.cli.verdicts.answer import Answer, Asked, complex_text, values
from tline.errors import InputError


def answer(text: str, asked: Asked) -> Answer:
    """Decide a matrix of rational functions."""
    from passivity import Kind, RationalMatrix, check_bounded_real_matrix, check_positive_real_matrix
    from passivity.budget import ASIDE, VERDICT, budget, if_affordable
    from passivity.expression.number import digits
    from passivity.multiport.margin import margin
    from passivity.multiport.report import as_dict

    asked.refuse("matrices", "z0", "delay", "within", "error", "nearest")
    if not text.rstrip().endswith("]"):
        raise InputError("matrix", "its last bracket is missing", "[a, b; c, d]", f"'{text:.60}'")
    rows = [[entry.strip() for entry in row.split(",")] for row in text.strip()[1:-1].split(";")]
    matrix = RationalMatrix.from_rows(rows, values(asked.parameters))
    kind = Kind.BR if asked.kind == "br" else Kind.PR
    with budget(2 * VERDICT):
        verdict = (check_bounded_real_matrix if kind is Kind.BR else check_positive_real_matrix)(matrix)
    found = if_affordable(ASIDE, margin, matrix, kind)
    lines = [f"{kind.value}, {matrix.size} ports: {verdict.status.value}", f"  because {verdict.why}"]
    if w := verdict.witness:
        vector = ", ".join(complex_text(re, im) for re, im in w.vector)
        form = "vᴴ(Z + Zᴴ)v" if kind is Kind.PR else "|v|² − |Sv|²"
        lines += [
            f"  witness s = {complex_text(w.re, w.im)}",
            f"    v = ({vector})",
            f"    {form} = {digits(w.value)}",
        ]
    if found:
        name = "smallest eigenvalue of (Z + Zᴴ)/2" if kind is Kind.PR else "largest singular value of S"
        proved = f"proved not beyond {found.bound:.6g}"
        lines.append(f"  {name} ≈ {found.value:.6g} at ω = {found.frequency:.6g} rad/s, {proved}")
    return Answer(verdict.status.value, lines, as_dict(verdict, found))
