"""Frequency answers in files: CSV and Touchstone."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.frequency.response import Response
from tline.solver.result.atomic import replacing, write_columns

TOUCHSTONE = "s{}p"
PARTS = {"re": np.real, "im": np.imag}


def save_response(f: NDArray, probes: Mapping[str, Response], units: tuple[str, str], path: str | Path) -> None:
    """Write transfer functions as CSV: frequency in Hz, then real and imaginary part of effort and flow at each probe.

    `units` are those of effort and flow per unit of the source, such as ("V/V", "A/V").

    Raises
    ------
    InputError
        The file cannot be written.
    """
    columns = {"frequency [Hz]": f}
    for name, seen in probes.items():
        for letter, values, unit in (("u", seen.u, units[0]), ("y", seen.y, units[1])):
            columns |= {
                f"{name} re {letter} [{unit}]": np.real(values),
                f"{name} im {letter} [{unit}]": np.imag(values),
            }
    write_columns(path, columns)


def save_parameters(f: NDArray, S: NDArray, ports: Sequence[str], z0: float, path: str | Path) -> None:
    """Write S-parameters, shape (n, p, p), as CSV, or as Touchstone 1 where the suffix is ``.sNp``.

    Raises
    ------
    InputError
        The suffix does not fit the number of ports, or the file cannot be written.
    """
    suffix, count = Path(path).suffix.lower(), len(ports)
    if suffix == ".csv":
        entries = {f"S({i},{j})": S[:, m, n] for m, i in enumerate(ports) for n, j in enumerate(ports)}
        parts = {f"{part} {name} [1]": of(values) for name, values in entries.items() for part, of in PARTS.items()}
        write_columns(path, {"frequency [Hz]": f} | parts)
        return
    if suffix != f".{TOUCHSTONE.format(count)}":
        raise InputError(str(path), "does not fit the number of ports", f".{TOUCHSTONE.format(count)} or .csv", suffix)
    order = S.swapaxes(1, 2) if count == 2 else S  # of two ports S21 comes before S12
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8") as file:
        file.write(f"! ports: {', '.join(ports)}\n# Hz S RI R {z0:.17g}\n")
        for frequency, matrix in zip(f, order, strict=True):
            rows = [_interleaved(row[None, :])[0] for row in ([matrix.ravel()] if count <= 2 else matrix)]
            for k, row in enumerate(rows):
                for start in range(0, len(row), 8):  # four pairs on a line
                    head = f"{frequency:.17g}" if k == start == 0 else ""
                    file.write(" ".join([head, *(f"{x:.17g}" for x in row[start : start + 8])]).strip() + "\n")


def _interleaved(values: NDArray) -> NDArray:
    """Real and imaginary parts beside each other, shape (n, 2 m)."""
    return np.stack([np.real(values), np.imag(values)], axis=2).reshape(len(values), -1)
