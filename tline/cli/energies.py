"""What `tline run --ledger` prints."""

from typing import Any

from tline.pictures.handy import handy
from tline.solver.ledger.ledger import COLUMNS, TOLERANCE, Entry, Ledger
from tline.words.aligned import aligned

SHOWN = 30  # accounts; of more, those with the largest numbers
QUIET = 1e-9  # of the turnover; accounts with nothing beyond it are left out


def ledger_as_dict(ledger: Ledger) -> dict[str, Any]:
    """All accounts, J, and the residual."""
    return {
        "turnover": ledger.turnover,
        "residual": ledger.residual,
        "total": _numbers(ledger.total),
        "accounts": {entry.where: _numbers(entry) for entry in ledger.entries},
    }


def _numbers(entry: Entry) -> dict[str, float]:
    return {column: number for column, number in entry._asdict().items() if column != "where"}


def ledger_as_table(ledger: Ledger) -> str:
    """The same for the eye, in handy units."""
    size, unit = handy(ledger.turnover, "J")
    worth = sorted(ledger.entries, key=_largest, reverse=True)[:SHOWN]
    kept = {entry.where for entry in worth if _largest(entry) > QUIET * ledger.turnover}
    shown = [entry for entry in ledger.entries if entry.where in kept]
    rows = [[f"energy [{unit}]", *COLUMNS]]
    for entry in (*shown, ledger.total):
        numbers = [getattr(entry, column) for column in COLUMNS]
        rows.append([entry.where, *(f"{x / size:.4g}" if abs(x) > QUIET * ledger.turnover else "0" for x in numbers)])
    closes = "closes" if ledger.residual <= TOLERANCE else "does NOT close"
    last = f"the ledger {closes}: {ledger.residual:.1g} of the energy turned over is not accounted for"
    missing = len(ledger.entries) - len(shown)
    left_out = (
        [f"{missing} accounts with less are not shown"]
        if any(_largest(entry) > QUIET * ledger.turnover for entry in ledger.entries if entry.where not in kept)
        else []
    )
    return "\n".join([*aligned(rows, 1), *left_out, last])


def _largest(entry: Entry) -> float:
    return max(abs(getattr(entry, column)) for column in COLUMNS)
