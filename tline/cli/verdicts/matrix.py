"""A matrix of impedances or of scattering parameters, written [a, b; c, d]."""

from tline.cli.verdicts.answer import Answer, Asked, values
from tline.errors import InputError


def answer(text: str, asked: Asked) -> Answer:
    """Decide a matrix of rational functions."""
    from passivity import Kind, RationalMatrix, check_bounded_real_matrix, check_positive_real_matrix
    from passivity.budget import ASIDE, VERDICT, budget, if_affordable
    from passivity.multiport.margin import margin
    from passivity.multiport.report import as_dict, in_lines

    asked.refuse("matrices", "z0", "delay", "within", "error", "nearest")
    if not text.rstrip().endswith("]"):
        raise InputError("matrix", "its last bracket is missing", "[a, b; c, d]", f"'{text:.60}'")
    rows = [[entry.strip() for entry in row.split(",")] for row in text.strip()[1:-1].split(";")]
    matrix = RationalMatrix.from_rows(rows, values(asked.parameters))
    kind = Kind.BR if asked.kind == "br" else Kind.PR
    with budget(2 * VERDICT):
        verdict = (check_bounded_real_matrix if kind is Kind.BR else check_positive_real_matrix)(matrix)
    found = if_affordable(ASIDE, margin, matrix, kind)
    return Answer(verdict.status.value, in_lines(verdict, found), as_dict(verdict, found))
