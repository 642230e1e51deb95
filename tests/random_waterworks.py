"""Random EPANET files of waterworks by any formula: loops, dead ends in which water stands, a pump that stands."""

import numpy as np

FORMULAS = (("H-W", 90.0, 150.0), ("D-W", 0.01, 1.0), ("C-M", 0.009, 0.015))  # and their roughness
BORES = (80, 100, 150, 200, 250, 300)  # mm


def waterworks(seed: int, junctions: int = 15) -> str:
    """Text of a file in litres per second and metres.

    Examples
    --------
    >>> waterworks(1).splitlines()[-2:]
    ['HEADLOSS D-W', '[END]']
    """
    rng = np.random.default_rng(seed)
    formula, smooth, rough = FORMULAS[seed % 3]
    names = [f"j{k}" for k in range(junctions)]
    pipes: list[str] = []

    def pipe(one: str, two: str, bore: int = 0) -> None:
        length, minor = rng.uniform(100, 1500), rng.choice([0, 0, 3])
        wall = rng.uniform(smooth, rough)
        bore = bore or int(rng.choice(BORES))
        pipes.append(f"p{len(pipes)} {one} {two} {length:.4g} {bore} {wall:.4g} {minor} Open")

    nodes = [f"{name} {rng.uniform(0, 10):.4g} {rng.choice([0, rng.uniform(0.5, 4)]):.4g}" for name in names]
    nodes += ["intake 2 0", "duty 2 0", "spare 2 0"] + [f"end{k} {rng.uniform(0, 10):.4g} 0" for k in range(3)]
    pipe("lake", "intake", 400)
    pipe("duty", names[0], 300)
    pipe("spare", names[-1])
    for k in range(1, junctions):
        pipe(names[int(rng.integers(max(k - 4, 0), k))], names[k])
    for _ in range(junctions // 4):
        pipe(*rng.choice(names, 2, replace=False))
    for k in range(3):
        pipe(str(rng.choice(names)), f"end{k}")
    pipe(names[junctions // 2], "tower", 200)
    table = {
        "JUNCTIONS": nodes,
        "RESERVOIRS": ["lake 20"],
        "TANKS": [f"tower {rng.uniform(45, 60):.4g} 4 0 10 15 0"],
        "PIPES": pipes,
        "PUMPS": ["works intake duty HEAD lifting", "standby intake spare HEAD lifting"],
        "STATUS": ["standby Closed"],
        "CURVES": ["lifting 60 55"],
        "OPTIONS": ["UNITS LPS", f"HEADLOSS {formula}"],
    }
    return "\n".join(f"[{key}]\n" + "\n".join(lines) + "\n" for key, lines in table.items()) + "[END]\n"
