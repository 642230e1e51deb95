"""Sweeps give the same numbers to the last bit wherever their runs are made, interrupted, killed or not."""

import os
import signal
import subprocess
import sys
import threading
from concurrent.futures import Executor, Future, ThreadPoolExecutor, wait
from pathlib import Path

import numpy as np
import pytest
from sweep_functions import FLAG, kills_at_60, kills_once, last, slow

import tline as tl
from tline.solver.simulate import UnresolvedWarning

CABLE = tl.read(Path(__file__).parents[2] / "scenes" / "cable_rc.toml")
Z0 = {"lines.cable.z0": np.linspace(30.0, 90.0, 21)}  # 60 among them


def same(one: tl.Sweep, other: tl.Sweep) -> None:
    assert one.kept.keys() == other.kept.keys()
    for name, array in one.kept.items():
        np.testing.assert_array_equal(array, other[name])
    assert one.errors == other.errors


@pytest.fixture(scope="module")
def here() -> tl.Sweep:
    return tl.sweep(CABLE, Z0, keep=["extremes", last], tol=1e-4, workers=1)


class Serial(Executor):
    """The least that an executor is."""

    def submit(self, fn, /, *args, **kwargs):
        future = Future()
        future.set_result(fn(*args, **kwargs))
        return future


@pytest.mark.parametrize("executor", [Serial(), ThreadPoolExecutor(3)], ids=["serial", "threads"])
def test_on_executors(here, executor):
    with executor:
        same(here, tl.sweep(CABLE, Z0, keep=["extremes", last], tol=1e-4, executor=executor))


def test_on_processes_of_which_one_is_killed(here, tmp_path, monkeypatch):
    monkeypatch.setenv(FLAG, str(tmp_path / "killed"))
    (tmp_path / "killed").touch()  # not in this process, where the first run is made
    keep = ["extremes", kills_once]
    first = tl.sweep(CABLE, Z0, keep=keep, tol=1e-4, workers=1)
    np.testing.assert_array_equal(first["kills_once"], here["last"])
    monkeypatch.setattr("tline.sweeps.work.run_batch", _after(tmp_path / "killed"))
    found = tl.sweep(CABLE, Z0, keep=keep, tol=1e-4, workers=2)
    assert (tmp_path / "killed").exists()
    same(first, found)


def _after(flag: Path):
    """Make the first run here, and let the next process that looks for the flag be killed."""
    from tline.sweeps.executors import run_batch

    def run(task, rows):
        batch = run_batch(task, rows)
        flag.unlink()
        return batch

    return run


def test_a_run_that_kills_its_process_is_a_row(here):
    vary = {"lines.cable.z0": [30.0, 40.0, 50.0, 60.0, 70.0]}
    found = tl.sweep(CABLE, vary, keep=kills_at_60, tol=1e-4, workers=2)
    assert found.errors == {3: "the process died that ran it: out of memory, or killed"}
    assert np.isfinite(found["kills_at_60"][[0, 1, 2, 4]]).all()


def test_ctrl_c_during_a_run_keeps_what_is_done(tmp_path):
    calls = []

    def interrupted(result):
        calls.append(1)
        if len(calls) == 12:
            signal.raise_signal(signal.SIGINT)
        return slow(result)

    keeps_what_is_done(interrupted, 1, tmp_path / "part.npz")


def test_ctrl_c_while_processes_run_keeps_what_is_done(tmp_path, monkeypatch):
    batches = []

    def interrupted(waiting, **how):
        finished = wait(waiting, **how)
        batches.append(1)
        if len(batches) == 5:
            signal.raise_signal(signal.SIGINT)
        return finished

    monkeypatch.setattr("tline.sweeps.executors.wait", interrupted)
    keeps_what_is_done(slow, 2, tmp_path / "part.npz")


def keeps_what_is_done(keep, workers: int, file: Path) -> None:
    vary = {"lines.cable.z0": np.linspace(30.0, 90.0, 200)}
    with pytest.warns(tl.InterruptedWarning, match="interrupted: 200 runs, .* not run"):
        part = tl.sweep(CABLE, vary, keep=keep, tol=1e-4, workers=workers, resume=file)
    assert 1 <= part.done.sum() < 200
    kept = part[keep.__name__]
    assert np.isfinite(kept[part.done]).all()
    assert np.isnan(kept[~part.done]).all()
    with np.load(file) as saved:
        np.testing.assert_array_equal(saved["done"], part.done)


