"""Tables, pictures, scenes and the judge of the work-precision charts."""

import csv
from math import inf

import numpy as np
import pytest

from tline.errors import InputError
from tline.study.charts import work_precision
from tline.study.charts.measure import QUICK, ChartTable, Judge, Row, TimedRun
from tline.study.charts.picture import draw
from tline.study.charts.scenes import NAMES, chart_scene
from tline.study.charts.work_precision import add, fixed, refined, simulated, to_tolerances
from tline.study.programs import ngspice, rthym, tsnet
from tline.study.reference import exact

pytestmark = pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")  # coarse on purpose


def row(method="slabs s = 2", kind="ours", error=1e-3, **more):
    return Row(method, kind, "8 slabs", error, error / 2, 0.02, 0.01, **more)


def test_a_table_is_saved_with_its_notes(tmp_path):
    table = ChartTable("rc", "A title", [row(), row(kind="tolerance", asked=1e-3, estimated=2e-4)], ["absent: nobody"])
    table.save(tmp_path / "t.csv")
    lines = (tmp_path / "t.csv").read_text(encoding="utf-8").splitlines()
    assert lines[:2] == ["# A title", "# absent: nobody"]
    rows = list(csv.DictReader(lines[2:]))
    assert [float(r["error"]) for r in rows] == [1e-3, 1e-3]
    assert [float(r["asked"]) for r in rows] == [inf, 1e-3]


def test_a_picture_has_a_curve_for_each_method_and_units():
    rows = [row(), row("MOC", "baseline", 2.0), row("MOC", "baseline", inf), row("ngspice", "peer", 0.0)]
    rows.append(row("to a tolerance", "tolerance", 1e-5, asked=1e-4, estimated=3e-5))
    picture = draw(ChartTable("rc", "A title", rows))
    labels = [text.get_text() for text in picture.legends[0].get_texts()]
    assert labels[:3] == ["slabs s = 2", "MOC", "ngspice"]
    found = []
    for axes in picture.axes:
        assert axes.get_xlabel().endswith("[s]")
        low, high = axes.get_ylim()
        found.append({line.get_label(): line for line in axes.lines})
        assert all(((low <= y) & (y <= high)).all() for y in (np.asarray(line.get_ydata()) for line in axes.lines))
    whole, arithmetic = found
    assert list(whole["… asked"].get_ydata()) == [1e-4]
    stars = [side["to a tolerance: true"].get_xydata().tolist() for side in (whole, arithmetic)]
    assert stars == [[[0.02, 1e-5]], [[0.01, 5e-6]]]


@pytest.mark.parametrize("name", NAMES)
def test_chart_scenes_have_titles_of_their_own_and_probes_at_nodes(name):
    given = chart_scene(name)
    assert given.scene.title == given.title
    assert all(probe.at for probe in given.scene.probes.values())


def test_an_unknown_scene_is_refused():
    with pytest.raises(InputError, match="no such chart scene, expected 'chain'"):
        chart_scene("chian")


def test_the_judge_weighs_errors_by_the_amplitude():
    scene = chart_scene("rc").scene
    judge = Judge(scene, 40)
    t = np.linspace(0, scene.t_end, 2001)
    u = exact(scene, t.tolist(), "far").efforts

    def errors(u, between=None):
        return judge.errors(TimedRun(t, {"far": u}, 0.0, 0.0, between=between))

    def solved(_, t):
        return exact(scene, t.tolist(), "far").efforts

    assert max(errors(u, solved)) < 1e-16  # rounded from so many digits
    times = judge.times["far"]
    lines = np.abs(np.interp(times, t, u) - solved("far", times)).max() / judge.amplitude  # as programs draw them
    assert errors(u) == pytest.approx((lines, 0.0), rel=1e-9, abs=1e-16)
    off = errors(u + 0.01 * judge.amplitude, lambda probe, t: solved(probe, t) + 0.02 * judge.amplitude)
    assert off == pytest.approx((0.02, 0.01), rel=1e-12)
    assert errors(np.where(t > 1e-8, np.nan, u)) == (inf, inf)


def test_refinement_ends_where_it_is_exact_or_too_slow():
    class Fixed:
        own = 0.0

        def errors(self, run):
            return run.u, run.u

    def rows(errors, seconds):
        effort = QUICK._replace(refinements=9, runs=1, longest=0.0)
        runs = iter([TimedRun(0, e, t, t) for e, t in zip(errors, seconds, strict=True) for _ in range(2)])
        return len(list(refined("m", "baseline", lambda n: next(runs), "steps", Fixed(), effort)))

    assert rows([0.1, 0.01, 1e-15, 1.0], 4 * [0.0]) == 3
    assert rows(5 * [0.1], [0, 0, 0, 1, 1]) == 4
    assert rows(20 * [0.1], 20 * [0]) == 9


