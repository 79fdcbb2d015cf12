"""Files as they were named on the command line."""

from pathlib import Path

from studies.given import once


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
