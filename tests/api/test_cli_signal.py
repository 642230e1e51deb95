"""The surface of `tline tdr`, `tline eye` and `tline run --load-lines`: numbers, files, mistakes."""

import json
import re
import shlex
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from command_line import run
from run_scenes import driven_cable

from tline.cli.main import main

SCENES = Path(__file__).parents[2] / "scenes"
STATISTICAL = "eye cable.toml --probe far --bit 1e-9 --rise 1e-10 --tol 1e-3 --statistical"
CABLE = driven_cable('[loads.end]\nat = "far"\nkind = "resistor"\nresistance = 150', z0=75, resistance=75)


@pytest.fixture(autouse=True)
def folder(folder: Path) -> Path:
    (folder / "cable.toml").write_text(CABLE, encoding="utf-8")
    (folder / "scenes").symlink_to(Path(__file__).parents[2] / "scenes")
    return folder


def test_reflectometry(folder: Path) -> None:
    done = run("tdr cable.toml --port near --rise '50 ps' --z0 50 --plot t.png --csv t.csv")
    assert done.exit_code == 0, done.output
    assert "step into 'near' from 50 ohm, reflected wave per step:" in done.stdout
    told = json.loads(run("tdr cable.toml --port near --rise '50 ps' --z0 50 --json").stdout)
    table = np.genfromtxt(folder / "t.csv", delimiter=",", names=True)
    assert table["reflected"] == pytest.approx(told["reflected"], abs=1e-15)
    assert np.interp(1e-9, told["t"], told["impedance"]) == pytest.approx(75, rel=1e-9)
    assert (folder / "t.png").stat().st_size > 10_000


def test_an_open_end_is_no_number_in_json(folder: Path) -> None:
    (folder / "cable.toml").write_text(CABLE.replace("resistance = 150", "resistance = inf"), encoding="utf-8")
    told = json.loads(run("tdr cable.toml --port near --rise '50 ps' --json").stdout)
    assert max(told["reflected"]) == pytest.approx(1, abs=1e-9)


def test_eye(folder: Path) -> None:
    done = run("eye cable.toml --probe far --bit '1 ns' --rise '0.2 ns' --plot e.png --high '3 V'")
    assert done.exit_code == 0, done.output
    assert "height 2 V around 1 V, width 1e-09 s" in done.stdout  # 3 V over 75 + 150 ohm
    assert (folder / "e.png").stat().st_size > 10_000
    told = json.loads(run("eye cable.toml --probe far --bit '1 ns' --rise '0.2 ns' --bits 0011010111 --json").stdout)
    assert told["height"] == pytest.approx(2 / 3, rel=1e-6)


def test_an_eye_that_touches_its_mask_exits_with_1() -> None:
    line = "eye cable.toml --probe far --bit '1 ns' --rise '0.2 ns' --tol 1e-4 --json --mask "
    free, touched = run(line + "'0.5 ns, 0.5 V'"), run(line + "'0.5 ns, 0.7 V'")
    assert (free.exit_code, json.loads(free.stdout)["mask_hits"]) == (0, 0)
    assert (touched.exit_code, json.loads(touched.stdout)["mask_hits"]) == (1, 127)
    assert json.loads(free.stdout)["jitter"] == pytest.approx(0, abs=1e-15)


def test_a_closed_eye_exits_with_1(folder: Path) -> None:
    slow = CABLE.replace('"resistor"', '"parallel"').replace("resistance = 150", 'capacitance = "1 nF"')
    (folder / "cable.toml").write_text(slow, encoding="utf-8")
    done = run("eye cable.toml --probe far --bit '1 ns' --rise '0.2 ns' --plot e.png")
    assert done.exit_code == 1
    assert "height -" in done.stdout


