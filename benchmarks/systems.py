"""Verdicts on state spaces with many states and ports, into docs/: python -m benchmarks.systems.

Compared in the same run: the H-infinity norm of SLICOT's AB13DD in doubles, and the linear matrix inequality of the
bounded real lemma under Clarabel. All decide whether |S| <= 1. Times are CPU times, medians over the systems.
"""

import warnings
from collections.abc import Callable
from functools import partial
from statistics import median
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.harness import table, timed, write
from passivity import StateSpace, Status, check_bounded_real, verify

SIZES = (10, 2), (20, 2), (20, 8), (50, 4), (100, 8), (200, 8)  # states, ports
NORMS = {"lossy": 0.9, "marginal": 1 - 1e-6, "active": 1.01}  # largest singular value
LARGEST_INEQUALITY = 50  # states; beyond, it takes minutes
SYSTEMS = 4
NORM_ROUNDING = 1e-9  # largest excess over one of a norm in doubles


class System(NamedTuple):
    """System x' = A x + B u, y = C x + D u."""

    a: NDArray
    b: NDArray
    c: NDArray
    d: NDArray


def norm_of(system: System) -> float:
    """Largest singular value on the axis, by AB13DD."""
    import slycot

    n, m = system.b.shape
    return float(slycot.ab13dd("C", "I", "N", "D", n, m, m, system.a, np.eye(n), *system[1:])[0])


def lossless(seed: int, states: int, ports: int) -> System:
    """Scattering of a network of reactances: its norm is one at all frequencies."""
    rng = np.random.default_rng(seed)
    j, b = rng.integers(-9, 10, (states, states)), rng.integers(-3, 4, (states, ports))
    return System((j - j.T - b @ b.T / 2).astype(float), b / 1.0, -b.T / 1.0, np.eye(ports))


def random_system(seed: int, states: int, ports: int, norm: float) -> System:
    """Random system of damped, coupled modes, scaled to a norm."""
    rng = np.random.default_rng(seed)
    j, r = rng.normal(size=(states, states)), rng.normal(size=(states, states)) / np.sqrt(states)
    found = System(
        j - j.T - r @ r.T - 0.1 * np.eye(states),
        rng.normal(size=(states, ports)),
        rng.normal(size=(ports, states)),
        rng.normal(size=(ports, ports)) / 10,
    )
    by = norm / norm_of(found)
    return found._replace(c=by * found.c, d=by * found.d)


def tline(system: System) -> bool | None:
    """Whether the system is proved or refuted, None if neither; a proof is verified outside the timing."""
    verdict = check_bounded_real(StateSpace.from_entries(*(each.tolist() for each in system)))
    return None if verdict.status is Status.UNDECIDED else verdict.status is Status.PROVED


def ab13dd(system: System) -> bool | None:
    return norm_of(system) <= 1 + NORM_ROUNDING


def clarabel(system: System) -> bool | None:
    """Whether there is a P with [-A'P - PA - C'C, -PB - C'D; ., I - D'D] >= 0."""
    import clarabel as solver
    from scipy import sparse

    a, b, c, d = system
    n, m = b.shape
    if n > LARGEST_INEQUALITY:
        return None
    row, column = np.triu_indices(n + m)
    order = np.lexsort((row, column))
    row, column = row[order], column[order]
    scale = np.where(row == column, 1.0, np.sqrt(2.0))

    def entries(matrix: NDArray) -> NDArray:
        return matrix[row, column] * scale

    columns = []
    for i, k in zip(*np.triu_indices(n), strict=True):
        p = np.zeros((n, n))
        p[i, k] = p[k, i] = 1.0
        top = np.hstack([-a.T @ p - p @ a, -p @ b])
        columns.append(entries(np.vstack([top, np.hstack([-b.T @ p, np.zeros((m, m))])])))
    known = np.vstack([np.hstack([-c.T @ c, -c.T @ d]), np.hstack([-d.T @ c, np.eye(m) - d.T @ d])])
    settings = solver.DefaultSettings()
    settings.verbose = False
    size = len(columns)
    found = solver.DefaultSolver(
        sparse.csc_matrix((size, size)), np.zeros(size), sparse.csc_matrix(-np.array(columns).T), entries(known),
        [solver.PSDTriangleConeT(n + m)], settings,
    ).solve()  # fmt: skip
    said = str(found.status)
    return {"Solved": True, "PrimalInfeasible": False}.get(said)


WHO: dict[str, Callable[[System], bool | None]] = {"tline": tline, "AB13DD": ab13dd, "Clarabel": clarabel}


def measured(systems: list[System], passive: bool) -> list[Any]:
    """Share of right answers, and wrong ones, and time, of each program."""
    cells: list[Any] = []
    for who, ask in WHO.items():
        if who == "Clarabel" and len(systems[0].a) > LARGEST_INEQUALITY:
            cells += ["", ""]
            continue
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            answers, seconds = zip(*(timed(partial(ask, system), 1) for system in systems), strict=True)
        wrong = sum(answer is not None and answer != passive for answer in answers)
        right = f"{sum(answer == passive for answer in answers)} of {len(systems)}"
        cells += [right + (f", {wrong} wrong" if wrong else ""), f"{1e3 * median(seconds):.1f}"]
    return cells


def timing() -> str:
    rows = []
    for states, ports in SIZES:
        for name, norm in NORMS.items():
            systems = [random_system(seed, states, ports, norm) for seed in range(SYSTEMS)]
            rows.append((name, states, ports, *measured(systems, norm <= 1)))
        rows.append(
            ("lossless", states, ports, *measured([lossless(k, states, ports) for k in range(SYSTEMS)], passive=True))
        )
    head = "<systems|states|ports|" + "|".join(f"{who}|ms" for who in WHO)
    return table(head, rows)


def proofs_hold() -> str:
    """Compare the time to verify a proof of one of the largest systems with the time to decide it."""
    system = random_system(0, *SIZES[-1], NORMS["lossy"])
    entries = [each.tolist() for each in system]
    verdict, deciding = timed(lambda: check_bounded_real(StateSpace.from_entries(*entries)), 1)
    holds, verifying = timed(lambda: verdict.certificate is not None and verify(verdict.certificate), 1)
    share = verifying / deciding
    return f"The proof of one with {SIZES[-1][0]} states is verified ({holds}) in {share:.2f} of the time of deciding."


if __name__ == "__main__":
    write("benchmarks/pages/passivity.md", f"{timing()}\n\n{proofs_hold()}", "systems")
