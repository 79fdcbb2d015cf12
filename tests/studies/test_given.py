"""Files as they were named on the command line."""

from pathlib import Path

import pytest

from studies.given import once, reason_of


def test_a_file_is_taken_once_whatever_it_is_called(tmp_path, monkeypatch):
    """By its first name, in the order given, whether it is there or not."""
    monkeypatch.chdir(tmp_path)
    Path("b").symlink_to("a")
    assert once([*map(Path, ("./c/../a", "none", "b", "c", "a", "none"))], ()) == [*map(Path, ("c/../a", "none", "c"))]


def test_parts_go_with_their_folder():
    """Other files in it do not."""
    given = [*map(Path, ("bag/0.db3", "bag", "bag/t.csv", "other/0.db3"))]
    assert once(given) == given
    assert once(given, (".db3",)) == given[1:]


def test_what_cannot_be_written_is_named(tmp_path):
    """Where the system says nothing of a file, in its own words."""
    with pytest.raises(FileNotFoundError) as caught:
        (tmp_path / "none" / "file").write_text("")
    assert reason_of(caught.value) == f"{tmp_path}/none/file: No such file or directory"
    assert reason_of(OSError(28, "No space left on device")) == "No space left on device"
    assert reason_of(OSError("strange")) == "strange"


def test_who_reads_no_further_is_no_mistake():
    """The command line sees to that."""
    with pytest.raises(BrokenPipeError):
        reason_of(BrokenPipeError(32, "Broken pipe"))
