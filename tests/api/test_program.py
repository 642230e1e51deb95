"""The program ends at once, with all that it had to say and the right exit code."""

import subprocess
import sys
from pathlib import Path

import pytest

SCENES = Path(__file__).parents[2] / "scenes"


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["--version"], 0, "tline "),
        (["line", "electrical", "--wave-speed", "3e8", "--z0", "300"], 0, "z0"),
        (["run", "no-such-scene.toml"], 2, ""),
        (["passivity", "s - 1"], 1, "refuted"),
    ],
)
def test_exit_code_and_output(arguments, code, said):
    done = subprocess.run([sys.executable, "-m", "tline", *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == code, done.stderr
    assert said.lower() in done.stdout.lower()
    assert "Traceback" not in done.stderr


def test_a_long_output_into_a_pipe_is_whole():
    command = [sys.executable, "-m", "tline", "run", str(SCENES / "cable_rc.toml"), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.endswith("}\n")
