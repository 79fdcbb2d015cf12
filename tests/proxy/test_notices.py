"""What happens to files is noticed, without looking."""

import os
import select

import pytest

from proxy.notices import Notices


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "specs.d"
    folder.mkdir()
    (folder / "a.toml").write_text("a = 1")
    return folder


@pytest.fixture
def notices(stack, folder):
    notices = Notices()
    stack.callback(notices.close)
    notices.watch([folder, folder.parent / "sendworthy.toml"])
    return notices


def rename_over(folder):
    (folder.parent / "new").write_text("a = 2")
    (folder.parent / "new").replace(folder / "a.toml")


@pytest.mark.parametrize(
    "change",
    [
        lambda folder: (folder / "a.toml").write_text("a = 2"),
        lambda folder: (folder / "b.toml").write_text("b = 1"),
        lambda folder: (folder / "a.toml").unlink(),
        rename_over,
        lambda folder: folder.rename(folder.parent / "before"),
        lambda folder: (folder.parent / "sendworthy.toml").write_text("mode = 1"),
    ],
    ids=["written", "new", "gone", "renamed over", "another folder", "a file that was missing"],
)
def test_what_happens_is_noticed_once(notices, folder, change):
    """Whoever waits wakes."""
    assert not notices.take()
    change(folder)
    assert select.select([notices], [], [], 60.0)[0] == [notices]
    assert notices.take()
    assert not notices.take()


def test_to_look_at_files_is_nothing_that_happens(notices, folder):
    """Or every look would bring about the next one."""
    assert [file.read_text() for file in folder.iterdir()] == ["a = 1"]
    notices.watch([folder])
    assert not notices.take()


def test_where_nothing_can_be_noticed_nothing_is(monkeypatch, folder):
    """The kernel gives each user so many; files are looked at all the same."""
    monkeypatch.setattr(os, "O_CLOEXEC", -1)
    notices = Notices()
    assert notices.fileno() < 0
    notices.watch([folder])
    assert not notices.take()
    notices.close()
