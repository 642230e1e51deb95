"""The ledger of any network adds up; lines only ever lose; and what makes energy is named."""

import pytest
from hypothesis import given, settings, strategies as st
from one_line import FAR, one_line
from random_elements import random_elements
from random_scenes import random_scene

from tline import InputError, Scene, simulate
from tline.cli.report import ledger_as_table
from tline.solver import run as runs
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe
from tline.solver.description.resolution import resolution
from tline.solver.ledger.ledger import Ledger
from tline.solver.loop import march

ROUNDING = 1e-13  # of the turnover: sums over some thousand slabs
JUMPS = [[0, 1], [1.37, 1], [1.37, 0], [2.11, -1], [2.9, 0.3], [5, 0]]


def kept(scene: Scene) -> Ledger:
    description = describe(scene)
    ledger = runs.run(description, resolution(description), ledger=True).ledger
    assert ledger is not None
    return ledger


def adds_up(ledger: Ledger) -> None:
    total, close = ledger.total, ROUNDING * ledger.turnover
    spent = total.dissipated + total.stored + total.taken + total.unaccounted
    assert total.supplied == pytest.approx(spent, abs=close)
    for entry in ledger.entries:
        assert entry.created <= close
        if entry.where.startswith("lines"):
            assert entry.unaccounted >= -close


@settings(max_examples=4, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1), order=st.integers(1, 8), slab=st.floats(0.05, 0.45), jumps=st.booleans(),
    start=st.sampled_from(["rest", "steady"]),
)  # fmt: skip
def test_linear_networks(seed, order, slab, jumps, start):
    table = random_scene(seed, sources=True, start=start, solver={"order": order, "slab": slab}).table()
    if jumps:
        table["sources"]["s"]["value"] = {"shape": "piecewise linear", "points": JUMPS}
    adds_up(kept(Scene(**table)))


@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), order=st.integers(1, 8), slab=st.floats(0.06, 0.49))
def test_networks_with_valves_and_vessels(seed, order, slab):
    adds_up(kept(random_elements(seed, driven=True, start="steady", solver={"order": order, "slab": slab})))


@settings(max_examples=4, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), order=st.integers(1, 5), slab=st.sampled_from([0.1, 0.23]), whole=st.booleans())
def test_networks_with_losses(seed, order, slab, whole):
    """Whole delays are cut into segments, others have loss elements."""
    table = random_scene(seed, sources=True, switches=False, solver={"order": order, "slab": slab}).table()
    for line in table["lines"].values():
        line |= {"length": 1.0, "resistance": 0.3 * line["z0"], "conductance": 0.1 / line["z0"]}
        line["delay"] = round(line["delay"] / slab) * slab if whole else line["delay"]
    adds_up(kept(Scene(**table)))


def test_energies_below_all_floats():
    scene = Scene(
        medium="electrical", t_end=3.0, lines={"line": {"nodes": ["a", "b"], "z0": 1e100, "delay": 1.0}},
        sources={"s": {"at": "a", "kind": "voltage", "value": 1e-120, "resistance": 30}}, probes={"a": {"at": "a"}},
    )  # fmt: skip
    assert kept(scene).residual == 0.0


def test_a_scene_in_which_nothing_happens():
    scene = random_scene(2, solver={"order": 2, "slab": 0.2})
    ledger = kept(scene)
    assert (ledger.turnover, ledger.residual, ledger.notes) == (0.0, 0.0, ())
    assert ledger_as_table(ledger).splitlines()[-1].startswith("the ledger closes: 0 of")


def test_it_is_the_same_however_often_it_is_looked_at(monkeypatch):
    scene = random_scene(5, sources=True, solver={"order": 4, "slab": 0.2})
    once = kept(scene)
    monkeypatch.setattr(march, "LOOK", 2 * len(scene.lines) * 4 * 7)  # seven slabs
    often = kept(scene)
    assert [entry.where for entry in once.entries] == [entry.where for entry in often.entries]
    for one, other in zip(once.entries, often.entries, strict=True):
        assert one[1:] == pytest.approx(other[1:], abs=ROUNDING * once.turnover)


