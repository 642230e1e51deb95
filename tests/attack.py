"""Random inputs by seed, each judged: ``python tests/attack.py KIND [FROM TO]``.

Prints each seed with a wrong answer, the number of answers of each kind, and the largest of each measure with its seed.
Inputs and judges are those of the tests, which take a few seeds; `python tests/fuzz_commands.py` attacks the commands.
"""

import argparse
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tline.errors import InputError, NoFlowError


class Answer(NamedTuple):
    """Kind of an answer, its measures, and its error."""

    word: str
    sizes: dict[str, float] = {}  # noqa: RUF012
    wrong: str = ""


Judge = Callable[[int], Iterator[Answer]]


def events(seed: int) -> Iterator[Answer]:
    """Moving elements next to kinked laws, against bounces: true errors at most three times the estimated ones."""
    from random_events import ROUNDING, random_events

    from tline.solver.simulate import simulate

    scene, tol, worst = random_events(seed), (1e-3, 1e-4, 1e-6)[seed % 3], 0.0
    result = simulate(scene.scene, tol=tol)
    t = np.sort(np.random.default_rng(0).uniform(0, scene.t_end, 120))
    exact = scene.exact(t)
    largest = max(np.abs(u).max() for u, _ in exact.values())
    for name, true in exact.items():
        probe, told = result.probes[name], result.accuracy.inside.get(name)
        seen, errors = probe.at(t), (told.u, told.y) if told else (tol, tol)
        for found, wanted, error, size in zip((seen.u, seen.y), true, errors, (1, probe.record.z0), strict=True):
            amplitude = np.abs(wanted).max()
            if size * amplitude > 1e-8 * largest:
                off = np.abs(found - wanted).max() - ROUNDING[scene.joined is not None] * largest / size
                worst = max(worst, off / (min(error, tol) * amplitude))
    yield _told(result.accuracy, worst)


def stores(seed: int) -> Iterator[Answer]:
    """Moving elements next to vessels, tanks, cavities, pumps and regulating valves, against fixed orders."""
    from random_stores import excess, random_stores

    from tline.solver.simulate import simulate

    result = simulate(random_stores(seed), tol=(1e-2, 1e-3, 1e-4)[seed % 3])
    yield _told(result.accuracy, excess(result))


def _told(accuracy, worst: float) -> Answer:
    disagree = accuracy.limit.startswith("two methods")
    said = "met" if accuracy.met else "two methods disagree" if disagree else "not met"
    wrong = f"{said}, {worst:.2g} times what is told" if disagree or (accuracy.met and worst > 3) else ""
    return Answer(said, {"error over what is told, of those met": worst} if accuracy.met else {}, wrong)


def tolerance(seed: int) -> Iterator[Answer]:
    """Scenes of every kind at three tolerances, against far narrower slabs, at the slab ends."""
    from kept import kept
    from random_kinks import KINDS, random_kinks

    for kind in KINDS:
        for tol in (1e-3, 1e-5, 1e-7):
            with _Refusals() as refused:
                found = kept(random_kinks(seed, kind), tol)
                if _outside(found):  # kinks blur the first look
                    again = kept(random_kinks(seed, kind), tol, 64)
                    found = found._replace(**{key: min(getattr(found, key), getattr(again, key)) for key in MEASURES})
                sizes = {what: getattr(found, key) for key, what in MEASURES.items() if key != "over" or found.met}
                wrong = f"{kind}, {tol:.0e}: {found}" if _outside(found) else ""
                yield Answer("met" if found.met else "not met", sizes, wrong)
            yield from refused


MEASURES = {
    "inside": "error at any instant over what was told",
    "over": "error at any instant over a tolerance said to be met",
    "extreme": "error of a printed extreme over its own ±",
}


def _outside(found) -> bool:
    return found.inside > 2 or found.extreme > 1 or (found.met and found.over > 2)


