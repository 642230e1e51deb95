"""Time of an exact verdict, and right answers on the collected cases, into docs/: python -m benchmarks.passivity.

Beside it: python-control's `ispassive` and scikit-rf's test on samples. Every figure is a median.
"""

import json
import math
import random
import time
import warnings
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from statistics import median

from flint import fmpq, fmpq_poly
from matplotlib.figure import Figure

from passivity import RationalFunction, Status, check_bounded_real, check_positive_real, verify

ROOT = Path(__file__).parent.parent
DEGREES = (5, 10, 20, 50, 100, 200)
LIMITS = {20: 1.0, 100: 15.0, 200: 60.0}  # ms
RUNS = 7
S = fmpq_poly([0, 1])
HEAD = """# Benchmarks of the verdicts

Written by `make bench`; medians of 7 runs on one core, after import. python-control's `ispassive` solves a linear
matrix inequality in doubles, and is not asked beyond degree 20 (RC ladders of degree 25, 30 and 40,
asked by hand, took it 0.7, 1.5 and 5.1 s and up to 263 MB, and it called all three active, which they are
not); scikit-rf's `is_passive` looks at 2001 samples of the reflection from 10⁻⁶ to 10⁶ rad/s. Neither can
be right about what lies between samples or within a tolerance; what they are asked is what they offer.

![Time against degree, and right answers](pictures/passivity_benchmark.png)
"""


def rc_ladder(n: int) -> RationalFunction:
    """Unit resistors and capacitors."""
    p, q = fmpq_poly([1]), fmpq_poly([0])
    for _ in range(n):
        q += S * p
        p += q
    return function(p, q)