def test_a_method_that_never_runs_is_named():
    table = ChartTable("rc", "")

    def broken(n):
        raise InputError("it", "is broken")

    add(table, "broken", "peer", broken, Judge(chart_scene("rc").scene, 5), QUICK)
    assert table.notes == ["absent: broken (it: is broken)"]
    assert not table.rows


def test_a_quick_chart_has_all_methods_and_errors_that_fall_with_the_order():
    table = work_precision.work_precision("rc", quick=True)
    curves = dict(table.curves())
    assert {"slabs s = 5", "MOC, Courant 1", "to a tolerance", "FDTD leapfrog"} <= curves.keys()
    coarsest = [curves[f"slabs s = {s}"][0].error_at_own for s in (2, 3, 5, 8)]
    assert coarsest[0] > 2 * coarsest[1] > 20 * coarsest[2] > 2000 * coarsest[3]
    assert all(r.error <= 3 * r.asked and r.estimated <= r.asked for r in curves["to a tolerance"])
    assert all(0 < r.stepping <= r.seconds for r in table.rows)


def test_tolerances_below_what_the_judge_knows_are_left_out():
    scene = chart_scene("rc").scene
    judge = Judge(scene, 5)
    judge.own = 1e-5
    assert [row.asked for row in to_tolerances(scene, judge, QUICK)] == [1e-3]


def test_peers_that_are_not_installed_are_named(monkeypatch):
    monkeypatch.setattr("shutil.which", lambda name: None)
    notes = work_precision.peers("hammer", quick=True).notes
    assert [note.split(" (")[0] for note in notes][:2] == ["absent: ngspice", "absent: scikit-rf, inverse FFT"]
    assert "apt install ngspice" in notes[0]


def test_the_scene_in_spice():
    cards = ngspice.netlist(chart_scene("rlc").scene, 1e-12).splitlines()
    assert cards[3] == "Rsource Vsource.s near 25.0"
    assert cards[4:7] == ["Rload far Lload.x 10.0", "Lload Lload.x Cload.x 5e-08", "Cload Cload.x 0 2e-12"]
    assert cards[-3:] == [".options acct", ".tran 1e-12 2e-08 0 1e-12 uic", ".end"]


def test_a_raw_file_is_read():
    data = np.array([[0.0, 1.0], [0.5, 2.0], [1.0, 4.0]])
    head = b"Title: x\nVariables:\n\t0\ttime\ttime\n\t1\tv(far)\tvoltage\nBinary:\n"
    columns = ngspice.columns_of(head + data.tobytes())
    assert columns["time"].tolist() == [0.0, 0.5, 1.0]
    assert columns["v(far)"].tolist() == [1.0, 2.0, 4.0]


def test_ngspice_is_offered_no_jumps_and_no_curves():
    assert "jumps" in str(ngspice.incompatible_sources(chart_scene("step").scene))
    assert "jumps" in str(ngspice.incompatible_sources(chart_scene("smooth").scene))
    assert ngspice.incompatible_sources(chart_scene("inductor").scene) is None
    assert rthym.incompatibility(chart_scene("rc").scene) == "for water only"


def test_tsnet_is_looked_for_where_the_variable_says(monkeypatch):
    monkeypatch.delenv(tsnet.PYTHON, raising=False)
    assert str(tsnet.incompatibility(chart_scene("friction").scene)).startswith("TSNET_PYTHON names no interpreter")
    assert tsnet.incompatibility(chart_scene("hammer").scene) == "its flows stop, and none begins at rest"
    with pytest.raises(InputError, match="n: its pipes have two reaches at least"):
        tsnet.run(chart_scene("friction").scene, 2)


def test_corners_begin_where_the_waveform_does():
    shut = chart_scene("friction").scene.sources["draw"].value
    assert ngspice.corners(shut, 20.0) == [(0.0, -0.2), (0.5, 0.0), (20.0, 0.0)]


def test_a_fixed_run_is_what_was_fixed():
    done = simulated(fixed(chart_scene("rc").scene, 3, 2.5e-10))
    assert np.diff(done.t).max() == pytest.approx(2.5e-10)
    assert done.estimated == inf
