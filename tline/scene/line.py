"""Lines of a scene: two nodes and any sufficient set of the line's quantities."""

from collections.abc import Iterable
from math import pi
from typing import Annotated, Any, Self

from pydantic import Field, PrivateAttr, create_model, model_validator

from tline.errors import InputError
from tline.line import ElectricalLine, HydraulicLine
from tline.line.electrical import QUANTITIES as ELECTRICAL, in_air
from tline.line.hydraulic import QUANTITIES as HYDRAULIC
from tline.line.materials import FLUIDS, WALLS
from tline.line.parameters import LineQuantity
from tline.line.relations import listed
from tline.loss import ConstantLoss, EarthReturn, Law, LossyLine, Sum, kelvin_voigt_wall
from tline.loss.line import Losses
from tline.scene.alike import content
from tline.scene.attenuation import TYPES, Attenuation, cable_type
from tline.scene.cable_loss import CableTable, LossTangent, Skin, Wire
from tline.scene.cavities import Cavities
from tline.scene.element import Element, TwoNodes, is_name, optional, required
from tline.scene.friction import AnyFriction
from tline.scene.heights import Place
from tline.scene.mistakes import validator
from tline.scene.quantity import LARGEST, SMALLEST, ConductancePerMetre, Quantity, ResistancePerMetre, Role

STORAGE_MISMATCH = 1e-9  # relative to a storage; tolerated difference between laws and lossless line
LOSSES = ("resistance", "conductance", "skin", "wire", "earth", "loss_tangent", "tabulated", "attenuation", "cable")
MATERIALS = {
    "fluid": f"gives density and bulk modulus: {listed(FLUIDS, 'or')}",
    "wall": f"gives Young's modulus: {listed(WALLS, 'or')}",
}


class SceneLine(Element):
    """Line from its end 1 (the first node) to its end 2 (the second)."""

    nodes: TwoNodes = required("node at end 1, node at end 2")
    vertices: list[Place] | None = optional("places on a map that it passes between its nodes, from end 1 on")
    _parameters: HydraulicLine | ElectricalLine = PrivateAttr()
    _losses: Losses | None = PrivateAttr(default=None)

    @property
    def parameters(self) -> HydraulicLine | ElectricalLine:
        """All quantities of the line."""
        return self._own("_parameters")

    @property
    def shortest(self) -> float:
        """Delay of the line, s."""
        return self.parameters.delay or 0.0

    @property
    def stretches(self) -> int:
        """Number of equal stretches between its cavities; 1 if it has none."""
        return 1

    @property
    def losses(self) -> Losses | None:
        """Losses of the line; None if lossless. z0 and delay are those at infinite frequency."""
        return self._own("_losses")

    def _own(self, name: str) -> Any:
        """Read a private attribute, bypassing pydantic's slow look-up: networks read a million."""
        return self.__pydantic_private__[name]  # pyright: ignore[reportOptionalSubscript]

    def between(self, *nodes: str) -> Self:
        """Copy the line to other nodes, sharing all that does not depend on them."""
        found = type(self).__new__(type(self))
        object.__setattr__(found, "__dict__", {**vars(self), "nodes": nodes})
        for name in ("__pydantic_fields_set__", "__pydantic_private__", "__pydantic_extra__"):
            object.__setattr__(found, name, getattr(self, name))
        return found

    def steady_drop(self, y: float) -> tuple[float, float]:
        """Fall of the effort from end 1 to end 2 in steady flow y, and its slope over y."""
        return self.losses.steady_drop(y) if self.losses else (0.0, 0.0)

    def _settle(self, kind: type[HydraulicLine] | type[ElectricalLine], other: tuple[str, ...], **more: Any):
        own = vars(self)
        given = {name: own[name] for name in self.model_fields_set.difference(other, ("nodes", "vertices"))}
        self._parameters = found = kind(**{name: getattr(x, "typed", x) for name, x in given.items()} | more)
        if found.delay is None:
            raise InputError("", "its delay does not follow", "length (with wave_speed), or delay")
        for name, value in (("z0", found.z0), ("delay", found.delay)):
            if not SMALLEST <= value <= LARGEST:
                raise InputError("", f"its {name} is out of range", f"{SMALLEST:g} to {LARGEST:g}", f"{value:g}")
        return self

    def _needed(self, reason: str, *names: str) -> list[float]:
        """Quantities without which a loss is not defined."""
        found = [getattr(self.parameters, name) for name in names]
        if None in found:
            missing = [name for name, value in zip(names, found, strict=True) if value is None]
            raise InputError("", f"{reason} needs its {' and '.join(missing)}")
        return found

    def _lose(self, reason: str, series: list[Law], shunt: list[Law], **friction: Any) -> None:
        """Set the losses; the storage of the laws must not exceed that of the lossless line."""
        (length,) = self._needed(reason, "length")
        inductance = self.parameters.z0 * (self.parameters.delay or 0.0) / length
        self._losses = Losses(
            LossyLine(_stored(inductance, series), _stored(self._capacitance(reason), shunt), length), **friction
        )

    def _capacitance(self, reason: str) -> float:
        (length,) = self._needed(reason, "length")
        return (self.parameters.delay or 0.0) / (self.parameters.z0 * length)


