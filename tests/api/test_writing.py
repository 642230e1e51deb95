"""Files are whole or not there at all, as docs/trust.md says: after kills, signals, full disks and runs at once."""

import json
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from tline.atomic import check_writable, replacing
from tline.errors import InputError

CABLE = Path(__file__).parents[2] / "scenes" / "cable_rc.toml"


pytestmark = pytest.mark.usefixtures("folder")


def test_what_a_killed_run_leaves_is_removed_by_the_next_and_nothing_else(folder):
    code = (
        "import os, signal\nfrom tline.atomic import replacing\n"
        "with replacing('out.csv') as file:\n    file.write_text('half')\n    os.kill(os.getpid(), signal.{})\n"
    )
    subprocess.run([sys.executable, "-c", code.format("SIGKILL")], check=False)
    left = [name for name in os.listdir(folder) if ".tline-" in name]
    assert len(left) == 1
    others = {".out.tline-notes.csv", ".out.tline-0123abcd.png", ".other.tline-0123abcd.csv", "out.csv.bak"}
    for name in others:
        (folder / name).write_text("mine")
    with replacing("out.csv") as first, replacing("out.csv") as second:  # two runs at once leave each other alone
        first.write_text("1")
        second.write_text("2")
    assert (folder / "out.csv").read_text() == "1"
    assert {name for name in os.listdir(folder) if "tline-" in name or name.endswith("bak")} == others


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP", "SIGINT"])
def test_a_run_that_is_told_to_end_removes_what_is_under_way(name, folder):
    number = getattr(signal, name)
    code = (
        "import os\nfrom tline.atomic import replacing\n"
        f"with replacing('out.csv') as file:\n    file.write_text('half')\n    os.kill(os.getpid(), {int(number)})\n"
        "    import time; time.sleep(20)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], check=False, stderr=subprocess.DEVNULL)
    assert done.returncode == -number
    assert os.listdir(folder) == []


def test_a_handler_of_the_user_is_left_alone(folder):
    heard = []
    before = signal.signal(signal.SIGTERM, lambda *_: heard.append(1))
    try:
        with replacing("out.csv") as file:
            os.kill(os.getpid(), signal.SIGTERM)
            file.write_text("whole")
    finally:
        signal.signal(signal.SIGTERM, before)
    assert (heard, (folder / "out.csv").read_text()) == ([1], "whole")


def test_files_are_written_in_threads_too(folder):
    def write() -> None:
        with replacing("out.csv") as file:
            file.write_text("whole")

    thread = threading.Thread(target=write)
    thread.start()
    thread.join()
    assert (folder / "out.csv").read_text() == "whole"


FULL = """
import json, resource, sys
from click.testing import CliRunner
import tline.atomic as atomic
from tline.cli.main import main
beside, (own, most) = atomic._beside, resource.getrlimit(resource.RLIMIT_FSIZE)
def small(target):
    resource.setrlimit(resource.RLIMIT_FSIZE, (2000, most))
    return beside(target)
atomic._beside = small
told = []
for option, file in json.loads(sys.argv[2]):
    done = CliRunner().invoke(main, ["run", sys.argv[1], option, file])
    resource.setrlimit(resource.RLIMIT_FSIZE, (own, most))
    told.append([done.exit_code, done.stderr])
print(json.dumps(told))
"""


def test_a_full_disk_is_said_in_a_sentence(folder):
    options = {"csv": "--csv", "npz": "--npz", "html": "--animate"} | dict.fromkeys(("pdf", "png", "svg"), "--plot")
    asked = [(option, f"out.{suffix}") for suffix, option in options.items()]
    call = [sys.executable, "-B", "-c", FULL, CABLE, json.dumps(asked)]  # else compiled modules are cut off, too
    done = subprocess.run(call, capture_output=True, check=True)
    assert json.loads(done.stdout) == [[2, f"{file}: cannot be written, got file too large\n"] for _, file in asked]
    assert os.listdir(folder) == []


def test_a_null_character_is_no_name():
    for write in (check_writable, lambda name: replacing(name).__enter__()):
        with pytest.raises(InputError, match="cannot be written, got a name with a null character"):
            write("a\0.csv")
