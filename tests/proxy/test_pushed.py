"""Specs that are pushed."""

import os
from pathlib import Path

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.errors import PushError
from proxy.pushed import Folder, gathered, pack, unpack
from proxy.reloading import read_specs
from utility_specs import Specs, SpecsError, load_specs

GOOD = b"""
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
weight = 1.0
utility = { kind = "video" }
"""
OTHER = GOOD.replace(b"1.0", b"2.0")


def weight(folder):
    return load_specs(folder).types[0].scale({})


def contents(path):
    """Everything below a folder, by name."""
    return {str(file.relative_to(path)): file.read_bytes() for file in path.rglob("*") if file.is_file()}


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "specs.d"
    path.mkdir()
    (path / "old.toml").write_bytes(GOOD)
    return path


def test_files_arrive_as_they_were():
    """Names and bytes."""
    files = {"a.toml": GOOD, "b-1.toml": b""}
    assert unpack(pack(files)) == files


@given(
    st.binary(max_size=200)
    | st.recursive(st.none() | st.text() | st.binary(), st.lists, max_leaves=5).map(msgpack.packb)
)
def test_anything_else_is_refused(raw):
    """Whatever bytes come."""
    with pytest.raises(PushError, match=r"cannot be read|another version|nothing to push|no name"):
        unpack(raw)


@pytest.mark.parametrize(
    ("files", "why"),
    [
        ({}, "nothing to push"),
        ({"../a.toml": b""}, "no name of a file"),
        ({"a/b.toml": b""}, "no name of a file"),
        ({".toml": b""}, "no name of a file"),
        ({"a.txt": b""}, "no name of a file"),
        ({"a.toml": "text"}, "no name of a file"),
        ({f"{i}.toml": b"" for i in range(65)}, "at most 64 files of 1024 KiB"),
        ({"a.toml": bytes(1024 * 1024 + 1)}, "at most 64 files of 1024 KiB"),
    ],
)
def test_what_is_no_set_of_files_cannot_be_packed_nor_unpacked(files, why):
    """Neither a way out of the folder nor more than a robot should store."""
    with pytest.raises(PushError, match=why):
        pack(files)
    with pytest.raises(PushError, match=why):
        unpack(msgpack.packb([1, files]))


def test_another_version_is_refused():
    """Robots of different versions may meet."""
    with pytest.raises(PushError, match="another version"):
        unpack(msgpack.packb([2, {"a.toml": GOOD}]))


def test_files_and_folders_are_gathered(path):
    """A folder stands for its specs; what lies beside them stays."""
    (path / "README").write_text("no specs")
    single = path.parent / "single.toml"
    single.write_bytes(OTHER)
    assert gathered([path, single]) == {"old.toml": GOOD, "single.toml": OTHER}
    assert gathered([path, path / "old.toml", path / ".." / path.name]) == {"old.toml": GOOD}


def test_what_cannot_be_gathered_is_named(path):
    """A missing file, and one whose name is taken."""
    with pytest.raises(PushError, match=r"gone\.toml: cannot be read: No such file"):
        gathered([path / "gone.toml"])
    other = path.parent / "old.toml"
    other.write_bytes(OTHER)
    with pytest.raises(PushError, match=r"old\.toml: there is another file of this name"):
        gathered([path, other])


def test_what_never_ends_is_not_gathered(path):
    """A pipe that nobody writes into, a device, a folder that is called like a file."""
    os.mkfifo(path / "pipe.toml")
    for each in (path, Path("/dev/zero")):
        with pytest.raises(PushError, match="is not a file"):
            gathered([each])


def test_specs_replace_those_of_the_folder(path):
    """All of them, and those from before stay beside it; nothing else is left."""
    Folder(path).put({"new.toml": OTHER})
    assert contents(path.parent) == {"specs.d/new.toml": OTHER, "specs.d.previous/old.toml": GOOD}
    Folder(path).put({"newer.toml": GOOD})
    assert contents(path.parent) == {"specs.d/newer.toml": GOOD, "specs.d.previous/new.toml": OTHER}


