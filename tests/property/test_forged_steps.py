"""A forger who works rule by rule: what the verifier concludes from what no prover writes is true all the same.

Nodes, premises and data are drawn from honest and hostile ones: negative and zero powers, other units, wrong kinds of
nodes, nodes that are there twice or are 0 everywhere, missing premises. Each fact that follows is compared with values.
"""

import cmath
import math
from fractions import Fraction
from random import Random

import pytest

from passivity.verifier import FORMAT, RULES, Graph, check, read_fact

NAMES = {"Z": ["disc", "0", "inf"], "H": ["disc", "-1", "1"], "k": ["real", "1/2", "2"]}
FUNCTIONS = {"Z": lambda s: 1 / (s + 0.1), "H": lambda s: (1 - s) / (1 + s) * cmath.exp(-s / 3), "k": lambda s: 0.7}
POINTS = (0.07, 0.9, 2 + 3j, 0.01 + 1.5j, 0.3 + 20j, 40 + 35j)
REFUSED = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)
C, E = ["1", "2", "-1", "1/2", "-3", "0"], [1, 1, -1, 2, -2, 0, 3, True, 0.5]
DATA = [
    None,
    "1",
    "-1",
    "0",
    [],
    [1],
    [-1],
    [0],
    ["1", []],
    ["-1", []],
    ["1", [1]],
    ["1", [-2]],
    ["1", [-3]],
    [True, 1],
]


def passive(p, q):
    """The data by which p/q, both of degree 1 at most, is positive real."""
    low, high = p[0] * q[0], (p[1] if len(p) > 1 else 0) * (q[1] if len(q) > 1 else 0)
    return {"p": list(map(str, p)), "q": list(map(str, q)), "factors": [[[str(low), str(high)], 1]], "breaks": []}


def node(random, nodes):
    """One more node: of what is there, mostly of what came last."""

    def one():
        return max(random.randrange(len(nodes)), random.randrange(len(nodes)))

    kind = random.choice(["sum", "sum", "mul", "mul", "mul", "line", "exp", "log", "sqrt", "tanh", "cosh", "s", "name"])
    if kind == "s":
        return ["s"]
    if kind == "name":
        return ["name", random.choice(list(NAMES))]
    if kind == "mul":
        return ["mul", *([one(), random.choice(E)] for _ in range(random.choice([1, 2, 2, 3])))]
    return [
        kind,
        *([random.choice(C), one()] for _ in range({"sum": random.choice([1, 2, 2, 3]), "line": 3}.get(kind, 1))),
    ]


def value(nodes, n, s):
    """A node at a point; what is divided by 0 has none."""
    kind, parts = nodes[n]
    if kind in ("one", "s"):
        return {"one": 1.0 + 0j, "s": s + 0j}[kind]
    if kind == "name":
        return complex(FUNCTIONS[parts[0]](s))
    if kind == "mul":
        return math.prod((value(nodes, m, s) ** e for m, e in parts), start=1 + 0j)
    terms = [float(c) * value(nodes, m, s) for c, m in parts]
    if kind == "sum":
        found = sum(terms)
        return found if abs(found) > 1e-13 * max(map(abs, terms)) else 0j
    if kind == "line":
        z0, wave, load = terms[0], cmath.tanh(terms[1]), terms[2]
        return z0 * (load + z0 * wave) / (z0 + load * wave)
    return getattr(cmath, kind)(terms[0])


def is_true(fact, nodes, n):
    """Whether a fact holds at all points where there is a value."""
    for s in POINTS:
        try:
            w = value(nodes, n, s)
        except (OverflowError, ValueError, ZeroDivisionError):
            continue
        kind, low, *high = (float(x) if k else x for k, x in enumerate(fact))
        room = 1e-7 * (1 + abs(w))
        if kind == "arg":
            holds = abs(w) < 1e-9 or abs(cmath.phase(w)) <= low * math.pi / 2 + 1e-7 or low >= 2
        elif kind == "real":
            holds = low - room <= w.real <= high[0] + room and abs(w.imag) < room
        elif math.inf in (-low, high[0]):
            holds = low - room <= w.real <= high[0] + room
        else:
            holds = abs(w - (low + high[0]) / 2) <= (high[0] - low) / 2 + room
        if not holds and cmath.isfinite(w):
            return False
    return True


