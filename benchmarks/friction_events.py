"""Events of the static laws over random runs: python -m benchmarks.friction_events [runs].

Each run is made again to another end and with other samples: its events have to be the first of the longer run, to the
bit. Ramps, sines, rigs (a spring pulls), and noisy tables at 1 kHz; most runs are short, some have 10⁵ events.
"""

import sys
import time
from collections import Counter
from itertools import pairwise

import numpy as np

from friction import Coulomb, Event, Karnopp, Kind, Model, Ramp, Sine, Spring, Status, Table, Testbench, simulate

SEED, RUNS = 20, 10_000
KINDS = ("ramp", "sine", "rig", "table")


def random_model(rng: np.random.Generator) -> Model:
    F_c, F_v = float(10.0 ** rng.uniform(-2, 2)), float(rng.choice([0.0, 10.0 ** rng.uniform(-3, 0)]))
    if rng.random() < 0.25:
        return Coulomb(F_c, F_v)
    F_s, v_s = F_c * (1.0 + float(rng.choice([0.0, rng.random()]))), float(10.0 ** rng.uniform(-3, 0))
    bare, zone = Karnopp(F_c, F_s, F_v, v_s), float(rng.choice([0.0, 0.0, 0.0, 1e-3]))
    return Karnopp(F_c, F_s, F_v, v_s, zone) if bare.steady_force(zone) <= F_s else bare


def random_run(rng: np.random.Generator, kind: str) -> tuple[Model, Testbench, float]:
    """A model, a testbench, and an end."""
    model, mass, long = random_model(rng), float(10.0 ** rng.uniform(-1, 2)), 10.0 ** rng.uniform(0.0, 3.3)
    if rng.random() < 0.005:
        long = 5e4
    F, v0 = model.stiction, float(rng.choice([0.0, rng.normal()]))
    if kind == "ramp":
        return model, Testbench(Ramp(rng.normal() * 10.0 ** rng.uniform(-3, 3), rng.normal() * F), mass, v0), 3.0 * long
    if kind == "sine":
        frequency = 10.0 ** rng.uniform(-2, 3)
        force = Sine(F * rng.uniform(0.9, 3.0), frequency, rng.normal() * 0.3 * F, rng.uniform(0.0, 6.0))
        return model, Testbench(force, mass, v0), 0.5 * long / frequency
    if kind == "rig":
        k = 10.0 ** rng.uniform(0, 4)
        speed = 10.0 ** rng.uniform(-3, 0) * F / (mass * k) ** 0.5
        return model, Testbench(Ramp(0.0), mass, v0, Spring(k, speed)), 0.5 * long * (mass / k) ** 0.5 * 6.0
    n = int(4.0 * long) + 2
    force = Table(1e-3 * np.arange(n), F * rng.uniform(0.5, 3.0) * rng.normal(size=n))
    return model, Testbench(force, mass, v0), 1e-3 * n


def sound(events: list[Event]) -> bool:
    """Whether no event lasts no time, and each may follow the one before."""
    later = all(first.t < second.t for first, second in pairwise(events))
    return later and all((a.kind is Kind.STOP) == (b.kind is Kind.BREAK_AWAY) for a, b in pairwise(events))


def main() -> None:
    runs, began = int(sys.argv[1]) if len(sys.argv) > 1 else RUNS, time.process_time()
    made, done, same, true, met = Counter(), Counter(), Counter(), Counter(), {kind: [] for kind in KINDS}
    for n in range(runs):
        kind, rng = KINDS[n % 4], np.random.default_rng((SEED, n))
        model, bench, t_end = random_run(rng, kind)
        run, part = simulate(model, bench, t_end, times=[t_end]), t_end * float(rng.uniform(0.1, 1.0))
        again = simulate(model, bench, part, times=np.unique(rng.uniform(0.0, part, 7)))
        made[kind] += 1
        done[kind] += run.status is Status.DONE and again.status is Status.DONE
        same[kind] += again.events == [event for event in run.events if event.t <= part]
        true[kind] += sound(run.events)
        met[kind].append(run.event_count)
        if not (run.status is Status.DONE and again.events == run.events[: len(again.events)] and sound(run.events)):
            print(f"run {n}: {run.status}, {run.event_count} events and {again.event_count}", flush=True)
    print(f"seed ({SEED}, n), {runs:,} runs, {time.process_time() - began:.0f} s of processor time", "")
    print("| force | runs | done | same events | sound | events | most in a run |", "|---|" + "---:|" * 6, sep="\n")
    for kind in KINDS:
        counts = [made[kind], done[kind], same[kind], true[kind], sum(met[kind]), max(met[kind])]
        print(f"| {kind} | {' | '.join(f'{count:,}' for count in counts)} |")


if __name__ == "__main__":
    main()
