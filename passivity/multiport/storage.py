"""Storage functions: a matrix P >= 0 with x^T P x/2 never growing by more than the energy that enters.

By the Kalman-Yakubovich-Popov lemma a state space is positive real if there is one, that is if

    K(P) = [[A^T P + P A, P B - C^T], [B^T P - C, -D - D^T]] <= 0,   P >= 0.

References
----------
J. C. Willems, "Dissipative dynamical systems, part II", Archive for Rational Mechanics and Analysis 45 (1972), 352-393.
"""

from flint import fmpq_mat

from passivity.multiport.quadratic_form import is_semidefinite
from passivity.multiport.state_space import StateSpace
from passivity.multiport.verdict import StorageCertificate


def lossless_storage(system: StateSpace) -> StorageCertificate | None:
    """The storage function of a system that neither loses nor makes energy, None if it is not such a one.

    K(P) = 0 means P B = C^T and P A = -A^T P, and so P A^k B = (-A^T)^k C^T: where the inputs reach all states, these
    equations leave one P.

    Examples
    --------
    >>> lossless_storage(StateSpace.from_entries([[0, -1], [3, 0]], [[1], [0]], [[1, 0]], [[0]])).storage
    [1,   0]
    [0, 1/3]
    """
    if any((system.d + system.d.transpose()).entries()) or not _starts_lossless(system):
        return None
    basis, reached = system.reached()
    chosen = reached.independent_columns()
    mirrored = StateSpace(-reached.a.transpose(), reached.c.transpose(), reached.b.transpose(), reached.d)
    left, right = reached.krylov(chosen), mirrored.krylov(chosen)
    p = left.transpose().solve(right.transpose()).transpose()
    if p != p.transpose() or any(kyp(reached, p).entries()) or not is_semidefinite(p):
        return None
    return StorageCertificate(system, basis, reached, p)


def _starts_lossless(system: StateSpace) -> bool:
    """C B symmetric and C A B skew: necessary and quickly seen."""
    first, second = system.markov(2)
    return first == first.transpose() and second == -second.transpose()


def kyp(system: StateSpace, p: fmpq_mat) -> fmpq_mat:
    """K(P)."""
    a, b, c, d = system.a, system.b, system.c, system.d
    pa, pb = p * a, p * b - c.transpose()
    upper = [[*x, *y] for x, y in zip((pa + pa.transpose()).tolist(), pb.tolist(), strict=True)]
    lower = [[*x, *y] for x, y in zip(pb.transpose().tolist(), (-d - d.transpose()).tolist(), strict=True)]
    return fmpq_mat(upper + lower)
