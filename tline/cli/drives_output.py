"""What `tline drives` says and writes: JSON, tables for the eye and as CSV, pictures."""

import csv
import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import click

from tline.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from drives import Run

KINDS = {"--csv": (".csv",), "--plot": (".png", ".svg", ".pdf")}


def check_files(plot: str | None, table: str | None = None) -> None:
    """Refuse what could not be written, before time is spent on it."""
    from tline.solver.result.atomic import check_writable

    for option, file in (("--plot", plot), ("--csv", table)):
        if file is not None:
            if not file.lower().endswith(KINDS[option]):
                raise InputError(option, "unknown kind of file", " or ".join(KINDS[option]), f"'{file}'")
            check_writable(file)


def save_picture(file: str | None, quiet: bool, draw: "Callable[[], Figure]") -> None:
    """Draw into a file, if one is wanted."""
    from tline.pictures.style import save_figure, styled

    if file is not None:
        save_figure(styled(draw)(), file)
        click.echo(f"wrote {file}", err=quiet)


def save_table(file: str | None, quiet: bool, columns: "Mapping[str, NDArray]") -> None:
    """Write columns as CSV in full precision, if it is wanted."""
    from tline.solver.result.atomic import replacing

    if file is not None:
        with replacing(file) as temporary, temporary.open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream)
            writer.writerow(columns)
            writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))
        click.echo(f"wrote {file}", err=quiet)


def print_json(told: Any) -> None:
    """Numbers in full precision; there are no infinities among them."""
    click.echo(json.dumps(told, indent=2, ensure_ascii=False, allow_nan=False))


def run_data(run: "Run") -> dict[str, Any]:
    """A run as numbers."""
    return {
        "t": run.t.tolist(),
        "outputs": {name: values.tolist() for name, values in run.outputs.items()},
        "energy": _balance(run),
        "notes": run.notes,
        "verdicts": run.verdicts,
    }


def say_notes(run: "Run") -> None:
    """What to know beside the numbers, on stderr."""
    for note in run.notes:
        click.echo(f"note: {note}", err=True)


def say_verdicts(verdicts: "Sequence[str]", quiet: bool) -> None:
    """What was asked for and cannot be had, and the exit status for it."""
    for verdict in verdicts if not quiet else ():
        click.echo(verdict)
    if verdicts:
        click.get_current_context().exit(1)


def run_text(run: "Run") -> str:
    """Smallest, largest and last of the samples of each output, and the energy at the end."""
    from drives.picture import ALL_UNITS

    head = ("output", "lowest sample", "highest sample", f"at {run.t[-1]:.6g} s")
    rows: list[tuple[str, ...]] = [head]
    for name, x in run.outputs.items():
        rows.append((f"{name} [{ALL_UNITS[name]}]", *(f"{value:.6g}" for value in (x.min(), x.max(), x[-1]))))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join(map(str.rjust, row, widths)) for row in rows]
    return "\n".join([*lines, "energy [J]: " + ", ".join(f"{key} {value:.6g}" for key, value in _balance(run).items())])


def _balance(run: "Run") -> dict[str, float]:
    """Energies at the end, J."""
    energy = run.energy
    return {
        "stored": float(energy.stored[-1]),
        "dissipated": float(energy.dissipated[-1]),
        "supplied": float(energy.supplied[-1]),
        "imbalance": float(energy.imbalance[-1]),
    }
