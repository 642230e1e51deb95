"""Samples of one-ports from CSV files, scattering matrices from Touchstone files.

The rounding of the digits of a file is kept, see `Rounding`, in all conversions of its numbers: from impedances to S,
from mixed modes to ports, and from one reference to another. S' is a quotient of linear functions of the printed S,
so a small change dS of it makes L dS R of S', with two matrices at each frequency.

References
----------
Touchstone File Format Specification, version 1.1, EIA/IBIS Open Forum, 2002; version 2.0, IBIS Open Forum, 2009.
K. Kurokawa, Power waves and the scattering matrix, IEEE Trans. MTT-13 (1965) 194-202.
R. B. Marks, D. F. Williams, A general waveguide circuit theory, J. Res. NIST 97 (1992) 533-562.
"""

import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from passivity.errors import ExpressionError
from passivity.sampled.response import MAX_PORTS, Parameter, Rounding, SampledResponse, of_tokens
from passivity.sampled.touchstone_text import TouchstoneText, parse
from tline.errors import check_kind

MAX_BYTES = 10_000_000
MAX_LINE = 4_000
HEADER = ["f", "re", "im"]
SINGULAR = 1e-12  # of a matrix that is inverted, beside its largest singular value


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
    """Read a text file of at most MAX_BYTES, and MAX_LINE characters in a line."""
    check_kind("path", path, str, Path)
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