def grown(random):
    """A graph of some hostile nodes."""
    graph = Graph({name: read_fact(fact) for name, fact in NAMES.items()})
    nodes = [["one"], ["s"]]
    graph.enter("s", [])
    while len(nodes) < 6:
        new = random.choice([["name", "Z"], ["name", "k"]]) if len(nodes) < 4 else node(random, nodes)
        if enter(graph, new):
            nodes.append(new)
    return graph, nodes


def enter(graph, new):
    """Whether a node is taken."""
    there = len(graph.nodes)
    try:
        graph.enter(new[0], new[1:])
        graph.look()
    except REFUSED:
        del graph.nodes[there:]
        return False
    return True


def pattern(rule, random, n):
    """Nodes after node n, premises and data of a step about the last that a rule may take, as they should be."""
    a, b = random.choice(["1", "2", "1/2"]), random.choice(["1", "3", "2/3"])
    if random.random() < 0.2 and (found := trick(rule, random, n)):
        return found
    x, y, z = (random.choice([1, 2, 3, random.randrange(n)]) for _ in range(3))
    if rule == "combination":
        return [["sum", [a, x], [b, y]]], [x, y], [a, b]
    if rule == "product":
        found = [["mul", [x, 1], [y, 1]]]
        return random.choice([(found, [x, y], [1, 1]), ([*found, ["mul", [x, 1]]], [n, y], [1, -1])])
    if rule == "equal":
        nodes = [["mul", [x, 1], [z, 1]], ["mul", [y, 1], [z, 1]], ["sum", [a, n], [b, n + 1]]]
        return [*nodes, ["mul", [n + 2, 1], [z, -1]], ["sum", [a, x], [b, y]]], [n + 3], ["1", []]
    if rule == "function":
        name = random.choice(["log", "log", "exp", "sqrt", "tanh", "cosh"])
        nodes = [[name, [a, x]], [random.choice(["exp", "sqrt"]), [a, n]]]
        return random.choice([(nodes[:1], [x], None), (nodes, [n], None), (nodes, [x], None)])
    if rule == "square":
        return (
            [["sqrt", [a, x]], ["sqrt", [b, y]], ["mul", [x, 1], [y, 1]], ["mul", [n, 1], [n + 1, 1]]],
            [n + 2, n, n + 1],
            [str(Fraction(a) * Fraction(b)), [1, 1]],
        )
    if rule == "mean":
        nodes = [["sum", ["1", 0], [a, x]], ["log", ["1", n]], ["mul", [n + 1, 1], [x, -1]]]
        other = [["exp", [f"-{a}", x]], ["sum", ["1", 0], ["-1", n]], ["mul", [n + 1, 1], [x, -1]]]
        return random.choice([nodes, other]), [x], a
    if rule == "line":
        made = [["mul", [x, 1], [y, 1]], ["mul", [y, 1], [x, -1]], ["line", [a, x], [b, y], ["1", z]]]
        return made, random.choice([[z, x, y], [z, n, n + 1]]), None
    if rule == "rational":
        fact = random.choice([["disc", "0", "inf"], ["arg", "1"]])
        nodes = [["sum", ["1", 0], [a, 1]], ["sum", [b, 0], ["1", 1]], ["mul", [n + 1, 1], [n, -1]]]
        return nodes, [], {"fact": fact, **passive([Fraction(b), 1], [1, Fraction(a)])}
    return [random.choice([["s"], ["name", "Z"], ["name", "k"]])], [], None


