"""Commands that run in this process or in one of their own, and what is said of mistakes in them."""

import shlex
import subprocess
import sys

from click.testing import CliRunner, Result

from tline.cli.main import main


def run(line: str) -> Result:
    """Of `tline` and the words of the line."""
    return CliRunner().invoke(main, shlex.split(line), catch_exceptions=False)


def assert_refused(line: str, sentence: str) -> None:
    """It exits with 2, prints nothing, and says in one line what is wrong."""
    done = run(line)
    assert (done.exit_code, done.stdout) == (2, ""), done.output
    assert done.stderr.startswith(sentence), done.stderr
    assert done.stderr.count("\n") == 1, done.stderr


def call(*args: str) -> Result:
    """Of `tline` and these words, whatever is raised."""
    return CliRunner().invoke(main, list(args))


def tline(*args: str, **given) -> subprocess.CompletedProcess:
    """The command in a process of its own."""
    command = [sys.executable, "-m", "tline", *args]
    return subprocess.run(command, check=False, text=True, stderr=given.pop("stderr", subprocess.PIPE), **given)
