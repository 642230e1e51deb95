"""The exercise's Modelica package, solved as written, with components of the standard library by their equations.

The components' equations are written here from the library's documentation (4.0.0); connections, modifications and
`extends` are those of the printed text, taken apart below.
"""

import math
import re

import numpy as np
import pytest

from drives import Belt, CoupledDrives, Pulley, Spool
from tline.exercises.answer import exercise

UNEQUAL = CoupledDrives(
    Spool(2e-3, 0.03, 0.07), Spool(5e-4, 0.2, 0.13), Belt(40, 0.3), Belt(90, 0.05), Pulley(150, math.radians(37))
)
ROTATIONAL, TRANSLATIONAL = ("phi", "tau"), ("s", "f")
LIBRARY = {  # connectors with their kind, and equations
    "Torque": ({"tau": (), "flange": ROTATIONAL}, ["flange.tau + tau"]),
    "Inertia": (
        {"flange_a": ROTATIONAL, "flange_b": ROTATIONAL},
        ["flange_a.phi - flange_b.phi", "J*der(der(flange_a.phi)) - flange_a.tau - flange_b.tau"],
    ),
    "Damper": (
        {"flange_a": ROTATIONAL, "flange_b": ROTATIONAL},
        ["flange_b.tau - d*(der(flange_b.phi) - der(flange_a.phi))", "flange_a.tau + flange_b.tau"],
    ),
    "Fixed": ({"flange": ROTATIONAL}, ["flange.phi"]),
    "IdealGearR2T": (
        {"flangeR": ROTATIONAL, "flangeT": TRANSLATIONAL},
        ["flangeR.phi - ratio*flangeT.s", "ratio*flangeR.tau + flangeT.f"],
    ),
    "SpringDamper": (
        {"flange_a": TRANSLATIONAL, "flange_b": TRANSLATIONAL},
        ["flange_b.f - c*(flange_b.s - flange_a.s) - d*(der(flange_b.s) - der(flange_a.s))", "flange_a.f + flange_b.f"],
    ),
    "PartialTwoFlanges": ({"flange_a": TRANSLATIONAL, "flange_b": TRANSLATIONAL}, []),
    "Gain": ({"u": (), "y": ()}, ["y - k*u"]),
    "Flange_b": (TRANSLATIONAL, []),
    "RealInput": ((), []),
    "RealOutput": ((), []),
}
NAME = re.compile(r"(?<![\w.])(?!der\b|cos\b)[A-Za-z_][\w.]*")


class Flat:
    """A model taken apart: its equations as texts over full names, and its parameters."""

    def __init__(self, package):
        found = re.findall(r"(?:partial )?model (\w+)[^\n]*\n(.*?)\n  end \1;", package, re.DOTALL)
        self.models, self.equations, self.parameters = dict(found), [], {}
        self.sets, self.kinds = {}, {}  # connected flanges by the model that connects them; variables of connectors

    def add(self, kind, prefix, given):
        name = kind.rsplit(".", 1)[-1]
        if name in LIBRARY:
            connectors, equations = LIBRARY[name]
            if isinstance(connectors, dict):
                self.kinds |= {f"{prefix}{port}": variables for port, variables in connectors.items()}
            else:
                self.kinds[prefix.rstrip(".")] = connectors
            self.parameters |= {f"{prefix}{key}": value for key, value in given.items()}
            self.equations += [self.full(each, prefix) for each in equations]
            return
        head, _, body = self.models[name].partition("\n  equation\n")
        for line in head.splitlines():
            text = re.sub(r'\s*"[^"]*"', "", line.strip().rstrip(";"))
            if text.startswith("import"):
                continue
            if text.startswith("parameter"):
                key, _, value = text.split(None, 2)[2].partition(" = ")
                self.parameters[f"{prefix}{key}"] = given.get(key) or value
                continue
            base = re.fullmatch(r"(extends )?([\w.]+)\s*(?:([\w, ]+))?(?:\((.*)\))?", text)
            extended, kind, names, changes = base.groups()
            own = dict(re.findall(r"(\w+) = ([^,]+)", changes or ""))
            if extended:
                self.add(kind, prefix, own | given)
            elif not kind.startswith("Modelica.Units"):
                for each in names.split(", "):
                    self.add(kind, f"{prefix}{each}.", {k: self.full(v, prefix) for k, v in own.items()})
        for line in body.splitlines():
            text = re.sub(r'\s*"[^"]*"', "", line.strip().rstrip(";"))
            if text.startswith("connect"):
                self.connect(*(f"{prefix}{port}" for port in re.findall(r"[\w.]+", text)[1:]), prefix)
            elif text:
                left, right = text.split(" = ")
                self.equations.append(self.full(f"({left}) - ({right})", prefix))

    def full(self, text, prefix):
        return NAME.sub(lambda m: m[0] if m[0].startswith("Modelica") else f"{prefix}{m[0]}", text)

    def connect(self, first, second, prefix):
        kind = self.kinds[first] or self.kinds[second]
        if not kind:
            self.equations.append(f"{first} - {second}")
            return
        self.equations.append(f"{first}.{kind[0]} - {second}.{kind[0]}")
        sets = self.sets.setdefault(prefix, [])
        joined = {first, second}.union(*(each for each in sets if each & {first, second}))
        self.sets[prefix] = [each for each in sets if not each & joined] + [joined]

    def balances(self):
        """Flows of connected flanges add up to 0; a flange of the model that connects them counts the other way."""
        for prefix, sets in self.sets.items():
            for joined in sets:
                own = {port for port in joined if "." not in port.removeprefix(prefix)}
                terms = [f"{'-' if port in own else '+'} {port}.{self.kinds[port][1]}" for port in sorted(joined)]
                self.equations.append("0 " + " ".join(terms))


