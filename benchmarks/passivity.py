"""Time of an exact verdict, and right answers on the collected cases, into docs/: python -m benchmarks.passivity.

For comparison: python-control's `ispassive` and scikit-rf's test on samples. Every figure is a median.
"""

import json
import math
import random
import warnings
from collections.abc import Callable
from fractions import Fraction
from statistics import median

from flint import fmpq, fmpq_poly
from matplotlib.figure import Figure

from benchmarks.harness import DOCS, ROOT, table, timed, write
from passivity import RationalFunction, Status, check_bounded_real, check_positive_real, verify

DEGREES = (5, 10, 20, 50, 100, 200)
LIMITS = {20: 1.0, 100: 15.0, 200: 60.0}  # ms
RUNS = 7
S = fmpq_poly([0, 1])


def rc_ladder(n: int) -> RationalFunction:
    """Ladder of unit resistors and capacitors."""
    p, q = fmpq_poly([1]), fmpq_poly([0])
    for _ in range(n):
        q += S * p
        p += q
    return function(p, q)


def rlcg_ladder(n: int) -> RationalFunction:
    """Ladder of random elements, quotients of two-digit numbers."""
    rng = random.Random(n)

    def element() -> fmpq_poly:
        return fmpq_poly([fmpq(rng.randint(10, 99), rng.randint(10, 99)) for _ in range(2)])

    p, q = fmpq_poly([1]), fmpq_poly([0])
    for _ in range(n // 2):
        q += element() * p
        p += element() * q
    return function(p, q)


def foster_sum(n: int) -> RationalFunction:
    """Sum of lossy resonances and a resistor, elements being doubles."""
    rng = random.Random(n)
    p, q = fmpq_poly([fmpq(1, 10)]), fmpq_poly([1])
    for _ in range(n // 2):
        k, square, d = (exact(rng.uniform(*ends)) for ends in ((0.1, 1), (0.1, 9), (0.05, 0.5)))
        resonance = S * S + S * d + square
        p, q = p * resonance + S * q * k, q * resonance
    return function(p, q)


def doubles(n: int) -> RationalFunction:
    """Sum of lossy resonances, coefficients rounded to doubles; no longer positive real for high degrees."""
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
    return 1e3 * timed(work, RUNS)[1]


def proper(z: RationalFunction) -> RationalFunction:
    """Return the impedance, or the admittance where that has no state space; one is as positive real as the other."""
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


def timing() -> tuple[str, dict[str, list[float]]]:
    curves: dict[str, list[float]] = {}
    rows: list[tuple] = []
    for name, make in FAMILIES.items():
        for n in DEGREES:
            z = make(n)
            verdict = check_positive_real(z)
            ms = milliseconds(lambda z=z: check_positive_real(z))
            curves.setdefault(name, []).append(ms)
            certificate = verdict.certificate
            again = f"{milliseconds(lambda c=certificate: verify(c)):.2f}" if certificate else ""
            bits = max(z.p.height_bits(), z.q.height_bits())
            rows.append((name, n, bits, verdict.status, f"{ms:.2f}", again, LIMITS.get(n, "")))
    for peer, answer in PEERS.items():
        for n in DEGREES[:3]:
            z = rlcg_ladder(n)
            try:
                curves.setdefault(f"{peer}, RLCG ladder", []).append(milliseconds(lambda z=z, a=answer: a(z)))
            except Exception as error:  # noqa: BLE001
                curves[f"{peer}, RLCG ladder"].append(math.nan)
                rows.append((f"{peer}, RLCG ladder", n, "", type(error).__name__, "", "", ""))
    return table("<family|degree|bits|<verdict|ms|ms to verify|limit", rows), curves


def right_answers() -> tuple[str, dict[str, float]]:
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
    rows = [(who, n, len(cases) - n - crashed.get(who, 0), crashed.get(who, 0)) for who, n in right.items()]
    said = f"Median of {len(cases)} exact verdicts: {median(times):.3f} ms, slowest {max(times):.1f} ms."
    found = table("<who|right|wrong|no answer", rows) + "\n\n" + said
    return found, {who: n / len(cases) for who, n in right.items()}


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


if __name__ == "__main__":
    verdicts, curves = timing()
    answers, shares = right_answers()
    draw(curves, shares).savefig(DOCS / "pictures" / "passivity_benchmark.png")
    write("benchmarks/pages/passivity.md", verdicts, "verdicts")
    write("benchmarks/pages/passivity.md", answers, "answers")
