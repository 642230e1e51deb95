"""A matrix of impedances or of scattering parameters, written [a, b; c, d]."""

from tline.cli.verdicts.answer import Answer, Asked, values
from tline.errors import InputError


def answer(text: str, asked: Asked) -> Answer:
    """Decide a matrix of rational functions."""
    from passivity import RationalMatrix, check_bounded_real, check_positive_real
    from passivity.budget import VERDICT, budget

    asked.refuse("matrices", "z0", "delay", "within", "error", "nearest")
    if not text.rstrip().endswith("]"):
        raise InputError("matrix", "its last bracket is missing", "[a, b; c, d]", f"'{text:.60}'")
    rows = [[entry.strip() for entry in row.split(",")] for row in text.strip()[1:-1].split(";")]
    matrix = RationalMatrix.from_rows(rows, values(asked.parameters))
    with budget(2 * VERDICT):
        verdict = (check_bounded_real if asked.kind == "br" else check_positive_real)(matrix)
    return Answer(verdict.status.value, verdict.text_lines(), verdict.to_dict())
