"""Files that a command is told to write."""

import os
from pathlib import Path

import pytest

from proxy import output
from proxy.output import check_writable


def test_what_can_be_written_is_left_alone(tmp_path):
    """Nothing is made, nothing is changed; standard output and what was not asked for are no files."""
    there = tmp_path / "there"
    there.write_text("as it was")
    check_writable([there, tmp_path / "new", None, Path("-"), Path("new"), Path(os.devnull)])
    check_writable([tmp_path / "no" / "folder" / "yet"], folders=True)
    assert [each.name for each in tmp_path.iterdir()] == ["there"]
    assert there.read_text() == "as it was"


@pytest.mark.parametrize(
    ("name", "problem"),
    [("none/file", FileNotFoundError), (".", IsADirectoryError), ("file/below", NotADirectoryError)],
)
def test_what_cannot_be_written_is_named(tmp_path, name, problem):
    """As if it had been tried."""
    (tmp_path / "file").write_text("")
    with pytest.raises(problem) as caught:
        check_writable([tmp_path / name])
    assert caught.value.filename == str(tmp_path / name)


@pytest.mark.parametrize("folders", [True, False])
def test_a_folder_that_one_may_not_write_to_is_told(tmp_path, monkeypatch, folders):
    """Whoever runs the tests may."""
    monkeypatch.setattr(output.os, "access", lambda place, _: place != tmp_path)
    with pytest.raises(PermissionError):
        check_writable([tmp_path / "file"], folders=folders)
