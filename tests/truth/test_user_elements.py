"""Elements whose law is a Python method: recursions per bounce in 40 digits, closed forms, and who made energy."""

import copy
import math
import pickle

import mpmath as mp
import numpy as np
import pytest
from one_line import from_tank

from tline import InputError, Scene, simulate
from tline.scene.file import scene_from, scene_text
from tline.scene.user_defined import UserLink, UserLoad

Z0, DELAY, HEAD = 2e7, 0.1, 6e5
RAMP = {"shape": "ramp", "from": 1, "to": 0, "at": 0.05, "duration": 0.73}


class Cubic(UserLoad):
    """i = opening·(g u + k u³)."""

    g: float
    k: float = 0.0

    def flow(self, effort, opening):
        return opening * (self.g * effort + self.k * effort**3)


class Root(UserLink):
    """An orifice."""

    capacity: float

    def flow(self, effort, opening):
        return math.copysign(opening * self.capacity * math.sqrt(abs(effort)), effort)


def pipe(load, **more) -> Scene:
    """A pipe from a tank to it."""
    given = {"t_end": 2.0, "solver": {"order": 8, "slab": 0.05}} | more
    return from_tank(pipe={"z0": Z0, "delay": DELAY}, pressure=HEAD, loads={"x": load}, **given)


@pytest.mark.parametrize("g", [0.4, -0.4])
def test_a_cubic_end_is_its_recursion_per_bounce(g):
    """It feeds waves below u² = -g/k if g < 0: then the effort lies beyond the wave that arrives."""
    g, k = g / Z0, 0.3 / Z0 / HEAD**2
    probe = simulate(pipe(Cubic(at="end", g=g, k=k, opening=RAMP))).probes["end"]
    with mp.workdps(40):

        def end(a, t):
            share = Z0 * min(max(1 - (mp.mpf(t) - mp.mpf("0.05")) / mp.mpf("0.73"), 0), 1)
            if share == 0:
                return a
            p, q = (1 + share * g) / (share * k), a / (share * k)
            root = mp.sqrt(q**2 / 4 + p**3 / 27)  # Cardano's, with p > 0
            return mp.cbrt(root + q / 2) - mp.cbrt(root - q / 2)

        a = HEAD + Z0 * (g * HEAD + k * HEAD**3)
        exact = []
        for t in probe.t[1:]:
            times = [mp.mpf(float(t)) - 2 * n * mp.mpf(DELAY) for n in range(int(t / (2 * DELAY)) + 1)][::-1]
            wave, u = a, mp.mpf(HEAD)
            for n, instant in enumerate(times):
                wave = wave if n == 0 else 2 * HEAD - (2 * u - wave)
                u = end(wave, instant)
            exact.append(float(u))
    assert np.abs(probe.u[1:] - exact).max() < 1e-10 * HEAD


def test_links_in_a_row_are_one():
    """1/C² adds up; nothing conducts between a user's orifice and a built-in one."""
    capacity, kv = 150 / 3600 / 1e5**0.5, 200
    links = {"v": Root(nodes=["end", "far"], capacity=capacity, opening=RAMP)}
    both = simulate(pipe({"at": "far", "kind": "orifice", "kv": kv, "opening": RAMP}, links=links)).probes["end"].u
    kv = (1 / 150**2 + 1 / 200**2) ** -0.5
    one = simulate(pipe({"at": "end", "kind": "orifice", "kv": kv, "opening": RAMP})).probes["end"].u
    assert np.abs(both - one).max() < 1e-9 * HEAD


def test_one_that_makes_energy_is_named():
    """A conductance -g at the tank's level for t_end gives g u² t_end; the pipe rests in its steady state."""
    g = 0.1 / Z0
    result = simulate(pipe(Cubic(at="end", g=-g)))
    joules = g * HEAD**2 * 2.0
    assert result.ledger.of("loads.x").created == pytest.approx(joules, rel=1e-10)
    assert result.remarks[0] == f"loads.x gave {joules:.3g} J more than it had taken: its law is active"


def test_one_that_takes_energy_is_not():
    result = simulate(pipe(Cubic(at="end", g=0.1 / Z0, k=0.2 / Z0 / HEAD**2, opening=RAMP)))
    assert not [remark for remark in result.remarks if "active" in remark]
    assert result.ledger.of("loads.x").dissipated > 0


class Wrong(UserLoad):
    """A law with a mistake."""

    answer: str

    def flow(self, effort, opening):
        if self.answer == "interrupt":
            raise KeyboardInterrupt
        return math.log(-1 - abs(effort)) if self.answer == "raise" else {"none": None, "nan": math.nan}[self.answer]


@pytest.mark.parametrize(
    ("answer", "problem"),
    [
        ("raise", r"loads\.x: Wrong\.flow\(.*\) raised ValueError: .*, expected a finite number"),
        ("none", r"loads\.x: Wrong\.flow\(.*\) raised TypeError: .*, expected a finite number"),
        ("nan", r"loads\.x: Wrong\.flow\(.*\) returned nan, expected a finite number"),
    ],
)
def test_mistakes_in_a_law_are_told(answer, problem):
    with pytest.raises(InputError, match=problem):
        simulate(pipe(Wrong(at="end", answer=answer)))


def test_an_interrupt_in_a_law_ends_the_run():
    with pytest.raises(KeyboardInterrupt):
        simulate(pipe(Wrong(at="end", answer="interrupt")))


def test_a_link_is_no_load():
    with pytest.raises(InputError, match=r"loads\.x: does not fit here, expected an UserLoad, got 'Root'"):
        pipe(Root(nodes=["tank", "end"], capacity=1.0))


def test_its_key_for_the_opening_is_checked():
    with pytest.raises(InputError, match=r"loads\.x\.opening: out of range, expected from 0 to 1, got 2"):
        pipe(Cubic(at="end", g=1.0, opening=2))


def test_a_scene_with_changes_keeps_it_and_a_file_names_its_class():
    scene = pipe(Cubic(at="end", g=1e-9))
    assert scene.with_changes(t_end=1.0).loads["x"] is scene.loads["x"]
    assert 'kind = "Cubic"' in scene_text(scene)
    with pytest.raises(InputError, match=r"loads\.x\.kind: unknown.*got 'Cubic'"):
        scene_from(scene.table() | {"loads": {"x": {"at": "end", "kind": "Cubic", "g": 1e-9}}})


def test_a_copy_has_a_law_of_its_own():
    one = Cubic(at="end", g=1e-9)
    simulate(pipe(one))
    for other in (one.model_copy(update={"g": 5e-9}), copy.copy(one).model_copy(update={"g": 5e-9})):
        assert simulate(pipe(other)).probes["end"].y[0] == pytest.approx(5e-9 * HEAD, rel=1e-12)
    sent = pickle.loads(pickle.dumps(pipe(one)))
    assert sent == pipe(Cubic(at="end", g=1e-9))
    assert simulate(sent).probes["end"].y[0] == pytest.approx(1e-9 * HEAD, rel=1e-12)


def test_a_law_that_falls_too_fast_has_no_answer():
    push = {"s": {"at": "end", "kind": "flow", "value": 1e-3}}
    with pytest.raises(InputError, match=r"loads\.x"):
        simulate(pipe(Cubic(at="end", g=-2 / Z0), start="rest", sources=push))