def test_a_statistical_eye_with_equalisers(folder: Path) -> None:
    """A matched line: 2/3 V high, but for the edges as wide as a bit, whatever the equalisers; noise takes 14 of it."""
    line = "eye cable.toml --probe far --bit '1 ns' --rise '0.2 ns' --tol 1e-4 --statistical --ber 1e-12"
    filters = "--ffe best:0,1 --dfe 1 --ctle '0 dB, 100 GHz, 100 GHz, 1e12' --low-pass '0.5 THz'"
    done = run(f"{line} {filters} --noise '5 mV' --plot e.png")
    assert done.exit_code == 0, done.output
    height = float(re.search(r"height (\S+) V around 0.33", done.stdout)[1])
    assert height == pytest.approx(2 / 3 - 2 * 7.034 * 5e-3, abs=3e-3)  # of a normal distribution, 1e-12 below -7.034
    assert (folder / "e.png").stat().st_size > 10_000
    told = json.loads(run(f"{line} --json").stdout)
    assert told["height"] == pytest.approx(2 / 3, abs=2e-3)
    assert len(told["t"]) == len(told["bathtub"]) == len(told["ones"])


def test_load_lines(folder: Path) -> None:
    done = run("run cable.toml --load-lines b.png")
    assert done.exit_code == 0, done.output
    assert (folder / "b.png").stat().st_size > 10_000
    assert (folder / "b.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("run memory.toml --load-lines b.png", "loads.end: no load line: the end is not resistive"),
        (
            f"tdr {SCENES}/tdr.toml --port x --rise 1e-10",
            "--port: no line ends at this node, expected one of 'near', 'a', 'b', 'far'",
        ),
        (f"tdr {SCENES}/valve_closure.toml --port valve --rise 1", "--port: more energy comes back than the step"),
        ("tdr cable.toml --port nar --rise 1e-10", "--port: no line ends at this node, expected 'near'"),
        ("tdr cable.toml --port near --rise 3V", "--rise: this unit measures something else"),
        ("tdr cable.toml --port near --rise 0", "--rise: not positive, expected more than 0, got '0'"),
        ("tdr cable.toml --port near --rise 1e-10 --z0 -5", "--z0: not positive"),
        ("tdr cable.toml --port near --rise 1e-10 --to 0", "--to: not positive"),
        ("tdr cable.toml --port near --rise 1e-10 --plot a.txt", "--plot: unknown kind of file"),
        ("tdr none.toml --port near --rise 1e-10", "none.toml: cannot be read"),
        ("eye cable.toml --probe for --bit 1e-9 --rise 1e-10", "--probe: no such probe, expected 'far'"),
        ("eye cable.toml --probe far --bit 0 --rise 1e-10", "--bit: not positive"),
        ("eye cable.toml --probe far --bit 1e-9 --rise 2e-9", "--rise: not a time within a bit, expected above zero"),
        ("eye cable.toml --probe far --bit 1e-9 --rise 1e-10 --bits 0120", "--bits: not a bit pattern"),
        ("eye cable.toml --probe far --bit 1e-9 --rise 1e-10 --bits 111", "--bits: not a bit pattern"),
        ("eye cable.toml --probe far --bit 1e-9 --rise 1e-10 --source x", "--source: no such source"),
        ("eye cable.toml --probe far --bit 1e-9 --rise 1e-10 --high 3s", "--high: this unit measures something else"),
        (STATISTICAL + " --low 1A", "--low: this unit measures something else"),
        ("eye cable.toml --probe far --bit 1e-9 --rise 1e-10 --mask 1e-9", "--mask: not a width and a height"),
        ("eye cable.toml --probe far --bit 1e-9 --rise 1e-10 --mask '2 ns, 1 V'", "--mask: its width is none within"),
        ("eye cable.toml --probe far --bit 1e-9 --rise 1e-10 --tol 2", "--tol: tolerance out of range"),
        ("tdr cable.toml --port near --rise 1e-10 --tol x", "--tol: "),
        ("eye cable.toml --probe far --bit 1e-9 --rise 1e-10 --dfe 2", "--dfe: is for --statistical alone"),
        (f"{STATISTICAL} --bits 01", "--bits: is for one pattern, not for all of them"),
        (f"{STATISTICAL} --probe for", "--probe: no such probe, expected 'far'"),
        (f"{STATISTICAL} --ber 2", "--ber: no error rate of an eye"),
        (f"{STATISTICAL} --ffe best:1", "--ffe: not how many taps"),
        (f"{STATISTICAL} --ctle 1,2", "--ctle: not an equaliser, expected gain of -100 to 100 dB"),
        (f"{STATISTICAL} --ctle '1e9 dB, 2 GHz, 5 GHz'", "--ctle: not an equaliser, expected gain of -100 to 100 dB"),
        (
            f"{STATISTICAL} --ctle '1, 2 GHz, 1e300'",
            "--ctle: not an equaliser for such bits, expected a zero and poles",
        ),
        (f"{STATISTICAL} --ctle '1, 1e-300, 2e9'", "--ctle: not an equaliser for such bits, expected a zero and poles"),
        (f"{STATISTICAL} --low-pass '1 Hz'", "--low-pass: not a bandwidth for such bits"),
        ("eye cable.toml --probe far --bit 1e-9 --rise 1e-10 --low-pass 1e9", "--low-pass: is for --statistical alone"),
        (f"{STATISTICAL} --noise -1", "--noise: out of range"),
        pytest.param(
            f"eye scenes/ddr_ibis.toml --probe die --bit 1e-9 --bits {'0' * 4096}1",
            "--bits: too many to be sent one by one, expected at most 4096, got 4097 bits",
            id="4097 bits",
        ),
    ],
)
def test_a_mistake_is_one_sentence(line: str, sentence: str, folder: Path) -> None:
    memory = CABLE.replace('"resistor"', '"parallel"\ncapacitance = 1e-12')
    (folder / "memory.toml").write_text(memory, encoding="utf-8")
    done = run(line)
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr.startswith(sentence)


