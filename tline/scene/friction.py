"""Friction models of pipes."""

from collections.abc import Mapping
from dataclasses import replace
from functools import reduce
from math import pi
from operator import or_
from typing import Annotated, Any, Literal

from pydantic import ValidationInfo, model_validator

from tline.errors import InputError
from tline.loss import ChangingLaminarFriction, ConstantLoss, LaminarFriction, Law, TurbulentFriction, hagen_poiseuille
from tline.loss.flow_law import Colebrook, FlowLaw, PowerLaw, RoughPipe, SwameeJain, quadratic
from tline.scene.alike import content
from tline.scene.element import Element, optional, required
from tline.scene.mistakes import Read, validator
from tline.scene.quantity import GRAVITY, Length, Quantity, Role
from tline.words.wording import nearest, shown

FOOT = 0.3048  # m; the Hazen-Williams law of EPANET is in feet

Viscosity = Annotated[Quantity, Role("dynamic viscosity", "Pa s", above=0)]
Reynolds = Annotated[Quantity, Role("Reynolds number", "", at_least=2e3, at_most=1e8)]
Roughness = Annotated[Quantity, Role("roughness", "m", at_least=0)]


class Friction(Element):
    """Friction at the wall of a pipe."""

    def law(self, density: float, area: float) -> Law | None:
        """Linear part of the friction, an impedance per metre."""
        return None

    def flow_law(self, density: float, area: float, length: float) -> FlowLaw | None:
        """Non-linear part of the friction, a pressure drop per metre of a pipe of that length."""
        return None


class Linear(Friction):
    """Pressure drop proportional to the flow."""

    kind: Literal["linear"] = "linear"
    resistance: Annotated[Quantity, Role("resistance per metre", "Pa s/m^4", at_least=0)] = required(
        "drop of pressure per metre and flow"
    )

    def law(self, density: float, area: float) -> Law:  # noqa: D102
        return ConstantLoss(self.resistance)


class Laminar(Friction):
    """Laminar friction as in steady flow (Hagen, Poiseuille)."""

    kind: Literal["laminar"] = "laminar"
    viscosity: Viscosity = required("dynamic viscosity")

    def law(self, density: float, area: float) -> Law:  # noqa: D102
        return ConstantLoss(hagen_poiseuille(density, self.viscosity, (area / pi) ** 0.5).loss)


class Zielke(Friction):
    """Laminar friction with the frequency dependence of unsteady flow (Zielke)."""

    kind: Literal["zielke"] = "zielke"
    viscosity: Viscosity = required("dynamic viscosity")

    def law(self, density: float, area: float) -> Law:  # noqa: D102
        return LaminarFriction(density, self.viscosity, (area / pi) ** 0.5)


class Unsteady(Element):
    """Unsteady friction of a pipe, in addition to a law of steady flow."""

    kind: Literal["vardy-brown", "zielke"] = required("'vardy-brown' in turbulent flow, 'zielke' in laminar")
    viscosity: Viscosity = required("dynamic viscosity")
    reynolds: Reynolds | None = optional(
        "Reynolds number of the flow about which it changes; needed with 'vardy-brown'"
    )
    roughness: Roughness = optional("of the wall, 0 if smooth", Quantity(0.0, "m"))

    @model_validator(mode="after")
    def _whole(self):
        if self.kind == "vardy-brown" and self.reynolds is None:
            raise InputError("reynolds", "is missing", "the Reynolds number of the flow about which it changes")
        return self

    def law(self, density: float, area: float) -> Law:
        """Impedance per metre; it vanishes in steady flow."""
        radius = (area / pi) ** 0.5
        if self.kind == "zielke" or self.reynolds is None:
            return ChangingLaminarFriction(density, self.viscosity, radius)
        return TurbulentFriction(density, self.viscosity, radius, self.reynolds, self.roughness)


class ByFlow(Friction):
    """Friction that depends on the flow alone, and local losses spread along the pipe."""

    kind: Any
    minor_loss: Annotated[Quantity, Role("minor loss", "", at_least=0)] = optional(
        "K of bends and fittings, which take K·ρ·v²/2", Quantity(0.0, "")
    )
    length: Length | None = optional("over which friction acts, if not all along the pipe")
    unsteady: Unsteady | None = optional("what it adds while the flow changes")

    def law(self, density: float, area: float) -> Law | None:  # noqa: D102
        return self.unsteady.law(density, area) if self.unsteady is not None else None

    def flow_law(self, density: float, area: float, length: float) -> FlowLaw:  # noqa: D102
        law = self.along(density, area).scaled(1.0 if self.length is None else self.length / length)
        minor = density * self.minor_loss / (2 * area**2 * length)
        if isinstance(law, PowerLaw) and law.exponent == 2:
            return quadratic(law.strength + minor)
        return replace(law, square=minor)

    def along(self, density: float, area: float) -> FlowLaw:
        """Pressure drop per metre by friction."""
        raise NotImplementedError


