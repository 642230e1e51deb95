"""Samples of a one-port from CSV files, and the text of files of samples."""

from pathlib import Path

import numpy as np

from passivity.errors import ExpressionError
<<<<<<< HEAD
from passivity.sampled.digits import Rounding, of_tokens
from passivity.sampled.response import MAX_PORTS, Parameter, SampledResponse
from tline.errors import MissingExtraError
=======
from passivity.sampled.digits import of_tokens
from passivity.sampled.response import Parameter, SampledResponse
>>>>>>> 6aa3001 (Measured networks have up to 200 poles, and are changed by their residues until they are proved passive; references may be complex, and files of version 2)

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


<<<<<<< HEAD
def read_touchstone(path: str | Path) -> SampledResponse:
    """Scattering matrices from a Touchstone file of version 1, read by scikit-rf; Z and Y in it are turned into S.

    The digits that are printed stay known, see `Rounding`. Z and Y are taken as normalised to the reference resistance,
    as version 1 has them.

    Parameters
    ----------
    path : str or Path
        Its suffix tells the number of ports: ``.s1p``, ``.s2p``, ... ``.s16p``.

    Raises
    ------
    ExpressionError
        If scikit-rf is missing, the file cannot be read or is longer than MAX_BYTES, holds hybrid parameters, a
        reference is not one real resistance for each port.

    References
    ----------
    Touchstone File Format Specification, version 1.1, EIA/IBIS Open Forum, 2002.

    Examples
    --------
    >>> from tempfile import NamedTemporaryFile
    >>> with NamedTemporaryFile("w", suffix=".s1p") as file:
    ...     _ = file.write("# MHz S RI R 75\\n1 0.5 0.1\\n2 0.4 0.2\\n")
    ...     file.flush()
    ...     response = read_touchstone(file.name)
    >>> response.f, response.z0
    (array([1000000., 2000000.]), array([75.]))
    """
    suffix = re.fullmatch(r"\.s(\d{1,2})p", Path(path).suffix.lower())
    if not suffix or not 0 < int(suffix[1]) <= MAX_PORTS:
        raise ExpressionError(f"{path}", "not a Touchstone file", f".s1p to .s{MAX_PORTS}p", Path(path).suffix)
    lines = [line.strip() for line in _text(path).splitlines()]
    lines = [line for line in lines if line[:1] != "!" or _PORT_COMMENT.fullmatch(line)]
    if any(line.startswith("[") for line in lines):
        raise ExpressionError(f"{path}", "Touchstone version 2 is not read", "version 1")
    try:
        from skrf.io.touchstone import Touchstone
    except ImportError:
        raise MissingExtraError(f"{path}", "Touchstone files need scikit-rf", "rf") from None
    file = io.StringIO("\n".join(lines))
    file.name = f"samples{Path(path).suffix.lower()}"  # its suffix is where scikit-rf looks for the number of ports
    try:
        with warnings.catch_warnings(action="error"):
            read = Touchstone(file)
        z0 = np.asarray(read.z0, complex)[0]
        constant = (read.z0 == z0).all() and (z0.imag == 0).all()
        if read.s_flat.shape[1] != int(suffix[1]) ** 2:
            raise ExpressionError(
                f"{path}", "not a Touchstone file", "samples, Touchstone version 1", "too few numbers"
            )
    except ExpressionError:
        raise
    except (ArithmeticError, AttributeError, IndexError, KeyError, TypeError, ValueError, Warning):
        # what they say quotes the file, and a scene may name any
        raise ExpressionError(f"{path}", "not a Touchstone file", "samples, Touchstone version 1") from None
    if not constant:
        raise ExpressionError(f"{path}", "reference impedance", "a constant resistance at each port", f"{z0}")
    if read.parameter not in ("s", "z", "y"):
        raise ExpressionError(f"{path}", "hybrid parameters are not read", "S, Z or Y", f"{read.parameter}".upper())
    rounding, values = _printed(lines, f"{read.format}", len(read.f), int(suffix[1]))
    if read.parameter != "s":
        one = np.eye(int(suffix[1]))
        try:
            rounding = rounding.through_cayley(values)
            values = (1 if read.parameter == "z" else -1) * (one - 2 * np.linalg.inv(one + values))
        except np.linalg.LinAlgError:
            raise ExpressionError(f"{path}", f"{read.parameter.upper()} + 1 is singular", "one that has an S") from None
    return SampledResponse(read.f, values, Parameter.S, z0.real, rounding)


def _printed(lines: list[str], form: str, number: int, ports: int) -> tuple[Rounding, NDArray[np.complex128]]:
    """What the numbers of the first samples are and leave open; S21 of two ports comes before S12."""
    numbers = [x for line in lines if line[:1] not in ("!", "#") for x in line.partition("!")[0].split()]
    width = 1 + 2 * ports**2
    rows = [numbers[k * width + 1 : (k + 1) * width] for k in range(number)]
    rounding, values = of_tokens(form, rows, ports)
    return (rounding.transposed(), values.swapaxes(1, 2)) if ports == 2 else (rounding, values)


def _text(path: str | Path) -> str:
=======
def text_of(path: str | Path) -> str:
    """What a file holds, not longer than MAX_BYTES."""
>>>>>>> 6aa3001 (Measured networks have up to 200 poles, and are changed by their residues until they are proved passive; references may be complex, and files of version 2)
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