def memory(seed: int) -> Iterator[Answer]:
    """Lossy trees and bundles with laws, against BDF2's quadrature of their own admittances."""
    from random_memory import judge, random_memory

    tol, began = (1e-3, 1e-5)[seed // 4 % 2], time.process_time()
    found = judge(random_memory(seed), tol)
    wrong = f"{tol:.0e}: {found}" if found.met and found.over > 3 else ""
    sizes = {"s of CPU, with the reference": time.process_time() - began}
    sizes |= {"error over what is told, of those met": found.over} if found.met else {}
    yield Answer("met" if found.met else "not met", sizes, wrong)


def curve(seed: int) -> Iterator[Answer]:
    """Scenes of every kind at tolerances from 1e-3 to 1e-10, at arbitrary instants, against independent solutions."""
    from curve_cases import LOSSLESS, LOSSY, found

    for name, make in (LOSSLESS | LOSSY).items():
        case = make(np.random.default_rng([seed, sum(map(ord, name))]))
        for tol in 10.0 ** -np.arange(3, 11):
            with _Refusals() as refused:
                seen = found(case, tol, seed)
                sizes = {key: float(getattr(seen, key)) for key in ("over", "beyond", "extreme")} if seen.met else {}
                yield Answer(
                    "met" if seen.met else "not met", sizes, f"{name}, {tol:.0e}: {seen}" if seen.outside else ""
                )
            yield from refused


def circuits(seed: int, vessels: bool = False) -> Iterator[Answer]:
    """Lumped circuits between lines, random waves without input for 40 slabs: the energy does not grow."""
    from circuit_energy import largest_growth
    from random_circuits import random_circuit

    yield _energy(
        lambda: random_circuit(seed, 1 + seed % 8, vessels=vessels), lambda table: largest_growth(table, seed, 40), 1e-9
    )


def chains(seed: int) -> Iterator[Answer]:
    """Rows of laws between lines: their waves decay."""
    from random_chains import fade, random_chains

    yield _energy(lambda: random_chains(seed, 1 + seed % 16), lambda table: fade(table, seed), 1e-9)


def _energy(make: Callable[[], dict], measure: Callable[[dict], float], most: float) -> Answer:
    """Measure a scene, with narrower slabs if no flow is found, as runs do it."""
    for parts in (1, 4, 16):
        scene = make()
        scene["solver"]["slab"] /= parts
        try:
            size = measure(scene)
        except NoFlowError:
            continue
        return Answer(f"slab in {parts}", {"growth, or what is left": size}, f"{size:.1e}" if size > most else "")
    return Answer("no flow", {}, "no flow")


def decks(seed: int, kind: str = "DECKS") -> Iterator[Answer]:
    """Corrupted netlists, IBIS or Touchstone files are read, or refused in a sentence, within seconds."""
    import mutated_files

    with tempfile.TemporaryDirectory() as folder:
        name, text = mutated_files.mutated(seed, getattr(mutated_files, kind))
        found = mutated_files.outcome(text, Path(folder), name)
    yield Answer(found.partition(":")[0], {}, f"{name}: {found}" if found.startswith("fault") else "")


def statics(seed: int) -> Iterator[Answer]:
    """Static friction run twice, to another end and with other samples: equal events, each of them possible."""
    from random_friction import KINDS, random_run, sound

    from friction import Status, simulate

    kind, rng = KINDS[seed % 4], np.random.default_rng((20, seed))
    model, bench, t_end = random_run(rng, kind)
    run, part = simulate(model, bench, t_end, times=[t_end]), t_end * float(rng.uniform(0.1, 1.0))
    again = simulate(model, bench, part, times=np.unique(rng.uniform(0.0, part, 7)))
    same = again.events == [event for event in run.events if event.t <= part] and sound(run.events)
    good = same and run.status is again.status is Status.DONE
    yield Answer(kind, {"events": run.event_count}, "" if good else f"{run.status}, {run.event_count} events")


def bristles(seed: int) -> Iterator[Answer]:
    """LuGre, Dahl and elasto-plastic contacts over wide scales, against Taylor series of order 26."""
    from friction_scales import FORCES, judge

    run, share, over = judge(seed)
    sizes = {} if np.isnan(over) else {"true over told": over, "true over tolerance": share}
    yield Answer(f"{FORCES[seed % len(FORCES)]}: {run.status}", sizes, f"{over:.2g} times as told" if over > 3 else "")


def smooth(seed: int) -> Iterator[Answer]:
    """Smooth laws of friction at four tolerances, against SciPy's DOP853."""
    from friction_by_scipy import END, TOLS, largest_errors, random_case, reference

    model, bench = random_case(np.random.default_rng((5, seed)))
    times = np.linspace(0.0, END, 401)
    exact = reference(model, bench, times)
    for tol in TOLS:
        errors, estimate = largest_errors(model, bench, exact, times, tol)
        share, over = float(errors.max() / tol), float(errors.max() / estimate)
        if np.isnan(share):
            yield Answer(f"{tol:g}: not done")
            continue
        wrong = f"tolerance {tol:g}: {share:.2g} times, {over:.2g} times as told" if share > 1 else ""
        yield Answer(f"{tol:g}", {"true over tolerance": share, "true over told": over}, wrong)


def identification(seed: int) -> Iterator[Answer]:
    """Parameters of random laws from forces by SciPy with 1 % noise: 95.4 % should lie within two deviations."""
    from identified import TIMES, VELOCITY, random_law, record

    from friction import MODELS, identify

    for number, name in enumerate(MODELS):
        rng = np.random.default_rng((31, number, seed))
        law = random_law(name, rng)
        found = identify(TIMES, record(law, rng), velocity=VELOCITY, models=(name,)).fits[name]
        for key, value in found.parameters.items():
            inside = abs(getattr(law, key) - value) <= 2.0 * found.deviations[key]
            yield Answer(f"{name} {'within' if inside else 'beyond'} 2σ")


def mechanisms(seed: int) -> Iterator[Answer]:
    """Masses on contacts behind springs with play, under a PID, against steps of DOP853 from event to event."""
    from random_mechanisms import END, TIMES, by_friction, by_steps, random_row

    row, times = random_row(seed), np.linspace(0.0, END, TIMES)
    status, found = by_friction(row, times)
    exact = by_steps(row, times)
    off = float(np.abs(found.states - exact.states).max() / np.abs(exact.states).max())
    counts = [[len(one) for one in moved.events] for moved in (found, exact)]
    wrong = (
        ""
        if status == 0 and off < 1e-7 and counts[0] == counts[1]
        else f"status {status}, events {counts}, {off:.1e} off"
    )
    yield Answer("with the same events" if counts[0] == counts[1] else "with other events", {"off": off}, wrong)
    for _ in range(sum(counts[0])):
        yield Answer("events")


def bandwidths(seed: int) -> Iterator[Answer]:
    """Random drives: bandwidth of unit loop gain of the closed loop, in floats, over the requested one."""
    from random_drives import random_design

    with _Refusals() as refused:
        made, asked = random_design(seed)
        for name, ratio in asked.items():
            told = any(name in one for one in made.verdicts)
            good = told or abs(ratio - 1.0) < 0.1
            word = "told in a sentence" if told else "reached"
            yield Answer(word, {} if told else {"off": abs(ratio - 1.0)}, "" if good else f"{name}: {ratio:.3g} times")
    yield from refused


def waterworks(seed: int) -> Iterator[Answer]:
    """Imported networks after a start-up, a burst and a closing settle at the steady state of EPANET."""
    from random_waterworks import waterworks
    from settling import good, measured

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "works.inp")
        path.write_text(waterworks(seed), encoding="utf-8")
        for one in measured(path):
            off = {"off, m": abs(one["off"])} if "off" in one else {}
            yield Answer(one.get("kind", "left out"), off, f"{one}" if off and not good(one) else "")