def test_what_a_file_goes_on_to_is_the_same(here, tmp_path):
    calls = []

    def last(result):
        calls.append(1)
        if len(calls) == 12:
            raise KeyboardInterrupt
        return result.probes["far"].u[-1]

    more = {"keep": ["extremes", last], "tol": 1e-4, "workers": 1, "resume": tmp_path / "part.npz"}
    with pytest.warns(tl.InterruptedWarning):
        part = tl.sweep(CABLE, Z0, **more)
    assert 0 < part.done.sum() < 12
    same(here, tl.sweep(CABLE, Z0, **more))
    assert len(calls) == 12 + 21 - part.done.sum()
    same(here, tl.sweep(CABLE, Z0, **more))
    assert len(calls) == 12 + 21 - part.done.sum()


def test_functions_that_cannot_be_sent_stay_here_or_are_told():
    lock = threading.Lock()

    def locked(result):
        with lock:
            return last(result)

    assert len(tl.sweep(CABLE, {"lines.cable.z0": [40, 50]}, keep=locked, tol=1e-4)["locked"]) == 2
    with pytest.raises(
        tl.InputError, match="keep: a function cannot be sent to other processes, expected functions at"
    ):
        tl.sweep(CABLE, Z0, keep=locked, tol=1e-4, workers=2)


UNGUARDED = """
import tline as tl
tl.sweep("scenes/cable_rc.toml", {"t_end": ["2 ns", "3 ns"]}, tol=1e-3, workers=2)
"""


def test_a_script_without_a_guard_is_told_in_a_sentence(tmp_path):
    (tmp_path / "script.py").write_text(UNGUARDED)
    root = Path(__file__).parents[2]
    command = [sys.executable, str(tmp_path / "script.py")]
    done = subprocess.run(command, capture_output=True, text=True, cwd=root, env=os.environ | {"PYTHONPATH": str(root)})
    sentence = (
        'workers: the processes of the sweep die as they start, expected calls of a script under '
        'if __name__ == "__main__":, or workers=1'
    )  # fmt: skip
    assert (
        sum(line.endswith(sentence) for line in done.stderr.splitlines()) == 1
    )  # Python may warn of semaphores after it


def test_on_eight_threads_of_dask():
    distributed = pytest.importorskip("distributed")
    here = tl.sweep(CABLE.change({"solver.tol": 1e-4}), VALUES, workers=1)
    with distributed.Client(processes=False, n_workers=8, threads_per_worker=1, dashboard_address=":0") as client:
        found = tl.sweep(CABLE.change({"solver.tol": 1e-4}), VALUES, executor=client.get_executor())
    same(here, found)


def test_on_processes_of_dask_of_which_one_is_killed(tmp_path, monkeypatch):
    distributed = pytest.importorskip("distributed")
    monkeypatch.setenv(FLAG, str(tmp_path / "killed"))
    (tmp_path / "killed").touch()
    scene = CABLE.change({"solver.tol": 1e-4})
    first = tl.sweep(scene, VALUES, keep=kills_once, workers=1)
    monkeypatch.setattr("tline.sweeps.work.run_batch", _after(tmp_path / "killed"))
    with distributed.Client(processes=True, n_workers=2, threads_per_worker=1, dashboard_address=":0") as client:
        found = tl.sweep(scene, VALUES, keep=kills_once, executor=client.get_executor())
    assert (tmp_path / "killed").exists()
    same(first, found)


VALUES = {"loads.receiver.kind": ["parallel"], "lines.cable.z0": np.linspace(30.0, 90.0, 21)}  # not side by side


@pytest.mark.parametrize("workers", [1, 2])
def test_what_is_not_resolved_is_said_once(workers, tmp_path):
    coarse = CABLE.change({"t_end": "2 ns", "solver": {"order": 2, "slab": "0.5 ns"}})
    file = tmp_path / "sweep.npz"
    with pytest.warns(UnresolvedWarning) as said:
        found = tl.sweep(coarse, {"lines.cable.z0": [40.0, 50.0, 60.0]}, keep=last, workers=workers, resume=file)
    sentence = "not all is resolved in 3 of 3 runs, run 0: loads.receiver: its time scale of 1.14e-10 s is shorter than"
    assert [str(each.message)[: len(sentence)] for each in said] == [sentence]
    with pytest.warns(UnresolvedWarning):
        again = tl.sweep(coarse, {"lines.cable.z0": [40.0, 50.0, 60.0]}, keep=last, resume=file)
    assert again.unresolved == found.unresolved