def solved(package, model, inputs, outputs, s):
    """Transfer matrix of a printed model at s, by solving its equations."""
    flat = Flat(package)
    flat.add(model, "", {})
    flat.balances()
    found = {name for text in flat.equations for name in NAME.findall(text)}
    names = sorted(found - {*flat.parameters})
    values = {}

    def number(text):
        text = text.replace("Modelica.Constants.pi", repr(math.pi))
        return eval(NAME.sub(lambda m: repr(value_of(m[0])), text), {})  # ours: the text is made by the package

    def value_of(name):
        if name not in values:
            values[name] = number(flat.parameters[name])
        return values[name]

    def row(text, point):
        written = NAME.sub(lambda m: repr(value_of(m[0])) if m[0] in flat.parameters else f"x['{m[0]}']", text)
        scope = {"x": point, "der": lambda v: s * v, "cos": math.cos}
        return eval(written, scope)

    unknown = [name for name in names if name not in inputs]
    units = [{n: float(n == name) for n in names} for name in (*unknown, *inputs)]
    matrix = np.array([[row(text, point) for point in units] for text in flat.equations], complex)
    square, right = matrix[:, : len(unknown)], -matrix[:, len(unknown) :]
    assert square.shape[0] == square.shape[1], (square.shape, unknown)  # as many equations as unknowns
    return np.linalg.solve(square, right)[[unknown.index(name) for name in outputs]]


@pytest.mark.parametrize("drives", [CoupledDrives(), UNEQUAL], ids=["exercise", "unequal"])
@pytest.mark.parametrize("s", [1j, 3.0 + 20j, 500j])
def test_the_package_with_ports_is_the_model(drives, s):
    seen = solved(exercise("4g", drives).modelica, "WithPorts", ["T1", "T2"], ["y", "pulley.F1"], s)
    expected = [[drives.transfer(output, source)(s) for source in ("T1", "T2")] for output in ("x_k", "tension")]
    assert seen[0] == pytest.approx(expected[0], rel=1e-9)  # rounding of a solve with some 60 unknowns
    assert -seen[1] == pytest.approx(expected[1], rel=1e-9)  # F1 counts compression


def test_one_drive_alone_is_its_balance_of_torques():
    s, spool = 2.0 + 7j, CoupledDrives().left
    j, b, r = (float(x) for x in (spool.inertia, spool.friction, spool.radius))
    (seen,) = solved(exercise("4b").modelica, "Drive", ["T", "flange_b.f"], ["flange_b.s"], s)
    # J*phi'' = T - B*phi' + r*f, s = r*phi
    assert seen == pytest.approx(np.array([r, r * r]) / (j * s**2 + b * s), rel=1e-12)
