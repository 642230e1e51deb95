"""Armstrong's law of seven parameters: stiction that grows with the time of rest, friction that lags velocity."""

from dataclasses import dataclass

from friction.kernel.signals import ARMSTRONG
from friction.spring_contact import SpringContact


@dataclass(frozen=True)
class Armstrong(SpringContact, example=("Armstrong(F_c=0.9).F_s", "1.2")):
    """A spring while it sticks; then F_c + F_v·|v| + P/(1 + (v(t − lag)/v_s)²) against the motion.

    P = P_a + (F_s − F_c − P_a)·t_2/(t_2 + dwell) after a rest of t_2, with P_a its value when the contact came to
    rest; at t = 0 it has rested for ever. It breaks away at F_c + P, and rests from each instant on at which v
    vanishes. B. Armstrong-Hélouvry, P. Dupont and C. Canudas de Wit, Automatica 30 (1994) 1083,
    doi:10.1016/0005-1098(94)90209-7.
    """

    F_c: float = 1.0
    F_s: float = 1.2
    F_v: float = 0.05
    v_s: float = 0.1
    sigma0: float = 500.0
    lag: float = 0.0
    dwell: float = 0.0
    name = "armstrong"
    signal = ARMSTRONG

    @property
    def elements(self) -> list[tuple[float, ...]]:
        """A single row."""
        return [(self.F_c, self.F_s, self.F_v, self.v_s, 0.0, self.sigma0, self.lag, self.dwell)]
