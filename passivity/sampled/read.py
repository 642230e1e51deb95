"""Samples of a one-port from CSV files, and the text of files of samples."""

from pathlib import Path

import numpy as np

from passivity.errors import ExpressionError
from passivity.sampled.digits import of_tokens
from passivity.sampled.response import Parameter, SampledResponse

MAX_BYTES = 10_000_000
MAX_LINE = 4_000
HEADER = ["f", "re", "im"]


def read_csv(path: str | Path, parameter: Parameter | str, z0: float = 50.0) -> SampledResponse:
    """Samples of a one-port from a CSV file.

    Parameters
    ----------
    path : str or Path
        First line ``f,re,im``; then one line for each sample: frequency in Hz, real and imaginary part.
        Empty lines, and lines that begin with ``#``, are skipped.
    parameter : Parameter or str
        "Z", "Y" or "S".
    z0 : float
        Reference resistance of S, ohm.

    Raises
    ------
    ExpressionError
        If the file cannot be read or is longer than MAX_BYTES; naming the line that is no sample.

    Examples
    --------
    >>> from tempfile import NamedTemporaryFile
    >>> with NamedTemporaryFile("w", suffix=".csv") as file:
    ...     _ = file.write("f,re,im\\n1e6,50,1\\n2e6,50,2\\n")
    ...     file.flush()
    ...     read_csv(file.name, "Z").f
    array([1000000., 2000000.])
    """
    lines = ((n, line) for n, line in enumerate(text_of(path).splitlines(), 1) if line.strip() and line[0] != "#")
    rows = []
    for n, line in lines:
        cells = [cell.strip() for cell in line.split(",")]
        if not rows and cells == HEADER:
            rows.append(cells)
            continue
        try:
            if not rows:
                raise ValueError
            f, re_, im = map(float, cells)
        except ValueError:
            expected = "three numbers f,re,im" if rows else "the header f,re,im"
            raise ExpressionError(f"{path}: line {n}", "not a sample", expected, f"{line!r:.40}") from None
        rows.append((f, complex(re_, im), cells[1:]))
    f, values, printed = ([row[k] for row in rows[1:]] for k in range(3))
    finite = bool(rows[1:]) and np.isfinite(values).all()  # else the response says what is wrong
    return SampledResponse(f, values, parameter, z0, of_tokens("ri", printed, 1)[0] if finite else None)


def text_of(path: str | Path) -> str:
    """What a file holds, not longer than MAX_BYTES."""
    try:
        with open(path, "rb") as file:
            content = file.read(MAX_BYTES + 1)
        text = content.decode("utf-8-sig", "replace")
    except OSError as error:
        raise ExpressionError(f"{path}", "cannot be read", "a file", error.strerror or "") from None
    if len(content) > MAX_BYTES or max(map(len, text.splitlines()), default=0) > MAX_LINE:
        expected = f"at most {MAX_BYTES} bytes, {MAX_LINE} in a line"
        raise ExpressionError(f"{path}", "too long", expected)
    return text