def test_a_folder_that_is_not_there_is_made(tmp_path):
    """A robot that has no specs yet can be given some."""
    Folder(tmp_path / "specs.d").put({"new.toml": OTHER})
    assert weight(tmp_path / "specs.d") == 2.0


def test_mistakes_leave_the_folder_alone(path):
    """They are told by the names that whoever pushed knows."""
    with pytest.raises(SpecsError) as caught:
        Folder(path).put({"new.toml": GOOD.replace(b"video", b"vidoe")})
    assert str(caught.value).startswith('new.toml:6: information_type "camera": utility.kind: ')
    with pytest.raises(SpecsError, match=r"^empty\.toml: information_type: is missing"):
        Folder(path).put({"empty.toml": b""})
    with pytest.raises(SpecsError, match=r"^specs: information_type: is missing"):
        Folder(path).put({"empty.toml": b"", "void.toml": b""})
    assert contents(path.parent) == {"specs.d/old.toml": GOOD}


def test_a_push_can_be_undone(path):
    """What was there is back; what was nowhere is gone."""
    folder = Folder(path)
    folder.put({"new.toml": OTHER})
    folder.undo()
    assert contents(path) == {"old.toml": GOOD}
    fresh = Folder(path.parent / "fresh.d")
    fresh.put({"new.toml": OTHER})
    fresh.undo()
    assert not (path.parent / "fresh.d").exists()


def test_the_same_files_pushed_again_replace_nothing(path):
    """What was there before them is still to be had; nor is there anything to undo then."""
    before = path.with_name(f"{path.name}.previous")
    for _ in range(2):
        folder = Folder(path)
        folder.put({"new.toml": OTHER})
        assert (contents(path), contents(before)) == ({"new.toml": OTHER}, {"old.toml": GOOD})
    folder.undo()
    assert contents(path) == {"new.toml": OTHER}


def test_an_interrupted_push_is_finished(path):
    """Between the two renames nothing is in the folder's place; what had been checked takes it."""
    Folder(path).put({"new.toml": OTHER})
    path.rename(path.with_name("specs.d.pushed"))
    Folder(path).mend()
    assert weight(path) == 2.0


def test_a_push_that_was_refused_is_not_finished(path):
    """Whoever takes the specs away later gets none, though there are previous ones."""
    Folder(path).put({"new.toml": OTHER})
    with pytest.raises(SpecsError):
        Folder(path).put({"wrong.toml": b"wrong"})
    path.rename(path.with_name("saved"))
    Folder(path).mend()
    assert not path.exists()


def test_a_folder_that_was_removed_stays_away(path):
    """Nobody meant the last specs but one to come back."""
    Folder(path).put({"new.toml": OTHER})
    (path / "new.toml").unlink()
    path.rmdir()
    Folder(path).mend()
    assert not path.exists()


def test_a_link_to_a_folder_stays_one(path):
    """What it leads to is replaced."""
    link = path.parent / "link"
    link.symlink_to(path)
    Folder(link).put({"new.toml": OTHER})
    assert link.is_symlink()
    assert weight(link) == 2.0


def test_a_single_file_cannot_be_replaced(path):
    """A set of files needs a folder; the message says what to do."""
    with pytest.raises(PushError, match=r"old\.toml is a file; set specs\.path to a folder"):
        Folder(path / "old.toml").put({"new.toml": OTHER})


def test_the_root_is_a_folder_like_others():
    """It has no name, and nothing replaces it."""
    assert read_specs(Path("/")) == Specs.empty()


def test_a_place_that_cannot_be_written_is_named():
    """Root could write nearly anywhere, but not there."""
    with pytest.raises(PushError, match=r"^/proc/specs\.d: cannot be replaced: "):
        Folder(Path("/proc/specs.d")).put({"new.toml": OTHER})
