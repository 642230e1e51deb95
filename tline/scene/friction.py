"""Friction in pipes, by kinds."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from math import log, pi
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationInfo

from tline.errors import InputError
from tline.loss import ConstantLoss, LaminarFriction, Law, TurbulentFriction, hagen_poiseuille
from tline.loss.losses import Curve
from tline.scene.choice import Read, validator
from tline.scene.element import Element
from tline.scene.quantity import Quantity, Role
from tline.wording import nearest, shown

LAMINAR = 2040.0  # Reynolds number up to which flow counts as laminar, as in fluids.friction
SLOWEST, FASTEST = 1e-200, 1e9  # Reynolds numbers; beyond the latter the friction factor stays
PER_OCTAVE = 64

Viscosity = Annotated[Quantity, Role("dynamic viscosity", "Pa s", above=0)]


class Friction(Element):
    """What the flow loses at the wall of a pipe."""

    def law(self, density: float, area: float) -> Law | None:
        """What is linear of it, an impedance per metre."""
        return None

    def quadratic(self, density: float, area: float) -> float:
        """K of a drop of pressure K |y| y per metre."""
        return 0.0

    def curve(self, density: float, area: float) -> Curve | None:
        """Any other drop of pressure per metre, over the size of the flow."""
        return None


class Linear(Friction):
    """A drop of pressure proportional to the flow."""

    kind: Literal["linear"] = "linear"
    resistance: Annotated[Quantity, Role("resistance per metre", "Pa s/m^4", at_least=0)] = Field(
        description="drop of pressure per metre and flow"
    )

    def law(self, density: float, area: float) -> Law:  # noqa: D102
        return ConstantLoss(self.resistance)


class Laminar(Friction):
    """Laminar friction as in steady flow (Hagen, Poiseuille)."""

    kind: Literal["laminar"] = "laminar"
    viscosity: Viscosity = Field(description="dynamic viscosity")

    def law(self, density: float, area: float) -> Law:  # noqa: D102
        return ConstantLoss(hagen_poiseuille(density, self.viscosity, (area / pi) ** 0.5).loss)


class Zielke(Friction):
    """Laminar friction, right for changes of any speed (Zielke)."""

    kind: Literal["zielke"] = "zielke"
    viscosity: Viscosity = Field(description="dynamic viscosity")

    def law(self, density: float, area: float) -> Law:  # noqa: D102
        return LaminarFriction(density, self.viscosity, (area / pi) ** 0.5)


class Darcy(Friction):
    """Turbulent friction with a constant friction factor (Darcy, Weisbach)."""

    kind: Literal["darcy"] = "darcy"
    factor: Annotated[Quantity, Role("friction factor", "", above=0, at_most=1e9)] = Field(
        description="Darcy friction factor, four times Fanning's"
    )

    def quadratic(self, density: float, area: float) -> float:  # noqa: D102
        return darcy(self.factor, density, area)


class QuasiSteady(Friction):
    """Friction as in steady flow of the same speed, laminar or turbulent."""

    kind: Literal["quasi-steady"] = "quasi-steady"
    viscosity: Viscosity = Field(description="dynamic viscosity")
    roughness: Annotated[Quantity, Role("roughness", "m", at_least=0)] = Field(description="of the wall, 0 if smooth")

    def curve(self, density: float, area: float) -> Curve:  # noqa: D102
        return SteadyDrop(density, area, self.viscosity, self.roughness)


class VardyBrown(QuasiSteady):
    """The same, and what turbulent friction adds while the flow changes (Vardy, Brown)."""

    kind: Literal["vardy-brown"] = "vardy-brown"  # pyright: ignore[reportIncompatibleVariableOverride]
    reynolds: Annotated[Quantity, Role("Reynolds number", "", at_least=2e3, at_most=1e8)] = Field(
        description="Reynolds number of the flow about which it changes"
    )

    def law(self, density: float, area: float) -> Law:  # noqa: D102
        return TurbulentFriction(density, self.viscosity, (area / pi) ** 0.5, self.reynolds)


@dataclass(frozen=True)
class SteadyDrop:
    """Drop of pressure per metre in steady flow; all in SI."""

    density: float
    area: float
    viscosity: float
    roughness: float

    def __call__(self, flow: NDArray) -> tuple[NDArray, NDArray]:
        """Drop and its slope at flows from 0 on."""
        diameter = 2 * (self.area / pi) ** 0.5
        reynolds = flow * self.density * diameter / (self.viscosity * self.area)
        factor, exponent = friction_factors(self.roughness / diameter, np.maximum(reynolds, SLOWEST))
        each = darcy(1.0, self.density, self.area) * factor * flow
        return each * flow, (2 + exponent) * each


def darcy(factor: float, density: float, area: float) -> float:
    """ρ f/(2 d A²), so that the drop of pressure per metre is this times |y| y."""
    return density * factor / (4 * (area / pi) ** 0.5 * area**2)


def friction_factors(relative_roughness: float, reynolds: NDArray) -> tuple[NDArray, NDArray]:
    """Darcy's friction factor f and d ln f/d ln Re, for Re above 0: 64/Re in laminar flow, else interpolated."""
    first, step, y = _turbulent(relative_roughness)
    at = np.clip((np.log(reynolds) - first) / step, 0, len(y) - 1)
    k = np.minimum(at.astype(int), len(y) - 2)
    turbulent = reynolds > LAMINAR
    value = np.where(turbulent, np.exp(y[k] + (at - k) * (y[k + 1] - y[k])), 64 / reynolds)
    return value, np.where(turbulent, np.where(at < len(y) - 1, (y[k + 1] - y[k]) / step, 0.0), -1.0)


@lru_cache
def _turbulent(relative_roughness: float) -> tuple[float, float, NDArray]:
    """ln f over evenly spaced ln Re: the first, their distance, and the values.

    References
    ----------
    D. Clamond, Industrial & Engineering Chemistry Research 48 (2009) 3665-3671, doi:10.1021/ie801626g: Colebrook's
    equation, which `fluids.friction.friction_factor` solves.
    """
    from fluids.friction import friction_factor

    x = np.linspace(log(LAMINAR), log(FASTEST), int(PER_OCTAVE * log(FASTEST / LAMINAR) / log(2)))
    factors = [friction_factor(Re=float(each) * (1 + 1e-12), eD=relative_roughness) for each in np.exp(x)]
    return float(x[0]), float(x[1] - x[0]), np.log(factors)


KINDS: dict[str, type[Friction]] = {
    model.model_fields["kind"].default: model for model in (Linear, Laminar, Zielke, Darcy, QuasiSteady, VardyBrown)
}


def _of_kind(value: Any, info: ValidationInfo) -> Friction:
    if isinstance(value, Friction):
        return value
    if not isinstance(value, Mapping):
        raise InputError("", "not a table", f"kind = {nearest('', [*KINDS])} with its keys", shown(value))
    kind = value.get("kind")
    if not isinstance(kind, str) or kind not in KINDS:
        missing = kind is None
        expected = nearest("" if missing else str(kind), [*KINDS])
        raise InputError("kind", "is missing" if missing else "unknown", expected, "" if missing else shown(kind))
    return validator(KINDS[kind]).validate_python(value, context=info.context)


AnyFriction = Annotated[Friction, Read(_of_kind, Linear | Laminar | Zielke | Darcy | QuasiSteady | VardyBrown)]