def _stored(storage: float, laws: list[Law]) -> Law:
    """Sum of all laws, and of the storage that none of them accounts for."""
    if all(isinstance(law, ConstantLoss) for law in laws):
        return ConstantLoss(sum(law.loss for law in laws), storage)
    left = storage - sum(law.storage for law in laws)
    return Sum(*laws, ConstantLoss(0.0, left if left > STORAGE_MISMATCH * storage else 0.0))


class Creep(Element):
    """One Kelvin-Voigt element of a wall that creeps."""

    compliance: Annotated[Quantity, Role("creep compliance", "1/Pa", above=0)] = required("J of the element")
    time: Annotated[Quantity, Role("retardation time", "s", above=0)] = required("τ of the element")


class _Pipe(SceneLine):
    """Pipe: any sufficient set of quantities."""

    friction: AnyFriction | None = optional("what the flow loses at the wall, by kind")
    creep: list[Creep] | None = optional("Kelvin-Voigt elements of a wall that creeps")
    cavities: Cavities | None = optional("column separation at places inside the pipe")

    @property
    def stretches(self) -> int:
        return self.cavities.places + 1 if self.cavities is not None else 1

    @model_validator(mode="after")
    def _determine(self):
        self._settle(HydraulicLine, ("friction", "creep", "cavities"))
        if self.friction is None and not self.creep:
            return self
        series: list[Law] = []
        shunt: list[Law] = []
        more: dict[str, Any] = {}
        if self.friction is not None:
            density, area, length = self._needed("friction", "density", "area", "length")
            law = self.friction.law(density, area)
            series = [law] if law is not None else []
            more = {"flow_law": self.friction.flow_law(density, area, length)}
        if self.creep:
            area, thickness = self._needed("creep", "area", "wall_thickness")
            elements = [(float(each.compliance), float(each.time)) for each in self.creep]
            restraint = getattr(self.parameters, "restraint", None) or 1.0
            compliance = self._capacitance("creep")
            shunt = [kelvin_voigt_wall(compliance, (area / pi) ** 0.5, thickness, elements, restraint)]
        self._lose("friction" if self.friction is not None else "creep", series, shunt, **more)
        return self


