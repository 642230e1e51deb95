"""Friction models: their parameters, and the steady force over velocity.

Symbols are those of the papers: F_c Coulomb friction, F_s break-away force (stiction), F_v viscous friction, v_s
Stribeck velocity, σ0, σ1, σ2 stiffness, damping and viscous friction of the bristles. All SI. Defaults are the
exercise's numbers.
"""

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from friction.parameters import TOLD, Parameters
from tline.errors import InputError, as_numbers

if TYPE_CHECKING:
    from friction.kernel.law import Law


@dataclass(frozen=True)
class Model(Parameters):
    """A friction law."""

    name: ClassVar[str]
    kind: ClassVar[str]  # its constant in the kernels
    place = "model"

    def __init_subclass__(cls):
        super().__init_subclass__((f"{cls.__name__}(F_c=0.9).sliding", "0.9"))

    @property
    def sliding(self) -> float:
        """F_c [N]."""
        return getattr(self, "F_c")  # noqa: B009

    @property
    def stiction(self) -> float:
        """F_s [N]; F_c for the models without a peak."""
        return getattr(self, "F_s", self.sliding)

    @property
    def law(self) -> "Law":
        """Parameters in the form of the kernels."""
        from friction.kernel import law

        own = {field.name: getattr(self, field.name) for field in fields(self)}
        own.pop("F_s", None)
        viscous = own.pop("F_v", 0.0) + own.pop("sigma2", 0.0)  # no model has both
        return law.Law(getattr(law, self.kind), own.pop("F_c"), self.stiction, viscous, own.pop("v_s", 1.0), **own)

    def g(self, v: ArrayLike) -> NDArray:
        """Stribeck curve g(v) = F_c + (F_s − F_c)·e^(−(v/v_s)²) [N]: steady friction without its viscous part."""
        law = self.law
        return law.f_c + (law.f_s - law.f_c) * np.exp(-((as_numbers("v", v) / law.v_s) ** 2))

    def steady_force(self, v: ArrayLike) -> NDArray:
        """Friction force [N] at velocities v [m/s] that do not change: g(v)·sign v + F_v·v.

        Examples
        --------
        >>> from friction import LuGre
        >>> float(LuGre().steady_force(2.0))
        1.1
        """
        v = as_numbers("v", v)
        return self.g(v) * np.sign(v) + self.law.f_v * v


@dataclass(frozen=True)
class Coulomb(Model):
    """F_c·sign v + F_v·v, and at rest the force that holds the mass, up to F_c.

    Solvers that know nothing of events get the bare law, with sign 0 = 0. C. A. Coulomb, Théorie des machines simples
    (1785).
    """

    name = "coulomb"
    kind = "SIGN"
    F_c: float = 1.0
    F_v: float = 0.0


@dataclass(frozen=True)
class Karnopp(Model):
    """Stiction, Stribeck and viscous friction; within |v| <= δ the mass is held as long as |F_a| <= F_s.

    δ = 0 is the law itself, for which rest is an event; δ > 0 is Karnopp's dead zone, which spares the solver the event
    and lets the mass creep. D. Karnopp, J. Dyn. Sys. Meas. Control 107 (1985) 100, doi:10.1115/1.3140698; Stribeck
    curve as in H. Olsson et al., Eur. J. Control 4 (1998) 176, doi:10.1016/S0947-3580(98)70113-X.
    """

    name = "karnopp"
    kind = "ZONE"
    F_c: float = 1.0
    F_s: float = 1.2
    F_v: float = 0.05
    v_s: float = 0.1
    delta: float = 0.0


@dataclass(frozen=True)
class LuGre(Model):
    """ż = v − σ0·|v|·z/g(v), F_f = σ0·z + σ1·ż + σ2·v, with z a length and σ0 outside g, not inside.

    Steady sliding, ż = 0, gives σ0·z = g(v)·sign v and F_f = g(v)·sign v + σ2·v: the Stribeck law, if g is its curve
    and σ2 its F_v. C. Canudas de Wit et al., IEEE Trans. Autom. Control 40 (1995) 419, doi:10.1109/9.376053.
    """

    name = "lugre"
    kind = "BRISTLE"
    F_c: float = 1.0
    F_s: float = 1.2
    v_s: float = 0.1
    sigma0: float = 500.0
    sigma1: float = 0.0
    sigma2: float = 0.05


@dataclass(frozen=True)
class Dahl(Model):
    """ż = v − σ0·|v|·z/F_c, F_f = σ0·z: LuGre without peak, damping and viscous friction.

    P. R. Dahl, AIAA Journal 14 (1976) 1675, doi:10.2514/3.61511.
    """

    name = "dahl"
    kind = "BRISTLE"
    F_c: float = 1.0
    sigma0: float = 500.0


@dataclass(frozen=True)
class ElastoPlastic(Model):
    """LuGre whose bristles do not slip below the deflection z_ba [m]: ż = v − α(z, v)·σ0·|v|·z/g(v), α = 0 there.

    P. Dupont et al., IEEE Trans. Autom. Control 47 (2002) 787, doi:10.1109/TAC.2002.1000274.
    """

    name = "elasto-plastic"
    kind = "BRISTLE"
    F_c: float = 1.0
    F_s: float = 1.2
    v_s: float = 0.1
    sigma0: float = 500.0
    sigma1: float = 0.0
    sigma2: float = 0.05
    z_ba: float = 0.0015

    def __post_init__(self):
        super().__post_init__()
        if self.z_ba >= self.F_c / self.sigma0:
            raise InputError(
                "model.z_ba", "too large", f"less than F_c/σ0 = {self.F_c / self.sigma0:g}", f"{self.z_ba:g}"
            )


@dataclass(frozen=True)
class Tanh(Model):
    """g(v)·tanh(v/ε) + F_v·v: smooth, and never at rest under load."""

    name = "tanh"
    kind = "TANH"
    F_c: float = 1.0
    F_s: float = 1.2
    F_v: float = 0.05
    v_s: float = 0.1
    epsilon: float = 0.001

    def steady_force(self, v: ArrayLike) -> NDArray:
        """Friction force [N] at velocities v [m/s]."""
        v = as_numbers("v", v)
        return self.g(v) * np.tanh(v / self.epsilon) + self.F_v * v


MODELS: dict[str, type[Model]] = {model.name: model for model in (Coulomb, Karnopp, LuGre, Dahl, ElastoPlastic, Tanh)}
UNITS = {name: told.unit for name, told in TOLD.items() if any(name in vars(model) for model in MODELS.values())}