def rlcg_ladder(n: int) -> RationalFunction:
    """Random elements, quotients of two-digit numbers."""
    rng = random.Random(n)

    def element() -> fmpq_poly:
        return fmpq_poly([fmpq(rng.randint(10, 99), rng.randint(10, 99)) for _ in range(2)])

    p, q = fmpq_poly([1]), fmpq_poly([0])
    for _ in range(n // 2):
        q += element() * p
        p += element() * q
    return function(p, q)


def foster_sum(n: int) -> RationalFunction:
    """Lossy resonances and a resistor, elements being doubles."""
    rng = random.Random(n)
    p, q = fmpq_poly([fmpq(1, 10)]), fmpq_poly([1])
    for _ in range(n // 2):
        k, square, d = (exact(rng.uniform(*ends)) for ends in ((0.1, 1), (0.1, 9), (0.05, 0.5)))
        resonance = S * S + S * d + square
        p, q = p * resonance + S * q * k, q * resonance
    return function(p, q)


def doubles(n: int) -> RationalFunction:
    """The same sum, coefficients rounded to doubles; no longer positive real for high degrees."""
    z = foster_sum(n)
    return RationalFunction.from_coefficients(*([float(c) for c in side] for side in z.to_floats()))


FAMILIES: dict[str, Callable[[int], RationalFunction]] = {
    "RC ladder": rc_ladder,
    "RLCG ladder": rlcg_ladder,
    "Foster sum": foster_sum,
    "Foster sum, rounded": doubles,
}


def exact(x: float) -> fmpq:
    fraction = Fraction(x)
    return fmpq(fraction.numerator, fraction.denominator)


def function(p: fmpq_poly, q: fmpq_poly) -> RationalFunction:
    return RationalFunction(p.numer() * q.denom(), q.numer() * p.denom())


def milliseconds(work: Callable[[], object]) -> float:
    work()
    times = []
    for _ in range(RUNS):
        started = time.perf_counter()
        work()
        times.append(1e3 * (time.perf_counter() - started))
    return median(times)


def proper(z: RationalFunction) -> RationalFunction:
    """The impedance, or the admittance where that has no state space; one is as positive real as the other."""
    return z if z.p.degree() <= z.q.degree() else z.inverse()


def control_answer(z: RationalFunction) -> bool:
    import control

    if z.degree > 20:
        raise ArithmeticError("too large")

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return bool(control.ispassive(control.ss(control.tf(*proper(z).to_floats()))))


def skrf_answer(z: RationalFunction) -> bool:
    import numpy as np
    import skrf

    w = np.logspace(-6, 6, 2001)
    values = np.array([z(1j * x) for x in w])
    with np.errstate(all="ignore"):
        s = ((values - 1) / (values + 1))[:, None, None]
    return bool(skrf.Network(f=w / (2 * np.pi), f_unit="Hz", s=s, z0=1).is_passive())


PEERS = {"python-control": control_answer, "scikit-rf": skrf_answer}


def timing() -> tuple[list[str], dict[str, list[float]]]:
    curves: dict[str, list[float]] = {}
    rows = ["| family | degree | bits | verdict | ms | ms to verify | limit |", "|---|---:|---:|---|---:|---:|---:|"]
    for name, make in FAMILIES.items():
        for n in DEGREES:
            z = make(n)
            verdict = check_positive_real(z)
            ms = milliseconds(lambda z=z: check_positive_real(z))
            curves.setdefault(name, []).append(ms)
            certificate = verdict.certificate
            again = f"{milliseconds(lambda c=certificate: verify(c)):.2f}" if certificate else ""
            bits = max(z.p.height_bits(), z.q.height_bits())
            rows.append(f"| {name} | {n} | {bits} | {verdict.status} | {ms:.2f} | {again} | {LIMITS.get(n, '')} |")
    for peer, answer in PEERS.items():
        for n in DEGREES[:3]:
            z = rlcg_ladder(n)
            try:
                curves.setdefault(f"{peer}, RLCG ladder", []).append(milliseconds(lambda z=z, a=answer: a(z)))
            except Exception as error:  # noqa: BLE001
                curves[f"{peer}, RLCG ladder"].append(math.nan)
                rows.append(f"| {peer}, RLCG ladder | {n} | | {type(error).__name__} | | | |")
    return rows, curves


def right_answers() -> tuple[list[str], dict[str, float]]:
    cases = json.loads((ROOT / "tests" / "truth" / "passivity_cases.json").read_text(encoding="utf-8"))["cases"]
    cases = [case for case in cases if case["verdict"] in (True, False)]
    right, crashed = dict.fromkeys(["tline", *PEERS], 0), dict.fromkeys(PEERS, 0)
    times = []
    for case in cases:
        z = RationalFunction.from_coefficients(case["num"], case["den"])
        check = check_positive_real if case["kind"] == "PR" else check_bounded_real
        right["tline"] += (check(z).status is Status.PROVED) == case["verdict"]
        times.append(milliseconds(lambda z=z, check=check: check(z)))
        for peer, answer in PEERS.items():
            try:
                asked = z if case["kind"] == "PR" else (1 + z) / (1 - z)
                right[peer] += answer(asked) == case["verdict"]
            except Exception:  # noqa: BLE001
                crashed[peer] += 1
    rows = ["| who | right | wrong | no answer |", "|---|---:|---:|---:|"]
    for who, n in right.items():
        none = crashed.get(who, 0)
        rows.append(f"| {who} | {n} | {len(cases) - n - none} | {none} |")
    answers = f"Median of {len(cases)} exact verdicts: {median(times):.3f} ms, slowest {max(times):.1f} ms."
    return [*rows, "", answers], {who: n / len(cases) for who, n in right.items()}


def draw(curves: dict[str, list[float]], shares: dict[str, float]) -> Figure:
    figure = Figure(figsize=(10, 4.4), dpi=150, layout="constrained")
    axes, bars = figure.subplots(1, 2, width_ratios=(2, 1))
    for name, times in curves.items():
        ours = name in FAMILIES
        axes.loglog(DEGREES[: len(times)], times, "o-" if ours else "s--", label=name, markersize=4)
    axes.plot(list(LIMITS), list(LIMITS.values()), "k_", markersize=16, label="aim")
    axes.set(xlabel="degree", ylabel="time of one verdict  [ms]", title="Is it positive real?")
    axes.set_xticks(DEGREES, [str(n) for n in DEGREES])
    axes.minorticks_off()
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, frameon=False)
    names = list(shares)
    found = bars.bar(names, [100 * shares[name] for name in names], color=["#0072B2", "#999999", "#999999"])
    bars.bar_label(found, fmt="%.0f %%", fontsize=9)
    bars.set(ylim=(0, 108), ylabel="right answers on the collected cases  [%]", title="Share of right answers")
    return figure


def main() -> None:
    table, curves = timing()
    answers, shares = right_answers()
    draw(curves, shares).savefig(ROOT / "docs" / "pictures" / "passivity_benchmark.png")
    text = "\n".join([HEAD, *table, "", *answers, ""])
    (ROOT / "docs" / "benchmarks-passivity.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
