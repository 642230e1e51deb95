"""Power absorbed by a scene as one function of s: a sum over its parts, positive real if each part is.

With efforts and flows that grow as exp(s t), Re s > 0, the power of sources is the real part of Σ w Z, w = |i|² >= 0
for the flow i through each impedance Z, because nodes absorb nothing. A uniform line is two of them, z0 coth(Γ/2) for
the even mode of its ends and z0 tanh(Γ/2) for the odd one. Parts without a formula (laws, losses that are not
constant, multiports, circuits that are passive though an element is not) are names assumed to be positive real.
"""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from tline.loss import ConstantLoss
from tline.solver.description.active import active_impedances, controlled_sources
from tline.solver.description.given import Scene
from tline.solver.description.passive import CircuitVerdict, exact_elements, one_port, passive_circuits
from tline.words.wording import place

if TYPE_CHECKING:
    from passivity.calculus.given import Structure


def taken_power(scene: Scene, circuits: Sequence[CircuitVerdict] | None = None) -> "Structure | CircuitVerdict":
    """Power absorbed by a scene with zero sources, as a text in s, or the verdict on a circuit that is not passive.

    Parameters
    ----------
    scene : Scene
    circuits : sequence of CircuitVerdict, optional
        All of its circuits, if they are known.

    Returns
    -------
    Structure or CircuitVerdict
        Arguments of `passivity.is_positive_real`: `text`, `assume` of the names in it, and the resulting `statement`.

    Examples
    --------
    >>> import tline as tl
    >>> tl.frequency.taken_power(tl.read("scenes/diode_clamp.toml")).statement
    'the power that the scene takes up, a sum over its parts, is positive real, p0 the links.clamp'
    """
    from passivity import Status
    from passivity.calculus.given import Structure

    suspect = {*active_impedances(scene), *(place("links", name) for name in controlled_sources(scene))}
    circuits = passive_circuits(scene, suspect) if circuits is None else circuits
    for status in (Status.REFUTED, Status.UNDECIDED):
        wrong = [circuit for circuit in circuits if circuit.status is status]
        if wrong:
            return wrong[0]
    decided = {where for circuit in circuits if circuit.scattering is not None for where in circuit.elements}
    names = [f"circuit of {', '.join(circuit.elements)}" for circuit in circuits if circuit.scattering is not None]
    terms: list[str] = []
    for where, text in _parts(scene):
        if where in decided:
            continue
        if where in suspect:
            return Structure(text, (), f"{where} is positive real")
        if text:
            terms.append(f"w{len(terms)}*{text}")
        else:
            names.append(where)
    weights = [f"w{k} >= 0" for k in range(len(terms))]
    opaque = [f"p{k}" for k in range(len(names))]
    known = "".join(f", {name} the {where}" for name, where in zip(opaque, names, strict=True))
    statement = f"the power that the scene takes up, a sum over its parts, is positive real{known}"
    return Structure(
        " + ".join([*terms, *opaque]) or "0", (*weights, *(f"{p} positive real" for p in opaque)), statement
    )


def _parts(scene: Scene) -> Iterator[tuple[str, str]]:
    """Place and impedance of each part, which is empty where there is no text; of each line two."""
    for element in exact_elements(scene):
        found = element.equations and one_port(*element.equations)
        if not found:
            yield element.where, ""
        elif not (found[0].is_zero or found[1].is_zero):  # else there is no effort, or no flow
            yield element.where, f"{found[0] / found[1]}"
    for name, line in scene.lines.items():
        if getattr(line, "mixing", False):
            yield f"losses between conductors of {place('lines', name)}", ""
    for name, line in scene.single_lines.items():
        losses = line.losses
        laws = (losses.exact.series, losses.exact.shunt) if losses else ()
        if losses and losses.flow_law is not None:
            yield f"friction in {place('lines', name)}", ""
        if not all(isinstance(law, ConstantLoss) for law in laws):
            yield place("lines", name), ""
            continue
        z0, half = _exact(line.parameters.z0), f"{_exact(line.parameters.delay or 0.0) / 2}*s"
        if losses and any(law.loss for law in laws):
            series, shunt = (f"({_exact(law.loss)} + {_exact(law.storage)}*s)" for law in laws)
            z0, half = f"sqrt({series}/{shunt})", f"{_exact(losses.exact.length) / 2}*sqrt({series}*{shunt})"
        yield place("lines", name), f"line({z0}, {half}, 0)"
        yield place("lines", name), f"(1/line(1/({z0}), {half}, 0))"


def _exact(x: float) -> Fraction:
    return Fraction(repr(float(x)))