def test_a_line_that_makes_energy_is_named(monkeypatch):
    """The delay of one line is made to hand on a hundredth more than it was sent."""
    sine = {"shape": "sine", "amplitude": 1, "frequency": 0.2, "until": 5}
    scene = Scene(
        medium="electrical",
        t_end=50.0,
        solver={"order": 5, "slab": 0.17},
        lines={
            "one": {"nodes": ["a", "b"], "z0": 1.0, "delay": 1.0},
            "two": {"nodes": ["b", "c"], "z0": 2.0, "delay": 2**0.5 / 1.3},
        },
        sources={"s": {"at": "a", "kind": "current", "value": sine}},
        probes={"p": {"at": "a"}},
    )

    def growing(*arguments, **named):
        made = assemble(*arguments, **named)
        made.network.shift[made.network.shift_row[1]] *= 1.01
        return made

    assert kept(scene).notes == ()
    monkeypatch.setattr(runs, "assemble", growing)
    (note,) = kept(scene).notes
    assert "not accounted for; lines.two made most of it" in note


def test_a_line_that_loses_energy_is_named():
    """A jump at order 1, where the fractional delays smear it."""
    table = random_scene(7, sources=True, solver={"order": 1, "slab": 0.27}).table()
    table["sources"]["s"]["value"] = {"shape": "piecewise linear", "points": JUMPS}
    ledger = kept(Scene(**table))
    worst = max(ledger.entries, key=lambda entry: entry.unaccounted)
    (note,) = ledger.notes
    assert f"{worst.where} lost most of it, {worst.unaccounted:.3g} J" in note


def test_an_active_load_is_named():
    scene = one_line(9.0, {"z0": 1, "delay": 1}, 1, 1, {"kind": "impedance", "expression": "-5"}, probes=FAR)
    ledger = simulate(scene, active=True, ledger=True).ledger
    assert ledger is not None
    # u = 5/4 at -5 ohm, from t = 1 on
    assert ledger.notes == (f"ledger: loads.load gave {8 * 1.25**2 / 5:.3g} J more than it had taken",)


def test_a_lumped_line_has_its_account():
    scene = Scene(
        medium="electrical",
        t_end="40 ns",
        lines={
            "cable": {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns"},
            "stub": {"nodes": ["far", "end"], "z0": 50, "delay": "0.1 ps"},
        },
        sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 50}},
        loads={"r": {"at": "end", "kind": "resistor", "resistance": 100}},
        probes={"p": {"at": "far", "line": "cable"}},
    )
    result = simulate(scene, ledger=True)
    assert result.ledger is not None
    assert "stub" in result.resolution.sections
    expected = pytest.approx(35e-9 * (2 / 3) ** 2 / 100, rel=1e-4)
    assert (result.ledger.of("loads.r").dissipated, result.ledger.of("lines.stub").taken < 1e-14) == (expected, True)


def test_a_circuit_at_which_no_line_ends_has_its_accounts():
    """A source drives 1/20 A through 10 ohm, for which balances of flow alone do not tell: it closes a loop."""
    scene = Scene(
        medium="electrical",
        t_end="40 ns",
        lines={"line": {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns"}},
        sources={"s": {"nodes": ["p", "q"], "kind": "voltage", "value": 1, "resistance": 10}},
        links={"r": {"kind": "resistor", "nodes": ["p", "q"], "resistance": 10}},
        loads={"x": {"at": "q", "kind": "resistor", "resistance": 5}},
        probes={"p": {"at": "p"}},
    )
    ledger = simulate(scene, ledger=True).ledger
    assert ledger is not None
    found = ledger.of("links.r").dissipated, ledger.of("sources.s").supplied, ledger.of("loads.x").dissipated
    assert found == pytest.approx((1e-9, 1e-9, 0.0), rel=1e-12, abs=1e-25)


def test_coupled_conductors_have_none():
    scene = Scene(
        medium="electrical",
        t_end="4 ns",
        lines={
            "pair": {
                "nodes1": ["a", "b"], "nodes2": ["c", "d"], "even": {"z0": 60, "delay": "1 ns"},
                "odd": {"z0": 40, "delay": "1 ns"},
            }
        },
        probes={"p": {"at": "a"}},
    )  # fmt: skip
    with pytest.raises(InputError, match=r"lines\.pair: a ledger knows no coupled conductors"):
        kept(scene)


def test_an_account_that_is_not_there():
    with pytest.raises(InputError, match=r"lines\.nowhere"):
        kept(random_scene(1, solver={"order": 2, "slab": 0.2})).of("lines.nowhere")
