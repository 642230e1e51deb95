"""Files are believed only where nobody but their reader, or root, can have written them."""

import os
from pathlib import Path

import pytest

from tline.compiled.object_code import UntrustedError, check_folder, read_trusted

NOBODY = 65534
pytestmark = pytest.mark.skipif(os.name != "posix", reason="owners and modes are those of POSIX")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """A file in a folder, both one's own."""
    folder = tmp_path / "folder"
    folder.mkdir(0o755)
    (folder / "file").write_bytes(b"content")
    (folder / "file").chmod(0o644)
    return folder / "file"


def test_ones_own_file_is_read(file):
    assert read_trusted(file) == b"content"
    (file.parent.parent / "link").symlink_to(file.parent)
    assert read_trusted(file.parent.parent / "link" / "file") == b"content"
    check_folder(file.parent)


@pytest.mark.parametrize("mode", [0o664, 0o646, 0o666])
def test_a_file_that_others_may_write_is_not(file, mode):
    file.chmod(mode)
    with pytest.raises(UntrustedError, match=r"other users may write to .*file$"):
        read_trusted(file)


@pytest.mark.parametrize("mode", [0o775, 0o757, 0o777, 0o1777])
def test_nor_one_in_a_folder_that_others_may_write(file, mode):
    file.parent.chmod(mode)
    with pytest.raises(UntrustedError, match=r"other users may write to .*folder$"):
        read_trusted(file)
    with pytest.raises(UntrustedError):
        check_folder(file.parent)


@pytest.mark.parametrize("which", ["file", "folder"])
def test_nor_what_belongs_to_another_user(file, which, monkeypatch):
    """Only root could give it away; whoever else runs this is another user meanwhile."""
    if os.geteuid():
        monkeypatch.setattr(os, "geteuid", lambda: file.stat().st_uid + 1)
    else:
        os.chown(file if which == "file" else file.parent, NOBODY, NOBODY)
    with pytest.raises(UntrustedError, match="belongs to another user"):
        read_trusted(file)


def test_nor_links_pipes_and_folders(file):
    (file.parent / "link").symlink_to(file)
    os.mkfifo(file.parent / "pipe")
    (file.parent / "inner").mkdir()
    for name in ("link", "pipe", "inner"):
        with pytest.raises(UntrustedError, match=f"{name} is a link, or no file$"):
            read_trusted(file.parent / name)
    with pytest.raises(FileNotFoundError):
        read_trusted(file.parent / "nothing")


def test_what_is_opened_is_what_is_read(file, monkeypatch):
    """A file that is put in its place after it was judged is not read."""
    fstat = os.fstat

    def judged(opened):
        found = fstat(opened)
        if os.path.samestat(found, os.stat(file)):
            (file.parent / "other").write_bytes(b"another's")
            os.replace(file.parent / "other", file)
        return found

    monkeypatch.setattr(os, "fstat", judged)
    assert read_trusted(file) == b"content"
    assert file.read_bytes() == b"another's"
