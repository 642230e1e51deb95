"""Frequency answers in files: CSV and Touchstone."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.frequency.response import Response
from tline.solver.result.atomic import replacing

TOUCHSTONE = "s{}p"


def save_response(f: NDArray, probes: Mapping[str, Response], units: tuple[str, str], path: str | Path) -> None:
    """Write transfer functions as CSV: frequency in Hz, then real and imaginary part of effort and flow at each probe.

    `units` are those of effort and flow per unit of the source, such as ("V/V", "A/V").

    Raises
    ------
    InputError
        The file cannot be written.
    """
    columns, names = [f], ["frequency [Hz]"]
    for name, seen in probes.items():
        for letter, values, unit in (("u", seen.u, units[0]), ("y", seen.y, units[1])):
            columns += [np.real(values), np.imag(values)]
            names += [f"{name} re {letter} [{unit}]", f"{name} im {letter} [{unit}]"]
    _write(path, names, np.stack(columns, axis=1))


def save_parameters(f: NDArray, S: NDArray, ports: Sequence[str], z0: float, path: str | Path) -> None:
    """Write S-parameters, shape (n, p, p), as CSV, or as Touchstone 1 where the suffix is ``.sNp``.

    Raises
    ------
    InputError
        The suffix does not fit the number of ports, or the file cannot be written.
    """
    suffix, count = Path(path).suffix.lower(), len(ports)
    if suffix == ".csv":
        names = [f"{part} S({i},{j}) [1]" for i in ports for j in ports for part in ("re", "im")]
        flat = S.reshape(len(f), -1)
        _write(path, ["frequency [Hz]", *names], np.column_stack([f, _interleaved(flat)]))
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


def _write(path: str | Path, names: list[str], rows: NDArray) -> None:
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8") as file:
        file.write(",".join(f'"{name}"' if "," in name else name for name in names) + "\n")
        np.savetxt(file, rows, fmt="%.17g", delimiter=",")
