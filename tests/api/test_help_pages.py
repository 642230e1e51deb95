"""Examples on help pages run as they stand; tests/unit/test_from_signature.py asks for the words on each option."""

import re
import shlex
from pathlib import Path

import pytest
from click.testing import CliRunner
from run_scenes import driven_cable

from tline.cli.main import main

ROOT = Path(__file__).parents[2]
LOAD = '[loads.end]\nat = "far"\nkind = "parallel"\nresistance = 100\ncapacitance = "4 pF"'
CABLE = driven_cable(LOAD, "20 ns", source="pump")
FILES = {
    "cable.toml": CABLE,
    "network.toml": CABLE,
    "scene.toml": CABLE,
    "cable.cir": "V1 s 0 PULSE(0 1 0 1n 1n 5n)\nR1 s a 25\nT1 a 0 b 0 Z0=50 TD=1n\nR2 b 0 100\n.tran 1p 9n uic\n",
    "measured.csv": "f,re,im\n" + "".join(f"{k},{0.9 + 0.2 * (k == 3)},{0.01 * k}\n" for k in range(1, 30)),
    "measured.s2p": "# Hz S RI R 50\n1 0 0 0.5 0 0.5 0 0 0\n2 0 0 1.1 0 0.5 0 0 0\n",
    "moved.csv": "t [ms]; x [mm]\n# a stroke\n0;0\n500;1,5\n1000;0\n",
    "torques.csv": "t,T1,T2\n0,0.1,0\n0.5,0.1,0.3\n",
}
REFUTED = ("R real", "(s + 2)/(s^2 + s + 1)", "measured.s2p")
WRITTEN = {"--plot", "--csv", "--save", "--poles", "--certificate", "--nearest", "--resume", "-o"}
PAGES = (
    "line", "line electrical", "line hydraulic", "sweep", "frequency", "tdr", "eye", "crosstalk", "passivity",
    "friction", "friction motion", "drives", "drives bode", "drives control", "drives step", "import", "export",
)  # fmt: skip


@pytest.mark.parametrize("page", PAGES)
def test_examples_run(page: str, folder: Path) -> None:
    (folder / "scenes").symlink_to(ROOT / "scenes")
    for name, text in FILES.items():
        (folder / name).write_text(text, encoding="utf-8")
    if page in ("tdr", "eye"):  # of an end that keeps the eye open
        open_eye = CABLE.replace('"parallel"', '"resistor"').replace('capacitance = "4 pF"\n', "")
        (folder / "cable.toml").write_text(open_eye, encoding="utf-8")
    shown = CliRunner().invoke(main, [*page.split(), "--help"]).stdout
    examples = re.findall(r"^ +tline ([^|\n]*)", re.sub(r"\\\n\s*", "", shown), re.MULTILINE)
    assert len(examples) > 1
    for example in examples:
        if "town.inp" in example:  # tests/api/test_cli_networks.py runs it
            continue
        words = shlex.split(example)
        done = CliRunner().invoke(main, words, catch_exceptions=False)
        assert done.exit_code == any(each in example for each in REFUTED), done.output
        for option in WRITTEN.intersection(words):
            assert (folder / words[words.index(option) + 1]).stat().st_size > 0
