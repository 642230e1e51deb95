"""The surface of `tline frequency`: numbers, files, mistakes."""

import json
import re
from pathlib import Path

import command_line
import numpy as np
import pytest
from command_line import assert_refused
from run_scenes import driven_cable

CABLE = driven_cable(
    '[loads.end]\nat = "far"\nkind = "resistor"\nresistance = 400', "40 ns", source="pump", resistance=200
)


@pytest.fixture(autouse=True)
def folder(folder: Path) -> Path:
    for name in ("cable.toml", "network.toml"):
        (folder / name).write_text(CABLE, encoding="utf-8")
    return folder


def run(line):
    return command_line.run(f"frequency {line}")


def test_transfer_function_and_oscillations() -> None:
    told = json.loads(run("cable.toml --from '1 MHz' --to '1.1 GHz' --points 3 --json").stdout)
    f, x = np.array(told["frequency"]), None
    x = np.exp(-2j * np.pi * f * 1e-9)
    exact = 0.2 * x * (1 + 7 / 9) / (1 - 0.6 * 7 / 9 * x**2)
    seen = np.array(told["values"]["far"]["re"]) + 1j * np.array(told["values"]["far"]["im"])
    assert np.abs(seen - exact).max() < 1e-14
    modes = told["natural_oscillations"]
    assert [mode["frequency"] for mode in modes] == pytest.approx([0.5e9, 1e9], rel=1e-9)
    decay = -np.log(0.6 * 7 / 9) / 2e-9
    assert modes[0]["quality"] == pytest.approx(np.hypot(decay, np.pi * 1e9) / (2 * decay), rel=1e-9)
    assert modes[0]["decay_time"] == pytest.approx(1 / decay, rel=1e-9)
    assert told["unit"] == "V/V"
    table = run("cable.toml --from '1 MHz' --to '1.1 GHz'").stdout
    assert re.match(
        r"voltage / source +lowest magnitude \[V/V\] +highest magnitude \[V/V\]\nfar +\S+ at \S+ Hz ", table
    )
    assert f"\n  5e+08 Hz, Q = {modes[0]['quality']:.4g}, decays by a factor e in {1 / decay:.4g} s\n" in table


def test_waves_that_grow_are_listed_even_below_the_lowest_frequency(folder: Path) -> None:
    active = CABLE.replace('"resistor"\nresistance = 400', '"impedance"\nexpression = "-90"')
    (folder / "cable.toml").write_text(active, encoding="utf-8")
    done = run("cable.toml --from '100 MHz' --to '0.9 GHz' --plot b.png")
    assert done.exit_code == 0, done.output
    rate = np.log(0.6 * 140 / 40) / 2e-9
    assert f"waves that grow:\n  0 Hz, grow by a factor e in {1 / rate:.4g} s\n  5e+08 Hz, grow by" in done.stdout
    told = json.loads(run("cable.toml --from '100 MHz' --to '0.9 GHz' --json").stdout)
    assert [mode["decay_time"] for mode in told["natural_oscillations"]] == pytest.approx([-1 / rate] * 2, rel=1e-9)


def test_oscillations_that_are_not_found_are_noted() -> None:
    done = run("cable.toml --to 1e15")
    assert done.exit_code == 0
    assert done.stderr == "note: no natural oscillations are listed: too many waves on the lines to be searched\n"


def test_flows_have_their_units_too(folder: Path) -> None:
    pipe = CABLE.replace("electrical", "hydraulic").replace('"voltage"', '"flow"')
    (folder / "cable.toml").write_text(pipe, encoding="utf-8")
    assert run("cable.toml --csv r.csv --points 2").exit_code == 0
    units = ["[Pa/(m^3/s)]"] * 2 + ["[m^3/s/(m^3/s)]"] * 2
    names = [f"far {part} {unit}" for part, unit in zip(("re u", "im u", "re y", "im y"), units, strict=True)]
    assert (folder / "r.csv").read_text().partition("\n")[0] == ",".join(["frequency [Hz]", *names])


def test_files(folder: Path) -> None:
    done = run("cable.toml --csv r.csv --plot b.png --points 50")
    assert done.exit_code == 0, done.output
    table = np.genfromtxt(folder / "r.csv", delimiter=",", names=True)
    assert len(table) == 50
    assert table.dtype.names == ("frequency_Hz", "far_re_u_VV", "far_im_u_VV", "far_re_y_AV", "far_im_y_AV")
    assert (folder / "b.png").stat().st_size > 10_000


@pytest.mark.parametrize("ports", ["near", "near,far"])
def test_touchstone_is_read_by_others(folder: Path, ports: str) -> None:
    skrf = pytest.importorskip("skrf")
    count = len(ports.split(","))
    told = json.loads(run(f"cable.toml --ports {ports} --z0 75 --points 20 --save out.s{count}p --json").stdout)
    theirs = skrf.Network(str(folder / f"out.s{count}p"))
    assert theirs.z0[0, 0] == 75
    for m, i in enumerate(ports.split(",")):
        for n, j in enumerate(ports.split(",")):
            ours = told["values"][f"S({i},{j})"]
            assert np.abs(theirs.s[:, m, n] - np.array(ours["re"]) - 1j * np.array(ours["im"])).max() < 1e-15


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("none.toml", "none.toml: cannot be read"),
        ("cable.toml --source pomp", "--source: no such source, expected 'pump', got 'pomp'"),
        ("cable.toml --ports near,fat", "--ports: no such node, expected 'far', got 'fat'"),
        ("cable.toml --from 5 --to 2", "--to: not above the lowest frequency"),
        ("cable.toml --from 0", "--from: not a positive frequency"),
        ("cable.toml --to 3s", "--to: this unit measures something else"),
        ("cable.toml --points 1", "--points: not a number of frequencies"),
        ("cable.toml --save a.s1p", "--save: is about S-parameters, expected --ports beside it, or --csv"),
        ("cable.toml --z0 50", "--z0: is about S-parameters"),
        (
            "cable.toml --ports near --source pump",
            "--source: between ports no source counts, expected either --source or --ports",
        ),
        ("cable.toml --ports near --csv a.csv", "--csv: is about a source"),
        ("cable.toml --ports near --save a.s2p", "a.s2p: does not fit the number of ports, expected .s1p or .csv"),
        ("cable.toml --plot a.txt", "--plot: unknown kind of file"),
    ],
)
def test_a_mistake_is_one_sentence(line: str, sentence: str) -> None:
    assert_refused(f"frequency {line}", sentence)


def test_angular_frequencies_are_converted() -> None:
    hertz, angular = (
        json.loads(run(f'cable.toml --from "{low}" --to "{high}" --points 3 --json').stdout)
        for low, high in (("1 MHz", "1 GHz"), ("6.283185307179586 Mrad/s", "360 deg/ns"))
    )
    assert angular == hertz
