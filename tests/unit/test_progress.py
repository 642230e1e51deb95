import subprocess
import sys

import pytest

from tline.words import progress
from tline.words.progress import Progress


def test_short_work_shows_no_bar_and_does_not_import_one():
    code = (
        "import sys; from tline.words.progress import Progress\n"
        "with Progress(3, 'slab', True) as bar: bar.update(); bar.update(2)\n"
        "print('tqdm' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("False\n", "")


def test_long_work_shows_all_that_is_done(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    monkeypatch.setattr(progress, "DELAY", 0.0)
    with Progress(3, "slab", True, "stepping") as bar:
        bar.update()
        bar.update(2)
    out, err = capsys.readouterr()
    assert out == ""
    assert "stepping: 100%" in err
    assert "3/3" in err


def test_no_bar_where_none_is_asked_for(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    monkeypatch.setattr(progress, "DELAY", 0.0)
    with Progress(3, "slab", False) as bar:
        bar.update(3)
    assert capsys.readouterr().err == ""
