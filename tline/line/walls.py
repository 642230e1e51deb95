"""Young's modulus of named wall materials.

Sources: M. H. Chaudhry, Applied Hydraulic Transients, 3rd ed., Springer 2014, doi:10.1007/978-1-4614-8538-4,
chapter 1, table of moduli of wall materials (the middle of the range beside it); ductile iron and PVC as in
the design standards of these pipes. Plastics creep: a fast wave sees a higher modulus than a lasting load,
and it falls with temperature. Glass-reinforced plastic is absent since its winding decides: give
`youngs_modulus`.
"""

from tline.line.parameters import choose

WALLS = {
    "steel": 206e9,  # mild steel, 200-212 GPa
    "ductile iron": 165.5e9,  # 24e6 psi in ANSI/AWWA C150
    "cast iron": 125e9,  # 80-170 GPa
    "copper": 119e9,  # 107-131 GPa
    "aluminium": 70.5e9,  # alloys, 68-73 GPa
    "concrete": 22e9,  # 14-30 GPa
    "pvc": 2.76e9,  # rigid; 400e3 psi in ANSI/AWWA C900, 2.4-2.75 GPa in Chaudhry
    "hdpe": 0.8e9,  # polyethylene, one value
}


def youngs_modulus(name: str) -> float:
    """Young's modulus in Pa of the wall material of that name.

    Examples
    --------
    >>> youngs_modulus("steel")
    206000000000.0
    """
    return choose(WALLS, name, "wall")
