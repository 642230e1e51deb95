"""Netlists and networks of other programs as fuzz."""

from functools import lru_cache
from random import Random

from fuzz.case import Case, shipped
from fuzz.mutate import damaged, number, value

NODES = ("0", "a", "b", "c", "gnd", "1")
SHAPES = (
    "PULSE({} {} {} {} {} {} {})",
    "SIN({} {} {})",
    "EXP({} {} {} {})",
    "PWL({} {} {} {})",
    "DC {}",
    "{}",
    "AC {}",
    "PWL({})",
)
CARDS = (
    "R{n} {a} {b} {v}", "L{n} {a} {b} {v}", "C{n} {a} {b} {v}", "T{n} {a} 0 {b} 0 Z0={v} TD={v}", "K{n} L1 L2 {v}",
    "T{n} {a} 0 {b} 0 Z0=50 TD=1n", "T{n} {a} 0 {b} 0 Z0=50 F={v} NL={v}", "O{n} {a} 0 {b} 0 ltra", "D{n} {a} {b} dmod",
    "E{n} {a} 0 {b} 0 {v}", "G{n} {a} 0 {b} 0 {v}", "V{n} {a} {b} {w}", "I{n} {a} {b} {w}", "V{n} {a} 0 {w}",
    ".model ltra LTRA(R={v} L={v} C={v} G={v} LEN={v})", ".model dmod D(IS={v} N={v})", ".param p={v} q={{p*{v}}}",
    "X{n} {a} {b} sub", ".subckt sub x y\nR9 x y 10\n.ends", ".subckt sub x y\nX9 x y sub\n.ends", "R{n} {a} {b} {{p}}",
    "+ {v}", "* comment", ".include /etc/passwd", ".lib x", ".print tran V({a})", ".control\nshell touch x\n.endc",
    ".ic V({a})={v}",
    "W{n} {a} 0 {b} 0 N=1 RLGCMODEL=w", "Q{n} {a} {b} 0 m", "R{n} {a} {b} {{{e}}}",
    "W{n} {a} 0 {b} 0 N=1 L={v} RLGCMODEL=w\n.model w W MODELTYPE=RLGC N=1 Lo={v} Co={v} Ro={v} Gd={v}",
    "W{n} {a} 0 {b} 0 N=1 L={v} RLGCFILE={a}", "F{n} {a} {b} V1 {v}", "H{n} {a} 0 V1 {v}",
    "T{n} {a} {b} c 1 Z0={v} TD={v}",
    "P{n} {a} {b} 0 c 1 0 cpl\n.model cpl CPL R={v} 0 {v} L={v} {v} {v} C={v} {v} {v} G=0 0 0 length={v}",
    "Y{n} {a} 0 {b} 0 txl\n.model txl TXL R={v} L={v} C={v} G={v} length={v}", "E{n} {a} {b} POLY(1) c 0 {v} {v}",
    "U{n} {a} {b} 0 urc L={v} N={v}\n.model urc URC K={v} FMAX={v} RPERL={v} CPERL={v}", "C{n} {a} {b} {v} IC={v}",
    "V{n} {a} {b} 0", ".param a={{b}} b={{a}}", ".param c={{d+1}} d={v}", ".tran 0 {v} 0", ".include net.cir",
    ".global {a}", ".options x={v}", ".measure tran m MAX v({a})", "I{n} {a} {b} {w} AC 1", "R{n} {a} {b} 0",
)  # fmt: skip
EXPRESSIONS = (
    "1+1",
    "p",
    "1/0",
    "2**99999",
    "sqrt(-1)",
    "((((1))))",
    "10^400",
    "p*q",
    "a b",
    "1e308*1e308",
    "sqrt(p)",
    "max(1,",
    "pow(10,400)",
    "exp(999)",
    "log(0)",
    "(" * 3000,
    "-" * 2000 + "1",
)
EPANET = """[TITLE]
Net
[JUNCTIONS]
J1 10 5
J2 12 3
[RESERVOIRS]
R 50
[TANKS]
T 40 3 0 10 12 0
[PIPES]
P1 R J1 1000 200 100 0 Open
P2 J1 J2 800 150 100 0 Open
P3 J2 T 500 200 110 0 CV
[PUMPS]
[VALVES]
[EMITTERS]
J2 0.1
[PATTERNS]
1 1.0 1.2
[CURVES]
C 10 20
[TIMES]
Duration 0
[OPTIONS]
Units LPS
Headloss H-W
[COORDINATES]
J1 0 0
J2 10 0
[END]
"""


def spice(rng: Random) -> Case:
    """A netlist of random cards, or a damaged example."""
    if rng.random() < 0.4:
        data = damaged(rng, _shipped()["cable_rc.cir"])
    else:
        cards = [_card(rng, n) for n in range(rng.randint(0, 8))]
        whole = [
            "title",
            "V1 s 0 1",
            "R1 s a 25",
            "T1 a 0 b 0 Z0=50 TD=1n",
            "R2 b 0 100",
            *cards,
            ".tran 1p 9n uic",
            ".end",
        ]
        text = "\n".join(whole)
        data = damaged(rng, text) if rng.random() < 0.3 else text.encode("utf-8", "surrogateescape")
    asked = rng.random() < 0.2
    return Case(
        ["import", "net.cir", *["-o", "out.toml"] * asked], {"net.cir": data}, frozenset({"out.toml"} if asked else ())
    )


def _card(rng: Random, n: int) -> str:
    shape = rng.choice(SHAPES).replace("{}", "{v}")
    text = rng.choice(CARDS).replace("{w}", shape)
    for word, choose in (
        ("{v}", lambda: _value(rng)),
        ("{a}", lambda: rng.choice(NODES)),
        ("{b}", lambda: rng.choice(NODES)),
    ):
        while word in text:
            text = text.replace(word, choose(), 1)
    return (
        text.replace("{n}", str(rng.choice((n + 2, 1))))
        .replace("{e}", rng.choice(EXPRESSIONS))
        .replace("{{", "{")
        .replace("}}", "}")
    )


def _value(rng: Random) -> str:
    return rng.choice(("50", "1n", "10p", "100", "1k", "25", "1meg", "0.5")) if rng.random() < 0.7 else number(rng)


def epanet(rng: Random) -> Case:
    """A small network with damage."""
    text = EPANET if rng.random() < 0.7 else _shipped()["town.inp"]
    speed = "1000 m/s" if rng.random() < 0.9 else value(rng)
    return Case(["import", "net.inp", f"--wave-speed={speed}"], {"net.inp": damaged(rng, text)})


@lru_cache
def _shipped() -> dict[str, str]:
    return shipped("cable_rc.cir", "town.inp")
