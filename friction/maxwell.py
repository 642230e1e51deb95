"""Maxwell slip: springs in parallel, each sliding at its own limit; a hysteresis with non-local memory."""

from collections.abc import Sequence
from dataclasses import dataclass

from friction.kernel.signals import MAXWELL
from friction.parameters import check_number
from friction.spring_contact import SpringContact
from tline.errors import InputError


@dataclass(frozen=True)
class MaxwellSlip(SpringContact):
    """Generalised Maxwell slip: elements that stick like springs until their limit, then slide at it until v turns.

    Element i sticks with F_i growing by k_i·v, up to W_i·g(v)/F_c, where g is the Stribeck curve; there it slides, with
    that force, until the velocity vanishes. F_f = Σ F_i + F_v·v. With F_s = F_c (`peak` = 1) the force depends on the
    place at past turns alone: the elements are play operators, and loops follow Masing's rules. Without the lag of
    friction behind the velocity in slip, the limit of infinite attraction of F. Al-Bender, V. Lampaert and J. Swevers,
    IEEE Trans. Autom. Control 50 (2005) 1883, doi:10.1109/TAC.2005.858676.

    Parameters
    ----------
    stiffness : sequence of float
        Of each element, k_i [N/m], positive.
    limits : sequence of float
        Force at which each slides quickly, W_i [N], positive; their sum is F_c.
    peak : float, optional
        Ratio F_s/F_c, at least 1.
    v_s : float, optional
        Stribeck velocity [m/s], positive.
    F_v : float, optional
        Viscous friction [N s/m].

    Raises
    ------
    InputError
        A number is out of range, or stiffness and limits are not of one length.

    Examples
    --------
    >>> from friction import MaxwellSlip, Sine, prescribe
    >>> law = MaxwellSlip([1000.0, 500.0], [0.4, 0.6])
    >>> round(float(prescribe(law, position=Sine(0.001, 1.0), times=[0.25]).F_f[0]), 12)
    0.9
    """

    stiffness: Sequence[float]
    limits: Sequence[float]
    peak: float = 1.0
    v_s: float = 0.1
    F_v: float = 0.0

    name = "maxwell-slip"
    signal = MAXWELL

    def __post_init__(self):
        if len(self.stiffness) != len(self.limits) or not len(self.limits):
            raise InputError(
                "model.limits", "not one for each stiffness", f"{len(self.stiffness)}", f"{len(self.limits)}"
            )
        for name in ("stiffness", "limits"):
            for k, value in enumerate(getattr(self, name)):
                check_number(f"model.{name}[{k}]", value, above=0.0)
            object.__setattr__(self, name, tuple(getattr(self, name)))
        check_number("model.peak", self.peak, least=1.0)
        check_number("model.v_s", self.v_s, above=0.0)
        check_number("model.F_v", self.F_v, least=0.0)

    @property
    def viscous(self) -> float:
        """Viscous friction beside the elements [N s/m]."""
        return self.F_v

    @property
    def elements(self) -> list[tuple[float, ...]]:
        """A row for each element."""
        limits = zip(self.limits, self.stiffness, strict=True)
        return [(w, self.peak * w, 0.0, self.v_s, 0.0, k, 0.0, 0.0) for w, k in limits]
