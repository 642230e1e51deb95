"""References for the friction tests: Taylor series of order 40 in 50 digits, in plain Python, shared with no other
code.

`python tests/truth/friction_reference.py` writes friction_cases.json anew, in some minutes.
"""

import json
from pathlib import Path

from flint import arb, ctx

ORDER = 40
BITS = 170


def coefficients(model, state, t, force):
    """Series of x, v, z about t, for v >= 0; force is (value, slope) at t = 0."""
    x, v, z, w, g, p, q, e = ([arb(0)] * (ORDER + 1) for _ in range(8))
    x[0], v[0], z[0] = state
    f_c, f_s, f_v, v_s = (arb(model[key]) for key in ("F_c", "F_s", "F_v", "v_s"))
    bristles = "sigma0" in model
    s0, s1 = (arb(model.get(key, "0")) for key in ("sigma0", "sigma1"))
    for k in range(ORDER):
        q[k] = sum((v[j] * v[k - j] for j in range(k + 1)), arb(0)) / v_s**2
        if k == 0:
            e[0] = (-q[0]).exp()
        else:
            e[k] = -sum((j * q[j] * e[k - j] for j in range(1, k + 1)), arb(0)) / k
        g[k] = (f_c if k == 0 else 0) + (f_s - f_c) * e[k]
        applied = (arb(force[0]) + arb(force[1]) * t) if k == 0 else arb(force[1]) if k == 1 else arb(0)
        if bristles:
            w[k] = sum((v[j] * z[k - j] for j in range(k + 1)), arb(0))
            p[k] = (w[k] - sum((p[j] * g[k - j] for j in range(k)), arb(0))) / g[0]
            rate = v[k] - s0 * p[k]
            z[k + 1] = rate / (k + 1)
            friction = s0 * z[k] + s1 * rate + f_v * v[k]
        else:
            friction = g[k] + f_v * v[k]
        v[k + 1] = (applied - friction) / (k + 1)
        x[k + 1] = v[k] / (k + 1)
    return x, v, z


def march(model, state, t, times, force, step):
    """States at the given times; step(v) is how far a series is trusted."""
    found, t = [], arb(t)
    for end in times:
        while t < arb(end):
            series = coefficients(model, state, t, force)
            h = arb(step(float(series[1][0])))
            if t + h >= arb(end):
                h = arb(end) - t
            state = [sum((c * h**k for k, c in enumerate(row)), arb(0)).mid() for row in series]
            t = (t + h).mid()
            assert state[1] >= 0  # the sign the series assumes
        found.append([s.str(22, radius=False) for s in state])
    return found


def main():
    peak = {"F_c": "1", "F_s": "1.2", "F_v": "0.05", "v_s": "0.1"}
    ramp, rest = ("0", "0.5"), [arb(0)] * 3
    late = [f"{2.4 + 0.38 * k:.2f}" for k in range(1, 21)]
    evenly = [f"{0.5 * k:g}" for k in range(1, 21)]
    cases = [
        {"model": peak, "start": "2.4", "times": late, "step": lambda v: 0.01 if v < 0.5 else 0.02},
        {
            "model": peak | {"sigma0": "500", "sigma1": "0"},
            "times": evenly,
            "step": lambda v: min(0.005, 4 / (500 * v + 1)),
        },
        {
            "model": peak | {"sigma0": "500", "sigma1": "10"},
            "times": evenly[:8],
            "step": lambda v: min(0.005, 4 / (500 * v + 1)),
        },
        {
            "model": peak | {"sigma0": "1e5", "sigma1": "0"},
            "times": evenly[:7],
            "step": lambda v: min(0.004, 4 / (1e5 * v + 1)),
        },
    ]
    for case in cases:
        case["states"] = march(case["model"], rest, case.get("start", "0"), case["times"], ramp, case.pop("step"))
        print(case["model"], case["states"][-1], flush=True)  # noqa: T201
    text = json.dumps({"force": ramp, "cases": cases}, indent=1)
    (Path(__file__).parent / "friction_cases.json").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    with ctx.workprec(BITS):
        main()
