"""Tables as lines of text."""

from collections.abc import Sequence


def aligned(rows: Sequence[Sequence[str]], words: int) -> list[str]:
    """Align rows in columns of one width, the first ones of words to the left and numbers to the right.

    Examples
    --------
    >>> print(*aligned([["name", "size"], ["a", "1.5"]], 1), sep="\\n")
    name  size
    a      1.5
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.ljust(width) if k < words else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    ]
