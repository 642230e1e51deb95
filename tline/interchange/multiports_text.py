"""Linear multiports of a scene as SPICE cards: controlled sources and coupled inductors."""

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.interchange.spice_names import Names
from tline.scene.link import Link
from tline.scene.multiport import ControlledSource, CoupledInductors, Gyrator, Junction, Multiport, Transformer
from tline.words.wording import place

LARGEST = 1e12  # condition number of 1 + S, beyond which there is no admittance
ROUNDING = 1e-15  # of the largest admittance; less is none


def multiport_cards(link: Link, name: str, names: Names) -> list[str]:
    """The cards of a multiport.

    Parameters
    ----------
    link : Link
        A transformer (E and F, with a source of no voltage that measures its current), a gyrator (two G), a
        controlled source (E and R), coupled inductors (two L and K), or a junction (G for each admittance).
    name : str
        Of the link.
    names : Names
        Of the netlist.
    """
    where, nodes = place("links", name), [names.node[at] for at in link.nodes]
    grounded = not isinstance(link, Multiport) or link.is_grounded
    ports = [f"{at} 0" for at in nodes] if grounded else [" ".join(nodes[:2]), " ".join(nodes[2:])]
    match link:
        case Transformer():
            return _transformer(float(link.ratio), name, ports, names)
        case Gyrator():
            turned = 1 / float(link.resistance)
            return _conductances(np.array([[0.0, turned], [-turned, 0.0]]), name, ports, names)
        case ControlledSource():
            return _controlled_source(link, name, ports, names)
        case CoupledInductors():
            return _coupled_inductors(link, name, ports, names)
        case Junction():
            return _conductances(_admittance(link, where), name, ports, names)
    raise InputError(
        where, f"a {type(link).model_fields['kind'].default} has no counterpart in a netlist", "a linear multiport"
    )


def _transformer(ratio: float, name: str, ports: list[str], names: Names) -> list[str]:
    """u₁ = n u₂, and n times the current into the first port comes out of the second."""
    (first, low), second = ports[0].split(), ports[1]
    E, V, F = (names.element(letter, name) for letter in "EVF")
    inner, turned = f"{V}.x", " ".join(reversed(second.split()))
    return [f"{E} {inner} {low} {second} {ratio!r}", f"{V} {first} {inner} DC 0", f"{F} {turned} {V} {ratio!r}"]


def _controlled_source(link: ControlledSource, name: str, ports: list[str], names: Names) -> list[str]:
    control, out = ports
    if link.transconductance is not None:
        return [f"{names.element('G', name)} {out} {control} {float(link.transconductance)!r}"]
    E, gain, resistance = names.element("E", name), float(link.gain or 0), float(link.resistance or 0)
    if not resistance:
        return [f"{E} {out} {control} {gain!r}"]
    inner, (plus, minus) = f"{E}.x", out.split()
    return [f"{E} {inner} {minus} {control} {gain!r}", f"{names.element('R', name)} {inner} {plus} {resistance!r}"]


def _coupled_inductors(link: CoupledInductors, name: str, ports: list[str], names: Names) -> list[str]:
    windings, k = [names.element("L", name) for _ in ports], float(link.coupling)
    cards = [f"{L} {port} {float(x)!r}" for L, port, x in zip(windings, ports, link.inductance, strict=True)]
    return [*cards, f"{names.element('K', name)} {' '.join(windings)} {k!r}"] if k else cards


def _admittance(link: Junction, where: str) -> NDArray:
    """Y = (1 + S)^-1 (1 - S)/z0, so that i = Y u; Pozar, Microwave Engineering, 4th ed., section 4.3."""
    S, one = np.array(link.scattering, float), np.eye(len(link.nodes))
    if np.linalg.cond(one + S) > LARGEST:
        raise InputError(where, "has no admittance matrix, which a netlist needs", "1 + S that can be inverted")
    return np.linalg.solve(one + S, one - S) / float(link.z0)


def _conductances(Y: NDArray, name: str, ports: list[str], names: Names) -> list[str]:
    """G across each port for each voltage that commands its current."""
    return [
        f"{names.element('G', name)} {ports[i]} {ports[j]} {float(Y[i, j])!r}"
        for i, j in np.argwhere(np.abs(Y) > ROUNDING * np.abs(Y).max())
    ]