def read_touchstone(path: str | Path) -> SampledResponse:
    """Scattering matrices from a Touchstone file of version 1 or 2; Z and Y in it are turned into S.

    Mixed modes are turned into the waves of the ports. Where the references are complex, or change with the frequency
    as in files of field solvers, S is turned into that of the resistance in the option line (of port 1, if there are
    several) at all ports.

    Parameters
    ----------
    path : str or Path
        In version 1 the suffix gives the number of ports: ``.s1p``, ``.s2p``, ... ``.s16p``. In version 2 it may be
        ``.ts`` too.

    Raises
    ------
    ExpressionError
        If the file cannot be read or is longer than `passivity.sampled.read.MAX_BYTES`, or holds hybrid parameters.

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
    read = parse(f"{path}", text_of(path), _by_suffix(path))
    if read.parameter not in ("s", "z", "y"):
        read.refuse("hybrid parameters are not read", "S, Z or Y", read.parameter.upper())
    f = np.array([float(sample[0]) for sample in read.samples]) * read.unit
    rounding, values = _printed(read)
    z0 = _references(read)
    modes, z0_modes = _mixed(read, z0)
    if read.parameter != "s":
        values, rounding = _scattering(read, values, rounding, z0_modes)
    if modes is not None:
        back = modes.swapaxes(1, 2)
        values, rounding = back @ values @ modes, rounding.through(back, modes)
    if (z0 == z0[0]).all() and not z0.imag.any():
        return SampledResponse(f, values, Parameter.S, np.real(z0[0]), rounding)
    values, rounding = _renormalised(read, values, rounding, z0)
    return SampledResponse(f, values, Parameter.S, read.resistances[0], rounding)


def _by_suffix(path: str | Path) -> int:
    """Number of ports, 0 for those that the file must tell."""
    suffix = Path(path).suffix.lower()
    named = re.fullmatch(r"\.s(\d{1,2})p", suffix)
    if (suffix != ".ts" and not named) or (named and not 0 < int(named[1]) <= MAX_PORTS):
        raise ExpressionError(f"{path}", "not a Touchstone file", f".s1p to .s{MAX_PORTS}p, or .ts", suffix)
    return int(named[1]) if named else 0


def _printed(read: TouchstoneText) -> tuple[Rounding, NDArray[np.complex128]]:
    """Return the rounding of the printed numbers and their values, as matrices."""
    ports = read.ports
    full = tuple(np.indices((ports, ports)).reshape(2, -1))
    index = {"lower": np.tril_indices(ports), "upper": np.triu_indices(ports)}.get(read.half, full)
    place = np.zeros((ports, ports), int)
    place[index] = np.arange(len(index[0]))
    if read.half:
        place = np.maximum(place, place.T)  # the other half is never above what is printed
    order = np.stack([2 * place + 1, 2 * place + 2], -1).ravel()
    rounding, values = of_tokens(read.form, [[row[k] for k in order] for row in read.samples], ports)
    swapped = ports == 2 and not read.half and read.keywords.get("two-port data order") != "12_21"
    return (rounding.transposed(), values.swapaxes(1, 2)) if swapped else (rounding, values)


def _references(read: TouchstoneText) -> NDArray[np.complex128]:
    """Reference impedances of the ports at all frequencies: of comments, else of [Reference] or the option line."""
    n, p = len(read.samples), read.ports
    if not read.impedances:
        return np.broadcast_to(np.array(read.resistances, complex), (n, p))
    sizes = {len(block) for block in read.impedances}
    if len(read.impedances) != n or sizes not in ({2 * p}, {2 * p * p}):
        read.refuse("comments of port impedances", f"{n} of {2 * p} numbers, one beside each sample")
    z0 = np.array(read.impedances).view(complex)
    if z0.shape[1] != p:
        z0 = np.diagonal(z0.reshape(n, p, p), axis1=1, axis2=2)
    sound = np.isfinite(z0) & (np.real(z0) > 0)
    if not sound.all():
        read.refuse("reference impedance", "finite, real parts above 0", f"{z0[~sound][0]:g}")
    return z0


def _mixed(read: TouchstoneText, z0: NDArray) -> tuple[NDArray | None, NDArray]:
    """Modes' waves of the ports', an orthogonal matrix, and the modes' references: twice and half of the ports'."""
    order = read.keywords.get("mixed-mode order")
    if order is None:
        return None, z0
    rows, references, seen = np.zeros((read.ports, read.ports)), z0.copy(), []
    words = [re.fullmatch(r"(s)(\d+)|([cd])(\d+),(\d+)", word.lower()) for word in order.split()]
    for k, word in enumerate(words[: read.ports]):
        if word is None:
            break
        numbers = [int(x) - 1 for x in word.groups()[1::2] + word.groups()[4:] if x and x.isdigit()]
        kind = word[1] or word[3]
        if not all(0 <= x < read.ports for x in numbers):
            break
        seen.append((kind, *numbers))
        rows[k, numbers] = 1 if kind == "s" else np.sqrt(0.5) * np.array([1, -1 if kind == "d" else 1])
        references[:, k] = z0[:, numbers[0]] * {"s": 1, "d": 2, "c": 0.5}[kind]
        if (z0[:, numbers] != z0[:, numbers[:1]]).any():
            read.refuse("[Mixed-Mode Order]", "ports of the same reference in a pair")
    if len(words) != read.ports or len(seen) != len(words) or np.abs(rows @ rows.T - np.eye(read.ports)).max() > 1e-9:
        read.refuse("[Mixed-Mode Order]", f"{read.ports} modes of {read.ports} ports, such as D1,2 C1,2")
    return rows[None], references


def _scattering(read: TouchstoneText, values: NDArray, rounding: Rounding, z0: NDArray) -> tuple[Any, Rounding]:
    """S of impedances or admittances; version 1 has them in units of the reference, version 2 in ohm or siemens."""
    one = np.eye(values.shape[1])
    root = np.sqrt(np.real(z0)) ** (-1 if read.parameter == "z" else 1)
    unit = root if read.keywords.get("version", "1")[:1] == "2" else np.ones_like(root)
    try:
        left, right = unit[:, :, None] * one, unit[:, None, :] * one
        normal: Any = left @ values @ right
        rounding = rounding.through(left, right).through_cayley(normal)
        return (1 if read.parameter == "z" else -1) * (one - 2 * np.linalg.inv(one + normal)), rounding
    except np.linalg.LinAlgError:
        read.refuse(f"{read.parameter.upper()} + 1 is singular", "one that has an S")


def _renormalised(read: TouchstoneText, values: NDArray, rounding: Rounding, z0: NDArray) -> tuple[Any, Rounding]:
    """Return S' = (p + q S) (r + t S)^-1 against one resistance; L = q - S' t and R = (r + t S)^-1 in its rounding.

    Voltages and currents are (g + h S) a and (k - l S) a of the waves a that arrive.
    """
    one, new = np.eye(read.ports), read.resistances[0]
    root = np.sqrt(np.real(z0))
    if read.waves == "power":
        g, h, k = z0.conj() / root, z0 / root, 1 / root
    elif read.waves == "pseudo":
        g = h = np.abs(z0) / root
        k = g / z0
    else:
        g = h = np.sqrt(z0)
        k = 1 / g
    p, q, r, t = ((x[:, :, None] * one) / 2 for x in (g - new * k, h + new * k, g + new * k, h - new * k))
    below = r + t @ values
    singular = np.linalg.svd(below, compute_uv=False)
    if not (singular[:, -1] > SINGULAR * singular[:, 0]).all():
        read.refuse("reference impedance", "references that have an S against a resistance")
    right = np.linalg.inv(below)
    renormalised = (p + q @ values) @ right
    return renormalised, rounding.through(q - renormalised @ t, right)
