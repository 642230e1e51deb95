"""Scattering matrices from Touchstone files, read by scikit-rf.

What the digits of a file leave open is kept, see `Rounding`, whatever is done to its numbers: from impedances to S, and
from one reference to another, S' is a quotient of linear functions of what is printed, so a small change dS of it makes
L dS R of S', with two matrices at each frequency.

References
----------
Touchstone File Format Specification, version 1.1, EIA/IBIS Open Forum, 2002; version 2.0, IBIS Open Forum, 2009.
"""

import io
import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from passivity.errors import ExpressionError
from passivity.sampled.digits import Rounding, of_tokens
from passivity.sampled.read import text_of
from passivity.sampled.response import MAX_PORTS, Parameter, SampledResponse
from tline.errors import MissingExtraError

STEP = 1e-7  # of an entry of S, by which L and R are found
# what HFSS writes of its ports; all other comments are dropped unread
_PORT_COMMENT = re.compile(
    r"!\s*(?:gamma|port impedance)?[-+.eE\s\d]*|!\s*S-parameter uses the (?:power|pseudo|traveling) definition\.?",
    re.IGNORECASE,
)


def read_touchstone(path: str | Path) -> SampledResponse:
    """Scattering matrices from a Touchstone file of version 1 or 2; Z and Y in it are turned into S.

    Where the references are complex, or change with the frequency as in files of field solvers, S is turned into that
    of the resistance in the option line (of port 1, if there are several) at all ports.

    Parameters
    ----------
    path : str or Path
        Of version 1 the suffix tells the number of ports: ``.s1p``, ``.s2p``, ... ``.s16p``. Of version 2 it may be
        ``.ts`` too.

    Raises
    ------
    ExpressionError
        If scikit-rf is missing, the file cannot be read or is longer than `passivity.sampled.read.MAX_BYTES`, holds
        hybrid parameters or mixed modes.

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
    lines = [line.strip() for line in text_of(path).splitlines()]
    lines = [line for line in lines if line and (line[0] != "!" or _PORT_COMMENT.fullmatch(line))]
    ports = _ports(path, lines)
    read = _parsed(path, lines, ports)
    if read.parameter not in ("s", "z", "y"):
        raise ExpressionError(f"{path}", "hybrid parameters are not read", "S, Z or Y", f"{read.parameter}".upper())
    rounding, values = _printed(lines, read, ports)
    z0: NDArray[np.complex128] = np.asarray(read.z0, complex)
    sound = np.isfinite(z0) & (z0.real > 0)
    if not sound.all():
        raise ExpressionError(f"{path}", "reference impedance", "finite, real parts above 0", f"{z0[~sound][0]:g}")
    if read.parameter != "s":
        values, rounding = _scattering(path, read, values, rounding, z0)
    if (z0 == z0[0]).all() and not z0.imag.any():
        return SampledResponse(read.f, values, Parameter.S, z0[0].real, rounding)
    new = float(np.real(np.ravel(read.resistance)[0]))
    values, rounding = _renormalised(path, values, rounding, z0, new, read.s_def or "power")
    return SampledResponse(read.f, values, Parameter.S, new, rounding)


def _ports(path: str | Path, lines: list[str]) -> int:
    """Their number, by the suffix or, of version 2, by the keyword."""
    if (modes := _keyword(lines, "mixed-mode order")) is not None:
        expected = "single-ended ports; scikit-rf's gmm2se turns mixed modes into them"
        raise ExpressionError(f"{path}", "mixed modes are not read", expected, modes)
    suffix = Path(path).suffix.lower()
    named = re.fullmatch(r"\.s(\d{1,2})p", suffix)
    if (suffix != ".ts" and not named) or (named and not 0 < int(named[1]) <= MAX_PORTS):
        raise ExpressionError(f"{path}", "not a Touchstone file", f".s1p to .s{MAX_PORTS}p, or .ts", suffix)
    told = _keyword(lines, "number of ports") if _keyword(lines, "version") is not None else None
    number = told if told is not None else named[1] if named else ""
    if not re.fullmatch(r"\d{1,2}", number) or not 0 < int(number) <= MAX_PORTS:
        raise ExpressionError(f"{path}", "[Number of Ports]", f"1 to {MAX_PORTS}", number or "nothing")
    return int(number)


def _keyword(lines: list[str], name: str) -> str | None:
    """What follows a keyword of version 2."""
    found = (line[len(name) + 2 :] for line in lines if line.lower().startswith(f"[{name}]"))
    return next((rest.partition("!")[0].strip() for rest in found), None)


def _form(lines: list[str]) -> str:
    """Which half of the symmetric matrices is printed, if one is."""
    form = (_keyword(lines, "matrix format") or "").lower()
    return form if form in ("lower", "upper") else ""


def _parsed(path: str | Path, lines: list[str], ports: int) -> Any:
    try:
        from skrf.io.touchstone import Touchstone
    except ImportError:
        raise MissingExtraError(f"{path}", "Touchstone files need scikit-rf", "rf") from None
    file = io.StringIO("\n".join(lines))
    file.name = f"samples.s{ports}p"  # its suffix is where scikit-rf looks for the number of ports
    try:
        with warnings.catch_warnings(action="error"):
            read = Touchstone(file)
        entries = ports * (ports + 1) // 2 if _form(lines) else ports**2
        found: Any = read
        if read.rank == ports and len(found.f) and found.s_flat.shape[1] == entries and found.z0.shape[1:] == (ports,):
            return read
    except (ArithmeticError, AttributeError, IndexError, KeyError, TypeError, ValueError, Warning):
        pass  # what they say quotes the file, and a scene may name any
    raise ExpressionError(f"{path}", "not a Touchstone file", "samples, Touchstone version 1 or 2")


def _printed(lines: list[str], read: Any, ports: int) -> tuple[Rounding, Any]:
    """What the numbers of the first samples are and leave open, as matrices."""
    start = next((k for k, line in enumerate(lines) if line.lower().startswith("[network data]")), 0)
    numbers = [x for line in lines[start:] if line[:1] not in "!#[" for x in line.partition("!")[0].split()]
    form = _form(lines)
    full = tuple(np.indices((ports, ports)).reshape(2, -1))
    index = {"lower": np.tril_indices(ports), "upper": np.triu_indices(ports)}.get(form, full)
    place = np.zeros((ports, ports), int)
    place[index] = np.arange(len(index[0]))
    if form:
        place = np.maximum(place, place.T)  # the other half is never above what is printed
    width = 1 + 2 * len(index[0])
    order = np.stack([2 * place + 1, 2 * place + 2], -1).ravel()
    rows = [numbers[k * width : (k + 1) * width] for k in range(len(read.f))]
    rounding, values = of_tokens(f"{read.format}", [[row[k] for k in order] for row in rows], ports)
    swapped = ports == 2 and not form and "12_21" not in (_keyword(lines, "two-port data order") or "")
    return (rounding.transposed(), values.swapaxes(1, 2)) if swapped else (rounding, values)


def _scattering(path: str | Path, read: Any, values: NDArray, rounding: Rounding, z0: NDArray) -> tuple[Any, Rounding]:
    """S of impedances or admittances; version 1 has them in units of the reference, version 2 in ohm or siemens."""
    one = np.eye(values.shape[1])
    root = np.sqrt(np.real(z0)) ** (-1 if read.parameter == "z" else 1)
    unit = np.ones_like(root) if read.version.startswith("1") else root
    try:
        left, right = unit[:, :, None] * one, unit[:, None, :] * one
        normal: Any = left @ values @ right
        rounding = rounding.through(left, right).through_cayley(normal)
        return (1 if read.parameter == "z" else -1) * (one - 2 * np.linalg.inv(one + normal)), rounding
    except np.linalg.LinAlgError:
        raise ExpressionError(f"{path}", f"{read.parameter.upper()} + 1 is singular", "one that has an S") from None


def _renormalised(
    path: str | Path, values: NDArray, rounding: Rounding, z0: NDArray, new: float, waves: Any
) -> tuple[Any, Rounding]:
    """S against one resistance, and L and R by which it changes, from the changes by entries of one row and column."""
    from skrf.network import renormalize_s

    n, p, _ = values.shape

    def turned(s: NDArray) -> NDArray:
        return np.asarray(renormalize_s(s, z0, np.full((n, p), new), s_def="power", s_def_old=waves))

    def slope(i: int, k: int) -> NDArray:
        moved = values.copy()
        moved[:, i, k] += STEP
        return (turned(moved) - here) / STEP

    try:
        with np.errstate(all="raise"):
            here = turned(values)
            u, s, v = np.linalg.svd(slope(0, 0))
            first, row = u[:, :, 0] * s[:, :1], v[:, 0]
            left = np.stack([np.einsum("nij,nj->ni", slope(i, 0), row.conj()) for i in range(p)], 2)
            right = np.stack([np.einsum("ni,nij->nj", first.conj(), slope(0, k)) / s[:, :1] ** 2 for k in range(p)], 1)
    except (ArithmeticError, np.linalg.LinAlgError):
        raise ExpressionError(
            f"{path}", "reference impedance", "references that have an S against a resistance"
        ) from None
    return here, rounding.through(left, right)