class Darcy(ByFlow):
    """Turbulent friction with a constant friction factor (Darcy, Weisbach)."""

    kind: Literal["darcy"] = "darcy"
    factor: Annotated[Quantity, Role("friction factor", "", above=0, at_most=1e9)] = required(
        "Darcy friction factor, four times Fanning's"
    )

    def along(self, density: float, area: float) -> PowerLaw:  # noqa: D102
        return quadratic(darcy(self.factor, density, area))


class HazenWilliams(ByFlow):
    """Friction of water in pipes that grows with the flow to the power 1.852 (Hazen, Williams)."""

    kind: Literal["hazen-williams"] = "hazen-williams"
    coefficient: Annotated[Quantity, Role("Hazen-Williams coefficient", "", above=0, at_most=1e9)] = required(
        "C: 150 of a smooth wall, 100 of old cast iron"
    )

    def along(self, density: float, area: float) -> PowerLaw:  # noqa: D102
        head = 4.727 * self.coefficient**-1.852 * (_diameter(area) / FOOT) ** -4.871 * FOOT ** (-3 * 1.852)
        return PowerLaw(density * GRAVITY * head, 0.0, 1.852)


class Manning(ByFlow):
    """Turbulent friction of a rough wall: the head falls by n²·v²/R^(4/3) per metre (Manning)."""

    kind: Literal["manning"] = "manning"
    coefficient: Annotated[Quantity, Role("Manning coefficient", "", above=0, at_most=1e9)] = required(
        "n in s/m^(1/3): 0.009 of plastics, 0.013 of concrete"
    )

    def along(self, density: float, area: float) -> PowerLaw:  # noqa: D102
        slope = (self.coefficient / area) ** 2 / (_diameter(area) / 4) ** (4 / 3)
        return quadratic(density * GRAVITY * slope)


class WaterworksDarcy(ByFlow):
    """Friction as in steady flow, laminar, transitional or turbulent, as in EPANET (Swamee, Jain, Dunlop)."""

    kind: Literal["swamee-jain"] = "swamee-jain"
    viscosity: Viscosity = required("dynamic viscosity")
    roughness: Roughness = required("of the wall, 0 if smooth")

    def along(self, density: float, area: float) -> RoughPipe:  # noqa: D102
        return _rough_pipe(SwameeJain, density, area, self.viscosity, self.roughness)


class QuasiSteady(ByFlow):
    """Friction as in steady flow of the same speed, laminar or turbulent (Colebrook)."""

    kind: Literal["quasi-steady"] = "quasi-steady"
    viscosity: Viscosity = required("dynamic viscosity")
    roughness: Roughness = required("of the wall, 0 if smooth")

    def along(self, density: float, area: float) -> RoughPipe:  # noqa: D102
        return _rough_pipe(Colebrook, density, area, self.viscosity, self.roughness)


class VardyBrown(QuasiSteady):
    """Quasi-steady friction and the unsteady part of turbulent friction (Vardy, Brown)."""

    kind: Literal["vardy-brown"] = "vardy-brown"  # pyright: ignore[reportIncompatibleVariableOverride]
    reynolds: Reynolds = required("Reynolds number of the flow about which it changes")

    def law(self, density: float, area: float) -> Law:  # noqa: D102
        return TurbulentFriction(density, self.viscosity, (area / pi) ** 0.5, self.reynolds, self.roughness)


def darcy(factor: float, density: float, area: float) -> float:
    """Coefficient ρ f/(2 d A²) of the pressure drop per metre, which is this times |y| y."""
    return density * factor / (2 * _diameter(area) * area**2)


def _diameter(area: float) -> float:
    return 2 * (area / pi) ** 0.5


def _rough_pipe(kind: type[RoughPipe], density: float, area: float, viscosity: float, roughness: float) -> RoughPipe:
    diameter = _diameter(area)
    return kind(darcy(1.0, density, area), 0.0, density * diameter / (viscosity * area), roughness / diameter)


MODELS = (Linear, Laminar, Zielke, Darcy, HazenWilliams, Manning, WaterworksDarcy, QuasiSteady, VardyBrown)
KINDS: dict[str, type[Friction]] = {model.model_fields["kind"].default: model for model in MODELS}


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
    known, said = (info.context or {}).setdefault("frictions", {}), content(value)
    if said not in known or said is None:
        known[said] = validator(KINDS[kind]).validate_python(value, context=info.context)
    return known[said]


AnyFriction = Annotated[Friction, Read(_of_kind, reduce(or_, MODELS))]