PAIR = """
medium = "electrical"
t_end = "6 ns"
[lines.pair]
nodes1 = ["a1", "a2"]
nodes2 = ["b1", "b2"]
even = { z0 = 60, delay = "1 ns" }
odd = { z0 = 40, delay = "1 ns" }
[sources.driver]
at = "a1"
kind = "voltage"
value = { shape = "ramp", to = 1, duration = "0.2 ns" }
resistance = 50
[loads]
a2 = { at = "a2", kind = "resistor", resistance = 50 }
b1 = { at = "b1", kind = "resistor", resistance = 50 }
b2 = { at = "b2", kind = "resistor", resistance = 50 }
[probes.b2]
at = "b2"
"""


def test_crosstalk_of_modes_as_fast_is_that_of_their_impedances():
    """Before anything comes back each mode meets its z0 behind 50 ohm: (60/110 - 40/90)/2 at the near end."""
    Path("pair.toml").write_text(PAIR, encoding="utf-8")
    done = CliRunner().invoke(main, shlex.split("crosstalk pair.toml --json --plot xt.png --csv xt.csv"))
    told = json.loads(done.stdout)
    near = (60 / 110 - 40 / 90) / 2
    assert told["near"]["a2"] * told["swing"] == pytest.approx(near, rel=1e-6)
    assert told["modes"]["a1, a2"]["differential"] <= told["swing"]
    columns = np.genfromtxt("xt.csv", delimiter=",", names=True)
    a1, a2 = columns["a1_V"], columns["a2_V"]
    assert np.allclose(columns["a1__a2_V"], a1 - a2)
    assert Path("xt.png").stat().st_size > 1000


@pytest.mark.parametrize(
    ("text", "options", "sentence"),
    [
        (CABLE, "", "--line: there are no coupled conductors, expected a line with nodes1 and nodes2"),
        (PAIR, "--line pear", "--line: not one of the coupled conductors, expected 'pair', got 'pear'"),
        (PAIR.replace('at = "a1"', 'nodes = ["a1", "b1"]'), "", "lines.pair: not one of its nodes is driven"),
    ],
)
def test_mistakes_with_crosstalk(text, options, sentence):
    Path("pair.toml").write_text(text, encoding="utf-8")
    done = CliRunner().invoke(main, ["crosstalk", "pair.toml", *shlex.split(options)])
    assert done.exit_code == 2
    assert done.stderr.startswith(sentence)