def trick(rule, random, n):
    """Nodes, premises and data that once proved what is false, or would."""
    zero, active, wrong = ["log", ["1", 0]], ["sum", ["1", 1], ["-1", 0]], ["sum", ["-1", 1], ["-2", 0]]
    if rule == "function":  # the power of a power
        return [["log", ["1", 1]], ["exp", ["1", n]], ["mul", [n + 1, 3]]], [1], None
    if rule == "product":  # 0/0
        return [zero, active, ["mul", [n, 1], [n + 1, 1]], ["mul", [n + 1, 1]]], [n + 2, n], [1, -1]
    if rule == "equal":  # 0/0, and the exponential of a node that a negative number names
        same = [zero, active, ["mul", [n, 1], [n + 1, 1]], ["mul", [n + 2, 1], [n, -1]], ["mul", [n + 1, 1]]]
        other = [["line", ["1", 0], ["1", 1], ["0", 0]], ["tanh", ["1", 1]], ["exp", ["1", 1]]]
        return random.choice([(same, [n + 3], ["1", []]), (other, [n], ["1", [-2]])])
    if rule == "square":  # half a power
        return [wrong, ["mul", [n, 2]], ["mul", [n, 1]]], [n + 1, n + 1], ["1", [0.5]]
    return None


def spoiled(random, found):
    """The same with something that no prover writes in place of a number, a list or a text somewhere."""
    if isinstance(found, list | tuple) and found and random.random() < 0.8:
        k = random.randrange(len(found))
        return [spoiled(random, x) if i == k else x for i, x in enumerate(found)]
    if isinstance(found, dict):
        key = random.choice([*found, "unit"])
        return found | {key: spoiled(random, found.get(key, random.choice(["1", "-1", "-2", "1/2", "0"])))}
    if isinstance(found, int) and random.random() < 0.8:
        return random.choice([found + 1, -found, 2 * found, 0, found / 2, -2, -3])
    return random.choice([*DATA, *C, -1, 0, 0.5, True, found, "inf", ["disc", "0", "inf"], ["arg", "2"]])


def facts_of(graph):
    """What one round of rules tells of the nodes of a graph, and some weaker facts."""
    known = []
    for n, (kind, parts) in enumerate(graph.nodes):
        inner = [] if kind in ("one", "s", "name") else [m if kind == "mul" else k for m, k in parts]
        rule = {"sum": "combination", "mul": "product", "line": "line"}.get(kind, "function" if inner else "leaf")
        data = [e for _, e in parts] if kind == "mul" else [str(c) for c, _ in parts] if kind == "sum" else None
        try:
            last = [
                [fact for fact in known if fact[0] == m][-1]
                for m in (inner[2:] + inner[:2] if rule == "line" else inner)
            ]
            known += [(n, fact) for fact in RULES[rule](graph, n, last, data)]
        except REFUSED:
            continue
    weaker = [(n, ("disc", fact[1], math.inf)) for n, fact in known if fact[0] == "disc"]
    weaker += [(n, ("real", fact[1], fact[2] + 1)) for n, fact in known if fact[0] == "real"]
    return known + weaker


@pytest.mark.parametrize("rule", RULES)
def test_what_follows_is_true(rule):
    random, followed = Random(rule), 0
    for _ in range(120):
        graph, nodes = grown(random)
        made, premises, data = pattern(rule, random, len(nodes))
        if random.random() < 0.5:
            made = [spoiled(random, new) if random.random() < 0.4 else new for new in made]
        if not all(enter(graph, new) for new in made):
            continue
        known, last = facts_of(graph), len(graph.nodes) - 1
        for _ in range(6):
            chosen = [random.choice(found) for m in premises if (found := [fact for fact in known if fact[0] == m])]
            if random.random() < 0.3:
                chosen = random.choice(
                    [chosen[:-1], chosen * 2, chosen[::-1], random.choices(known, k=2), [*chosen, *known[:1]]]
                )
            given = spoiled(random, data) if random.random() < 0.5 else data
            try:
                found = RULES[rule](graph, last, chosen, given)
            except REFUSED:
                continue
            for fact in found:
                assert is_true(fact, graph.nodes, last), (fact, graph.nodes, chosen, given)
                followed += 1
    assert followed > 5