class _Cable(SceneLine):
    """Cable: any sufficient set of quantities."""

    resistance: ResistancePerMetre | None = optional("to steady current, per metre")
    conductance: ConductancePerMetre | None = optional("of the insulation, per metre")
    skin: Skin | None = optional("skin effect, by the resistance at a high frequency")
    wire: Wire | None = optional("a round wire, by radius and conductivity or resistance")
    earth: Annotated[Quantity, Role("earth resistivity", "ohm m", above=0)] | None = optional(
        "resistivity of the earth that a wire over ground has as its return"
    )
    loss_tangent: LossTangent | None = optional("of the insulation")
    tabulated: CableTable | None = optional("R(f) and L(f), perhaps G(f) and C(f), instead of these")
    attenuation: Attenuation | None = optional(
        "at some frequencies, as in data sheets, instead of skin and loss_tangent"
    )
    cable: str | None = optional(f"gives z0, velocity_factor and attenuation: {', '.join(TYPES)}")
    _attenuation: Attenuation | None = PrivateAttr(default=None)

    @property
    def attenuation_residual(self) -> float:
        """Largest relative difference between its attenuation and the data sheet's; 0 without one."""
        table = self._own("_attenuation")
        return table.residual(*self._front, self._steady_resistance) if table else 0.0

    @property
    def fitted_resistance(self) -> float | None:
        """Resistance to steady current, ohm/m, as fitted to the digits of its attenuation; None where it is known."""
        table = None if self._steady_resistance else self._own("_attenuation")
        return sum(law.loss for law in table.laws(*self._front)[0]) if table else None

    @property
    def _steady_resistance(self) -> float:
        """Resistance to steady current, given or published for the named cable, ohm/m; 0 without either."""
        if self.resistance is None and self.cable is not None:
            return cable_type(self.cable).resistance
        return self.resistance or 0.0

    @property
    def _front(self) -> tuple[float, float]:
        """Impedance z0, ohm, and wave speed, m/s."""
        (length,) = self._needed("attenuation", "length")
        return float(self.parameters.z0), length / float(self.parameters.delay or 0.0)

    @property
    def _conductor(self) -> float | None:
        """Diameter of a wire or of the inner conductor, m, if its geometry is known."""
        return getattr(self.parameters, "wire_diameter", None) or getattr(self.parameters, "inner_diameter", None)

    @model_validator(mode="after")
    def _determine(self):
        given = [name for name in LOSSES if getattr(self, name) is not None]
        air = in_air(name for name, value in vars(self).items() if value is not None) if self.earth else {}
        self._settle(ElectricalLine, LOSSES, **air | self._by_table() | self._by_name())
        if self._attenuation is not None:
            self._attenuate(self._attenuation)
            return self
        if not given:
            return self
        if self.skin and self.wire:
            raise InputError("", "skin and wire say the same in two ways", "one of them")
        resistance = self.resistance or 0.0
        series: list[Law] = self.skin.laws(resistance) if self.skin else [ConstantLoss(resistance)]
        series += [self.wire.law(self._conductor)] if self.wire else []
        series += [EarthReturn(self._needed("earth", "height")[0], self.earth)] if self.earth else []
        series += [self.tabulated.series] if self.tabulated else []
        shunt: list[Law] = [ConstantLoss(self.conductance or 0.0)]
        shunt += [self.loss_tangent.law(self._capacitance(given[0]))] if self.loss_tangent else []
        shunt += [self.tabulated.shunt] if self.tabulated and self.tabulated.shunt else []
        self._lose(given[0], series, shunt)
        return self

    def _by_name(self) -> dict[str, str]:
        """Impedance and velocity factor of a named cable, which must not be given twice."""
        self._attenuation = self.attenuation
        if self.cable is None:
            return {}
        for name in ("z0", "velocity_factor", "attenuation"):
            if getattr(self, name) is not None:
                raise InputError(name, "follows from the cable's name, too", "one of them")
        found = cable_type(self.cable)
        self._attenuation = Attenuation.model_validate({"unit": found.unit, "points": found.points})
        return {"z0": found.z0, "velocity_factor": found.velocity_factor}

    def _attenuate(self, table: Attenuation) -> None:
        """Set the losses from the attenuation, including the resistance to steady current."""
        for name in LOSSES:
            if name not in ("resistance", "attenuation", "cable") and getattr(self, name) is not None:
                raise InputError(name, "is a loss that the attenuation has, too", "one of them")
        series, shunt = table.laws(*self._front, self._steady_resistance)
        self._lose("attenuation", [*series], [shunt])

    def _by_table(self) -> dict[str, float]:
        """Inductance and capacitance at infinite frequency by the table, which must not be given twice."""
        if self.tabulated is None:
            return {}
        said = {"inductance": self.tabulated.series.storage, "resistance": 0.0, "skin": 0.0, "wire": 0.0, "earth": 0.0}
        if self.tabulated.shunt is not None:
            said |= {"capacitance": self.tabulated.shunt.storage, "conductance": 0.0, "loss_tangent": 0.0}
        for name in said:
            if getattr(self, name) is not None:
                raise InputError(name, "is in the table, too", "one of them")
        return {name: storage for name, storage in said.items() if storage}


def _optional(role: Role) -> Any:
    quantity: Any = Annotated[Quantity, role]
    return quantity | None


def _model(name: str, base: type[SceneLine], quantities: Iterable[LineQuantity], **others: Any) -> type[SceneLine]:
    """Create a model with a key for each quantity that determines a line, and for materials."""
    fields: dict[str, Any] = {
        q.name: (_optional(Role(q.name, q.unit, above=0)), Field(default=None, description=q.help)) for q in quantities
    }
    return create_model(  # pyright: ignore[reportCallIssue]
        name, __base__=base, __doc__=base.__doc__, __module__=__name__, **fields, **others
    )


Pipe = _model(
    "Pipe",
    _Pipe,
    HYDRAULIC,
    **{word: (str | None, Field(default=None, description=text)) for word, text in MATERIALS.items()},
    temperature=(
        _optional(Role("temperature", "K", above=0)),
        Field(default=None, description="of the water, 20 degC if not given"),
    ),
)
Cable = _model("Cable", _Cable, ELECTRICAL)


def read_pipe(table: Any, context: dict[str, Any]) -> SceneLine:
    """Read a pipe from its table; pipes of equal content in a context share all but their nodes."""
    known: dict[Any, SceneLine] = context.setdefault("pipes", {})
    said = content(table, "nodes") if type(table) is dict else None
    if said is None:
        return validator(Pipe).validate_python(table, context=context)
    nodes = table.get("nodes")
    if said in known and isinstance(nodes, list | tuple) and len(nodes) == 2 and all(map(is_name, nodes)):
        return known[said].between(*nodes)
    known[said] = validator(Pipe).validate_python(table, context=context)
    return known[said]