def identities(seed: int) -> Iterator[Answer]:
    """What follows from a proved positive real function, however it is written."""
    from random import Random

    from random_identities import ASSUME, FORMS, impedance

    from passivity import is_positive_real

    random = Random(seed)
    x = impedance(random, random.randint(1, 4), True)
    for name, (text, ask) in FORMS.items() if is_positive_real(x, ASSUME).proved else ():
        found = ask(f"let x = {x}; {text.format('x')}", ASSUME)
        yield Answer(found.status.value, {}, "" if found.proved else f"{name} of {x}: {found.why}")


KINDS: dict[str, tuple[Judge, int]] = {  # with the number of seeds for some minutes
    "events": (events, 300),
    "stores": (stores, 100),
    "tolerance": (tolerance, 5),
    "memory": (memory, 20),
    "curve": (curve, 2),
    "circuits": (circuits, 1000),
    "vessels": (lambda seed: circuits(seed, vessels=True), 50),
    "chains": (chains, 100),
    "decks": (decks, 5000),
    "ibis": (lambda seed: decks(seed, "IBIS"), 1000),
    "touchstone": (lambda seed: decks(seed, "TOUCHSTONE"), 1000),
    "statics": (statics, 1000),
    "bristles": (bristles, 200),
    "smooth": (smooth, 40),
    "identification": (identification, 100),
    "mechanisms": (mechanisms, 200),
    "bandwidths": (bandwidths, 1000),
    "waterworks": (waterworks, 15),
    "identities": (identities, 1000),
}


class _Refusals:
    """Context in which a refusal counts as an answer, added to its list."""

    def __enter__(self) -> list[Answer]:
        self.found: list[Answer] = []
        return self.found

    def __exit__(self, kind, error, trace) -> bool:
        if isinstance(error, InputError):
            self.found.append(Answer(f"refused: {error.problem}"))
            return True
        return False


def attack(kind: str, first: int, after: int) -> int:
    """Judge seeds, and count wrong answers."""
    judge, counts, largest, bad = KINDS[kind][0], Counter[str](), dict[str, tuple[float, int]](), 0
    for seed in range(first, after):
        with _Refusals() as answers:
            answers += judge(seed)
        for answer in answers:
            counts[answer.word] += 1
            for what, size in answer.sizes.items():
                largest[what] = max(largest.get(what, (0.0, seed)), (float(size), seed))
            if answer.wrong:
                bad += 1
                print(f"{kind} {seed}: {answer.wrong}", flush=True)
    print(f"{kind}, seeds {first} to {after - 1}: {bad} wrong;", ", ".join(f"{n} {what}" for what, n in counts.items()))
    for what, (size, seed) in largest.items():
        print(f"    largest {what}: {size:.2g} (seed {seed})")
    return bad


def main() -> int:
    """Judge all kinds, or one, on its usual seeds or those given."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kind", nargs="?", choices=KINDS)
    parser.add_argument("first", nargs="?", type=int, default=0, help="seed")
    parser.add_argument("after", nargs="?", type=int, help="the seed after the last")
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    kinds = [asked.kind] if asked.kind else [*KINDS]
    return sum(attack(kind, asked.first, asked.after or KINDS[kind][1]) for kind in kinds)


if __name__ == "__main__":
    sys.exit(min(main(), 1))