def forged(small):
    """A proof that 1 - s is positive real: C = ((1 + x s) - 1) - x s is 0 everywhere, and 1 - s is (1 - s) C by C."""
    right = ["disc", "0", "inf"]
    zero = [["sum", ["1", 0], [small, 1]], ["sum", ["1", 2], ["-1", 0]], ["sum", ["1", 3], [f"-{small}", 1]]]
    nodes = [["one"], ["s"], *zero, ["mul", [4, -1]], ["sum", ["1", 0], ["-1", 1]], ["mul", [6, 1], [4, 1]]]
    steps = [
        [0, ["real", "1", "1"], "leaf", [], None],
        [4, ["real", "0", "0"], "equal", [0], ["0", []]],
        [7, ["real", "0", "0"], "equal", [0], ["0", []]],
        [5, ["arg", "0"], "product", [1], [-1]],
        [6, ["arg", "0"], "product", [2, 3], [1, 1]],
    ]
    return {"format": FORMAT, "names": {}, "nodes": nodes, "steps": steps, "root": ["1", 6], "claim": right}


@pytest.mark.parametrize("digits", [0, 30, 90, 120, 2000])
def test_what_cancels_whatever_its_size_is_no_divisor(digits):
    """However many digits of a decimal it takes to see that nothing is left."""
    assert check(forged(f"1/1{'0' * digits}")) == "the head: a division by 0"


def test_a_file_cannot_ask_for_endless_arithmetic():
    proof = forged("1")
    assert "exponent" in check(forged("1e999999999"))
    assert "wrong parts" in check(proof | {"nodes": [["one"], ["s"], ["mul", [1, 10**9]]]})


def test_a_name_that_is_there_twice_is_one():
    """k - k is 0 also where each is a node of its own."""
    nodes = [["one"], ["s"], ["name", "k"], ["name", "k"], ["sum", ["1", 2], ["-1", 3]], ["mul", [4, -1]]]
    proof = {"format": FORMAT, "names": NAMES, "nodes": nodes, "root": ["1", 1], "claim": ["disc", "0", "inf"]}
    assert check(proof | {"steps": [[1, proof["claim"], "leaf", [], None]]}) == "the head: a division by 0"
    nodes[3] = ["name", "k", "again"]
    assert check(proof | {"steps": [[1, proof["claim"], "leaf", [], None]]}) == "the head: wrong parts in name"


def test_a_root_is_an_atom_without_a_square_where_it_is_cut():
    """1/k is from 2 to 4; (sqrt(1/k))^2 is not k, though another equality has written the root as sqrt(k)/k."""
    forged = {"format": FORMAT, "names": {"k": ["real", "1/4", "1/2"]}, "root": ["1", 4], "claim": ["disc", "-1", "1"]}
    forged["nodes"] = [["one"], ["name", "k"], ["mul", [1, -1]], ["sqrt", ["1", 2]], ["mul", [3, 2]]]
    forged["steps"] = [
        [1, ["real", "1/4", "1/2"], "leaf", [], None],
        [2, ["real", "2", "4"], "product", [0], [-1]],
        [3, ["real", "1", "2"], "function", [1], None],
        [3, ["real", "1", "2"], "equal", [2], ["1", []]],
        [4, ["disc", "-1", "1"], "equal", [0], ["1", [3]]],
    ]
    assert check(forged) == "step 4, rule 'equal': not equal"
    forged["steps"][2:] = [[4, ["disc", "2", "4"], "equal", [1], ["1", []]]]
    assert check(forged | {"claim": ["disc", "2", "4"]}) is None
