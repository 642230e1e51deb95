"""State spaces with exact entries and named states, and their controllable and observable parts."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from flint import fmpq_mat, fmpq_poly
from numpy.typing import NDArray

from drives.number import roots, written
from tline.errors import import_extra
from tline.presentation import Presentation, plain


@dataclass(frozen=True, eq=False, repr=False)
class StateSpace(Presentation):
    """x' = A x + B u, y = C x + D u.

    Parameters
    ----------
    a, b, c, d : flint.fmpq_mat
        Exact matrices, shapes (n, n), (n, m), (p, n), (p, m); `A`, `B`, `C`, `D` are the nearest floats.
    states, inputs, outputs : tuple of str
        Names; after `minimal` a state is named after the entry of the full state that it is on its own.

    Examples
    --------
    >>> from drives import CoupledDrives
    >>> small = CoupledDrives().state_space(("tension",)).minimal()
    >>> small
    states z1, e_p; inputs T1, T2; outputs tension
      poles -495.967, -4.03252 rad/s
    """

    a: fmpq_mat
    b: fmpq_mat
    c: fmpq_mat
    d: fmpq_mat
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]

    def text_lines(self) -> Iterator[str]:
        """Names, and the poles; the matrices are attributes."""
        yield "; ".join(f"{kind} {', '.join(getattr(self, kind))}" for kind in ("states", "inputs", "outputs"))
        yield f"  poles {', '.join(map(written, self.poles))} rad/s"

    def to_dict(self) -> dict[str, Any]:
        """Names, matrices as floats, and poles."""
        return {name: plain(getattr(self, name)) for name in ("states", "inputs", "outputs", *"ABCD", "poles")}

    @property
    def A(self) -> NDArray[np.float64]:
        """State matrix, (n, n)."""
        return floats(self.a)

    @property
    def B(self) -> NDArray[np.float64]:
        """Input matrix, (n, m)."""
        return floats(self.b)

    @property
    def C(self) -> NDArray[np.float64]:
        """Output matrix, (p, n)."""
        return floats(self.c)

    @property
    def D(self) -> NDArray[np.float64]:
        """Feedthrough, (p, m)."""
        return floats(self.d)

    @cached_property
    def modes(self) -> fmpq_poly:
        """det(sI - A)."""
        return self.a.charpoly()

    @cached_property
    def poles(self) -> list[complex]:
        """Eigenvalues of A with their multiplicity, rad/s; zeros are exact zeros, see `drives.number.roots`.

        Examples
        --------
        >>> from drives import CoupledDrives
        >>> [round(p.real, 6) for p in CoupledDrives().state_space().poles]
        [-495.967478, -100.0, -100.0, -100.0, -4.032522, 0.0]
        """
        return roots(self.modes)

    def reached(self) -> "StateSpace":
        """The part that the inputs reach: in a basis V of the states they reach, with A V = V A1 and B = V B1.

        Wonham, Linear Multivariable Control, 3rd ed., section 1.2, doi:10.1007/978-1-4612-1082-5.
        """
        n = self.a.nrows()
        rows: list[list[Any]] = []
        power = self.b
        for _ in range(n):
            rows += power.transpose().tolist()
            power = self.a * power
        echelon, rank = fmpq_mat(rows).rref() if n else (self.b, 0)
        basis = echelon.tolist()[:rank]
        pivots = [next(k for k in range(n) if row[k] != 0) for row in basis]
        v = fmpq_mat(basis).transpose() if rank else fmpq_mat(n, 0)
        a, b = (chosen_rows(x, pivots) for x in (self.a * v, self.b))
        alone = [sum(x != 0 for x in row) == 1 for row in basis]
        names = tuple(
            self.states[p] if one else f"z{k + 1}" for k, (p, one) in enumerate(zip(pivots, alone, strict=True))
        )
        return StateSpace(a, b, self.c * v, self.d, names, self.inputs, self.outputs)

    def dual(self) -> "StateSpace":
        """(A^T, C^T, B^T, D^T)."""
        a, b, c, d = (x.transpose() for x in (self.a, self.c, self.b, self.d))
        return StateSpace(a, b, c, d, self.states, self.outputs, self.inputs)

    def minimal(self) -> "StateSpace":
        """Controllable and observable part, exact: the same transfer matrix without hidden modes.

        Examples
        --------
        >>> from drives import CoupledDrives
        >>> CoupledDrives().state_space(("tension", "belt_speed")).minimal().A.shape
        (3, 3)
        """
        return self.reached().dual().reached().dual()

    def transfer(self, row: int, column: int) -> tuple[fmpq_poly, fmpq_poly]:
        """Numerator and det(sI - A) of one entry of D + C (sI - A)^-1 B, nothing cancelled."""
        n = self.a.nrows()
        c, x = chosen_rows(self.c, [row]), chosen_rows(self.b.transpose(), [column]).transpose()
        markov = []
        for _ in range(n):
            markov.append((c * x)[0, 0])
            x = self.a * x
        series = fmpq_poly(markov[::-1]) * self.modes
        return fmpq_poly(series.coeffs()[n:]) + self.modes * self.d[row, column], self.modes

    def to_control(self) -> Any:
        """Convert to `control.StateSpace`, with the package control."""
        control = import_extra("control", "python-control", "control", "to_control")

        names = {"states": list(self.states), "inputs": list(self.inputs), "outputs": list(self.outputs)}
        return control.StateSpace(self.A, self.B, self.C, self.D, remove_useless_states=False, **names)

    def to_scipy(self) -> Any:
        """Convert to `scipy.signal.StateSpace`."""
        from scipy.signal import StateSpace as Scipy

        return Scipy(self.A, self.B, self.C, self.D)


def floats(matrix: fmpq_mat) -> NDArray[np.float64]:
    """The nearest floats."""
    entries = [int(x.p) / int(x.q) for x in matrix.entries()]
    return np.array(entries).reshape(matrix.nrows(), matrix.ncols())


def chosen_rows(matrix: fmpq_mat, chosen: list[int]) -> fmpq_mat:
    """Some rows of a matrix."""
    rows = matrix.tolist()
    return fmpq_mat(len(chosen), matrix.ncols(), [x for k in chosen for x in rows[k]])
