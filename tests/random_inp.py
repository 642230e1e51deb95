"""Random EPANET files with every kind of link, in both directions, with loops, dead ends and pockets without demand."""

import numpy as np

VALVES = ("PRV", "PSV", "PBV", "FCV", "TCV", "GPV")


def random_inp(seed: int, junctions: int = 12) -> str:
    """Text of a file; EPANET may find no steady flow in it."""
    rng = np.random.default_rng(seed)
    units = "LPS" if rng.random() < 0.5 else "GPM"
    flow, length, pressure = (1.0, 1.0, 1.0) if units == "LPS" else (15.85, 3.281, 1.422)
    law, rough = [("H-W", 110), ("C-M", 0.012), ("D-W", 0.1 if units == "LPS" else 0.3)][int(rng.integers(3))]
    names = [f"j{k}" for k in range(junctions)]
    elevation = {name: rng.uniform(0, 30) * length for name in names}
    asked = {name: rng.choice([0, 0, rng.uniform(0, 6)]) * flow for name in names}
    rows: dict[str, list[str]] = {key: [] for key in ("PIPES", "PUMPS", "VALVES", "EMITTERS", "STATUS")}
    wide = 1.0 if units == "LPS" else 1 / 25.4

    def pipe(one: str, two: str, status: str = "Open") -> None:
        name, minor = f"p{len(rows['PIPES'])}", rng.choice([0, 0, 2])
        size = f"{rng.uniform(50, 900) * length:.4g} {rng.choice([80, 100, 150, 200, 300]) * wide:.5g}"
        rows["PIPES"].append(f"{name} {one} {two} {size} {rough} {minor} {status}")

    def valve(one: str, two: str) -> None:
        kind, name = str(rng.choice(VALVES)), f"v{len(rows['VALVES'])}"
        setting = {
            "FCV": f"{rng.uniform(0.2, 8) * flow:.4g}",
            "TCV": f"{10 ** rng.uniform(-1, 3):.4g}",
            "GPV": "losing",
        }
        value = setting.get(kind, f"{rng.uniform(5, 60) * pressure:.4g}")
        bore = rng.choice([80, 150, 250]) * wide
        rows["VALVES"].append(f"{name} {one} {two} {bore:.5g} {kind} {value} {rng.choice([0, 0, 3])}")
        if rng.random() < 0.15:
            rows["STATUS"].append(f"{name} {rng.choice(['Open', 'Closed'])}")

    def pump(one: str, two: str) -> None:
        how = rng.choice(["HEAD one", "HEAD three", "HEAD many", "POWER 12"])
        rows["PUMPS"].append(f"u{len(rows['PUMPS'])} {one} {two} {how} SPEED {rng.choice([1, 1, 0.9, 0])}")

    pipe("lake", names[0])
    for k in range(1, junctions):
        one, two = rng.permutation([names[int(rng.integers(k))], names[k]])
        way = rng.random()
        if way < 0.62:
            pipe(one, two)
        elif way < 0.74:
            pipe(one, two, "CV")
        elif way < 0.92:
            valve(one, two)
        else:
            pump(one, two)
    for _ in range(3):
        one, two = rng.choice(names, 2, replace=False)
        pipe(one, two, str(rng.choice(["Open", "Open", "CV", "Closed"])))
    pipe(names[-1], "tower", str(rng.choice(["Open", "CV"])))
    if rng.random() < 0.3:
        rows["EMITTERS"].append(f"{names[3]} {0.3 * flow}")
    curves = {
        "one": [(10, 40)],
        "three": [(0, 50), (10, 40), (20, 15)],
        "many": [(0, 48), (6, 45), (12, 35), (25, 10)],
        "losing": [(0, 0), (5, 1), (10, 4), (30, 30)],
    }
    table = {
        "JUNCTIONS": [f"{name} {elevation[name]:.4g} {asked[name]:.4g}" for name in names],
        "RESERVOIRS": [f"lake {rng.uniform(60, 120) * length:.5g}"],
        "TANKS": [f"tower {rng.uniform(30, 60) * length:.5g} 3 0 10 15 0"],
        **rows,
        "CURVES": [f"{key} {q * flow:.4g} {h * length:.4g}" for key, points in curves.items() for q, h in points],
        "OPTIONS": [f"UNITS {units}", f"HEADLOSS {law}", "EMITTER EXPONENT 0.5"],
    }
    return "\n".join(f"[{key}]\n" + "\n".join(lines) + "\n" for key, lines in table.items()) + "[END]\n"
