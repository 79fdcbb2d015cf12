"""Files that change, in all the ways in which people and programs write them."""

import os

import pytest

from proxy.watching import FileWatch, signature


@pytest.fixture
def file(tmp_path):
    file = tmp_path / "a.toml"
    file.write_text("a = 1")
    return file


@pytest.fixture
def watch(file):
    return FileWatch(lambda: [file.parent])


def settled(watch):
    """Whether a change is seen once its file stays as it is, and said only once."""
    seen = watch.look(), watch.look(), watch.look()
    return seen == (False, True, False)


def test_nothing_changes_by_itself(watch):
    """Files that stay as they are are no news."""
    assert not any(watch.look() for _ in range(5))


def test_a_file_is_written_in_place(watch, file):
    """It is news when its writer has paused."""
    file.write_text("a = 2")
    assert not watch.look()
    file.write_text("a = 3, and more")
    assert not watch.look()
    assert watch.changing
    assert watch.look()
    assert not watch.changing
    assert not watch.look()


def test_a_file_is_renamed_over(watch, file):
    """As editors do it; what they write beside it meanwhile is no concern."""
    new = file.with_suffix(".swp")
    new.write_text("a = 2")
    assert not any(watch.look() for _ in range(3))
    new.rename(file)
    assert settled(watch)


def test_the_same_size_at_the_same_time_is_seen(watch, file):
    """A tool that sets back the time of what it wrote cannot hide it."""
    before = file.stat()
    file.write_text("a = 2")
    os.utime(file, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert settled(watch)


def test_a_link_is_turned(tmp_path):
    """What a link leads to counts, and so does a link to the folder."""
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "a.toml").write_text(name)
    link = tmp_path / "now"
    link.symlink_to("one")
    watch = FileWatch(lambda: [link])
    turned = tmp_path / "next"
    turned.symlink_to("two")
    turned.rename(link)
    assert settled(watch)


def test_files_come_and_go(watch, file):
    """Each is news."""
    other = file.with_name("b.toml")
    other.write_text("")
    assert settled(watch)
    other.unlink()
    assert settled(watch)
    file.unlink()
    assert settled(watch)


def test_definitions_of_messages_are_watched(watch, file):
    """Features of messages of ROS 2 name them; whatever else lies there is no concern."""
    definition = file.with_name("B.msg")
    definition.write_text("float64 x")
    assert settled(watch)
    definition.write_text("int32 n\nfloat64 x")
    assert settled(watch)
    file.with_name("notes.txt").write_text("x")
    assert not any(watch.look() for _ in range(3))


def test_definitions_in_a_folder_beside_specs_are_watched(file):
    """As packages of ROS 2 have them; also where the specs are one file."""
    definition = file.parent / "msg" / "B.msg"
    definition.parent.mkdir()
    for path in (file, file.parent):
        definition.write_text("float64 x")
        watch = FileWatch(lambda path=path: [path])
        definition.write_text("int32 n\nfloat64 x")
        assert settled(watch)


def test_permissions_are_news(watch, file):
    """Who could not read a file tries again when its mode changes."""
    file.chmod(0o600)
    assert settled(watch)


def test_a_path_that_leads_nowhere_is_a_state_like_others(tmp_path):
    """A dangling link, a missing file and an impossible name are watched for better times."""
    dangling = tmp_path / "dangling.toml"
    dangling.symlink_to("gone")
    for path in (dangling, tmp_path / "missing.toml", tmp_path / "nul\0.toml"):
        assert signature([path]) == ((str(path), 0, 0, 0, 0),)


def test_what_was_noted_is_no_news(watch, file):
    """Who reloads now anyway need not be told."""
    file.write_text("a = 2")
    watch.note()
    assert not any(watch.look() for _ in range(3))
