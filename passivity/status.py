"""What can be asked of a function, and how the question can end."""

from base64 import b64encode
from enum import StrEnum
from html import escape
from io import BytesIO
from typing import TYPE_CHECKING, Any, NoReturn

from passivity.errors import ExpressionError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCREEN = 24  # lines that are printed


class Kind(StrEnum):
    """Which property is asked for."""

    PR = "positive real"  # Z analytic and Re Z >= 0 in Re s > 0: an impedance
    BR = "bounded real"  # H analytic and |H| <= 1 in Re s > 0: a reflection

    @property
    def letter(self) -> str:
        """By which such a function goes."""
        return "Z" if self is Kind.PR else "H"


class Status(StrEnum):
    """How the question ended."""

    PROVED = "proved"
    REFUTED = "refuted"
    UNDECIDED = "undecided"
    NO_VIOLATION = "no violation seen"  # in samples, which never prove

    def __bool__(self) -> NoReturn:
        raise TypeError("a status is neither true nor false, expected a comparison such as `is Status.PROVED`")


class Decided:
    """An answer with a status, of which there are more than two: so it is neither true nor false.

    Printed it says what the command line says, in one screen; a notebook shows the picture too, where there is one.
    """

    status: Status

    @property
    def proved(self) -> bool:
        """Whether the property is proved."""
        return self.status is Status.PROVED

    @property
    def refuted(self) -> bool:
        """Whether the property is refuted."""
        return self.status is Status.REFUTED

    def lines(self) -> list[str]:
        """The answer in words, line by line."""
        why = getattr(self, "why", "")
        return [self.status.value, f"  because {why}"] if why else [self.status.value]

    def to_dict(self) -> dict[str, Any]:
        """All of it as JSON can hold it."""
        return {"status": self.status.value, "why": getattr(self, "why", "")}

    def plot(self) -> "Figure":
        """The picture: the impedance plane and Smith chart, or samples against their bound.

        Raises
        ------
        ExpressionError
            If there is none.
        """
        raise ExpressionError("plot", "there is no picture of this", "a rational function of one port, or samples")

    def _repr_html_(self) -> str:
        text = f"<pre>{escape(str(self))}</pre>"
        try:
            figure = self.plot()
        except (ExpressionError, ImportError):
            return text
        image = BytesIO()
        figure.savefig(image, format="png")
        return f'{text}<img src="data:image/png;base64,{b64encode(image.getvalue()).decode()}"/>'

    def __str__(self) -> str:
        told = self.lines()
        more = len(told) - SCREEN
        return "\n".join(told if more <= 0 else [*told[: SCREEN - 1], f"  … and {more + 1} more lines: .lines()"])

    def __bool__(self) -> NoReturn:
        raise TypeError("a verdict is neither true nor false, expected its .proved, .refuted or .status")