def test_a_measured_channel_and_its_report(folder: Path) -> None:
    line = "channel scenes/filter.s2p --bit '2 ns' --rise '0.5 ns' --ffe best:0,1 --ctle '-3 dB, 1 GHz, 3 GHz'"
    (folder / "slow.toml").write_text('base = "100GBASE-KR4"\nf_b = "5 GHz"\ng_DC = [-6, 0, 3]\n', encoding="utf-8")
    done = run(f"{line} --mask '0.5 ns, 0.2 V' --com slow.toml --report r.html --plot c.png")
    assert done.exit_code == 0, done.output
    assert "filter.s2p: 1 sends, 2 receives" in done.stdout
    assert re.search(r"insertion 1 → 2 down to -\d+", done.stdout)
    assert re.search(r"mask free by 0\.\d+ V", done.stdout)
    page = (folder / "r.html").read_text(encoding="utf-8")
    for part in (
        "Losses",
        "Impedance profile",
        "Eye of all bit patterns",
        "Channel operating margin",
        "Passivity",
        "Inputs",
        "Versions",
    ):
        assert f"<h2>{part}</h2>" in page
    assert page.count("<img") == 5
    assert re.search(r"Channel operating margin</h2>.*<td[^>]*>disturbance A_ni</td>", page)
    assert "proved passive" in page
    assert (folder / "c.png").stat().st_size > 10_000
    assert run("channel scenes/filter.s2p --report r.pdf").exit_code == 0
    assert (folder / "r.pdf").read_bytes().count(b"/Subtype /Image") == 3  # no eye


def test_a_margin_alone(folder: Path) -> None:
    """No model is fitted, and its parameters are read again from what --json tells."""
    (folder / "fast.toml").write_text(
        'base = "200GAUI-4"\nf_b = "5 GHz"\nleast = -80\ng_DC = [-6, -6, 1]\n', encoding="utf-8"
    )
    done = run("channel scenes/filter.s2p --com fast.toml --next scenes/filter.s2p --json --plot pulse.png")
    assert done.exit_code == 0, done.output
    told = json.loads(done.stdout)
    assert told["margin"] == min(told["cases"])
    assert "poles" not in done.stdout
    assert (folder / "pulse.png").stat().st_size > 10_000
    (folder / "again.json").write_text(json.dumps(told["parameters"] | {"least": 20}), encoding="utf-8")
    done = run("channel scenes/filter.s2p --com again.json --next scenes/filter.s2p")
    assert done.exit_code == 1, done.output
    assert f"channel operating margin {told['margin']:.3g} dB, to pass 20 dB" in done.stdout


def test_a_report_as_pdf_needs_its_extra(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "fpdf", None)
    done = run("channel scenes/filter.s2p --report new.pdf")
    assert done.exit_code == 2
    assert "\nnew.pdf: fpdf2 is missing" in "\n" + done.stderr
    assert not (folder / "new.pdf").exists()


def test_mistakes_of_channels(folder: Path) -> None:
    (folder / "pair.s2p").symlink_to(folder / "scenes" / "filter.s2p")
    for more, said in (
        ("--ports 1,2", "--ports: not ports or pairs"),
        ("--ports '1 3'", "--ports: not single ports and pairs"),
        ("--noise 0.1", "--noise: is of an eye, expected --bit beside it"),
        ("--low 1", "--low: is of an eye, expected --bit beside it"),
        ("--com 100GBASE-KR4 --mask '1 ns, 1 V'", "--mask: is of an eye, expected --bit beside it"),
        ("--com 100GBASE-KR4 --high 1", "--high: is of an eye, expected --bit beside it"),
        ("--com 100GBASE-KR4 --rise 1e-9", "--rise: is not of a margin alone, expected --bit or --report beside it"),
        ("--com 100GBASE-KR4 --tol 0.1", "--tol: is not of a margin alone, expected --bit or --report beside it"),
        ("--report r.txt", "--report"),
        ("--fext pair.s2p", "--fext: is of a margin, expected --com beside it"),
        ("--com KR4", "--com: not known, expected one of '100GBASE-KR4'"),
        ("--com 100GBASE-KR4", "pair.s2p: too few samples for a margin"),
    ):
        done = CliRunner().invoke(main, shlex.split(f"channel pair.s2p {more}"))
        assert (done.exit_code, said in done.stderr) == (2, True), done.output
