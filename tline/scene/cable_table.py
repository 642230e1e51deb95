"""Cables by tables of R(f) and L(f), and perhaps G(f) and C(f), per metre."""

from functools import lru_cache
from typing import Annotated

from pydantic import Field, PrivateAttr, ValidationInfo, model_validator

from tline.errors import InputError
from tline.loss import Foster, tabulated
from tline.scene.csv_rows import read_rows
from tline.scene.element import Element
from tline.scene.named_file import beside
from tline.scene.quantity import Quantity, Role

COLUMNS = {3: "frequency, R, L", 5: "frequency, R, L, G, C"}
Rows = tuple[tuple[float, ...], ...]


class CableTable(Element):
    """Frequencies in ascending order, Hz, R in ohm/m and L in H/m, perhaps G in S/m and C in F/m, in a CSV file.

    The line is the causal and passive one that is nearest to the table; one that is not within the tolerance of it is
    refused. z0 and delay, which a front meets, are those at infinite frequency.
    """

    file: str = Field(description="CSV file, looked for beside the scene file; a first line of words is skipped")
    tolerance: Annotated[Quantity, Role("tolerance", "", at_least=1e-12, at_most=0.5)] = Field(
        default=Quantity(0.01, ""), description="largest difference of line and table, relative, of R + jωL and G + jωC"
    )
    _laws: tuple[Foster, ...] = PrivateAttr()

    @property
    def series(self) -> Foster:
        """R and L as a law."""
        return self._laws[0]

    @property
    def shunt(self) -> Foster | None:
        """G and C, if the table has them."""
        return self._laws[1] if len(self._laws) > 1 else None

    @model_validator(mode="after")
    def _read(self, info: ValidationInfo):
        path = beside(self.file, info)
        rows = tuple(read_rows(path, "file", "a row of the table", COLUMNS))
        columns = len(rows[0]) if rows else 3
        self._laws = tuple(_fitted(rows, first, float(self.tolerance)) for first in range(1, columns, 2))
        return self


@lru_cache
def _fitted(rows: Rows, first: int, tolerance: float) -> Foster:
    """The law of two columns; its errors name them."""
    names = COLUMNS[5].split(", ")
    try:
        frequencies, loss, storage = ([row[k] for row in rows] for k in (0, first, first + 1))
        law = tabulated(frequencies, loss, storage, tolerance)
    except InputError as error:
        problem = f"{names[first]} and {names[first + 1]}: {error.problem}"
        raise InputError("file", problem, error.expected, error.got) from None
    if law.storage == 0:
        problem = f"{names[first + 1]} falls to nothing at high frequency, and a front has no speed"
        raise InputError("file", problem, "frequencies up to where it stays")
    return law
