"""Integration methods: purpose, order, and failure of each."""

from typing import NamedTuple

from friction.models import Coulomb, Dahl, ElastoPlastic, Karnopp, LuGre, Model, Tanh
from friction.spring_contact import Armstrong, MaxwellSlip, SpringContact
from tline.errors import InputError, check_kind

STATIC, SMOOTH, BRISTLES = (Coulomb, Karnopp), (LuGre, Dahl, ElastoPlastic, Tanh), (LuGre, Dahl, ElastoPlastic)
ALL, SPRING_CONTACTS = STATIC + SMOOTH, (MaxwellSlip, Armstrong)


class Method(NamedTuple):
    """A way to integrate, with its declared order where the law is smooth, and its known failure.

    Attributes
    ----------
    name : str
        As `simulate` takes it.
    order : int
        Declared, where the law is smooth.
    models : tuple of type
        Laws that it fits.
    step : str
        "fixed", "adaptive" or "events".
    failure : str
        How it is known to fail.
    """

    name: str
    order: int
    models: tuple[type[Model | SpringContact], ...]
    step: str  # "fixed", "adaptive" or "events"
    failure: str


METHODS = {
    method.name: method
    for method in (
        Method(
            "events",
            20,
            STATIC + SPRING_CONTACTS,
            "events",
            "none known; a force that only touches F_s may be taken either way",
        ),
        Method("rosenbrock", 5, SMOOTH, "adaptive", "says so where rounding keeps it from its tolerance"),
        Method("taylor", 16, (LuGre, Dahl), "adaptive", "as rosenbrock, which takes over where the contact is stiff"),
        Method("moreau", 1, STATIC, "fixed", "first order: break-away and stop are up to one step late"),
        Method("exponential", 1, BRISTLES, "fixed", "first order; unstable in stick above h = 2·√(m/σ0)"),
        Method("euler", 1, ALL, "fixed", "chatters about v = 0; unstable above limits(model, v).euler"),
        Method("rk4", 4, ALL, "fixed", "chatters about v = 0, losing its order; unstable above limits(model, v).rk4"),
        Method("rk45", 5, ALL, "adaptive", "chatters about v = 0 with steps that shrink with the tolerance"),
        Method("bdf", 5, ALL, "adaptive", "stalls at v = 0, or steps over the jump and reports success"),
        Method("rk45-events", 5, STATIC, "adaptive", "as exact as its tolerance, thousands of times slower"),
        Method("bdf-events", 5, STATIC, "adaptive", "as exact as its tolerance, thousands of times slower"),
    )
}


def method_for(model: Model | SpringContact, name: str | None) -> Method:
    """The method of that name, or the model's default."""
    check_kind("model", model, *ALL, *SPRING_CONTACTS)
    if name is None:
        name = next(each for each in ("events", "taylor", "rosenbrock") if isinstance(model, METHODS[each].models))
    if name not in METHODS:
        raise InputError("method", "unknown", " or ".join(METHODS), f"'{name}'")
    method = METHODS[name]
    if not isinstance(model, method.models):
        fitting = " or ".join(other.name for other in METHODS.values() if isinstance(model, other.models))
        raise InputError("method", f"'{name}' does not fit the {model.name} model", fitting)
    if isinstance(model, Karnopp) and model.delta > 0.0:
        if name in ("moreau", "rk45-events", "bdf-events"):
            raise InputError("method", f"'{name}' knows no dead zone", "delta = 0", f"{model.delta:g}")
        if name == "events" and model.steady_force(model.delta) > model.F_s:
            held = f"at most F_s = {model.F_s:g}"
            raise InputError("model.delta", "friction at the border of the dead zone exceeds F_s", held)
    return method
