"""Specs and recordings."""

import pytest

from proxy.config import RecordConfig
from proxy.doctor.files import recordings, specs
from proxy.doctor.finding import State
from tests.daemons import specs_file


def test_right_specs_are_counted(tmp_path):
    """And warnings of `sendworthy check` are no more than told."""
    file = specs_file(tmp_path)
    (found,) = specs(tmp_path)
    assert (found.state, found.text) == (State.FINE, f"1 information type in {tmp_path}")
    file.write_text(file.read_text() + 'features.red = { kind = "color_fraction", color = "red" }\n')  # nothing uses it
    (found,) = specs(tmp_path)
    assert (found.state, f", warnings: 1 (sendworthy check {tmp_path})" in found.text) == (State.FINE, True)


def test_each_mistake_is_a_finding(tmp_path):
    """With file, line and key."""
    file = specs_file(tmp_path)
    file.write_text(file.read_text().replace('"video"', '"vidoe"').replace("2 Mbit/s", "2 Mbot/s"))
    found = list(specs(tmp_path))
    assert [each.state for each in found] == [State.FINDING] * 2
    assert [each.text.split(": ")[0] for each in found] == [f"{file}:3", f"{file}:10"]


def test_no_specs_are_fine(tmp_path):
    """The daemon is a plain bridge then."""
    (found,) = specs(tmp_path / "specs.d")
    assert (found.state, found.text) == (State.FINE, f"none in {tmp_path}/specs.d: everything passes")


def test_a_folder_that_is_none_is_a_finding(tmp_path):
    """Nothing could be recorded there."""
    (tmp_path / "recordings").touch()
    (found,) = recordings(RecordConfig(on=True, folder=tmp_path / "recordings"), "r1")
    assert (found.state, found.text) == (
        State.FINDING,
        f"{tmp_path}/recordings: Not a directory: correct record.folder",
    )


LARGE = 1 << 43
"""More than there is on a disk, and no more than a file can be."""


@pytest.mark.parametrize("there", [False, True])
def test_recordings_that_do_not_fit_are_a_finding(tmp_path, there):
    """Where nothing is recorded they need no room; what this robot has recorded counts."""
    folder = tmp_path / "recordings"
    if there:
        folder.mkdir()
        (folder / "r2-x-0.mcap").touch()
        with (folder / "r1-x-0.mcap").open("w") as file:
            file.truncate(LARGE)  # without taking any room
    (found,) = recordings(RecordConfig(on=True, folder=folder, disk_bytes=LARGE), "r1")
    assert found.state == (State.FINE if there else State.FINDING)
    assert f"are free at {folder if there else tmp_path}" in found.text
    (found,) = recordings(RecordConfig(on=True, folder=folder, file_bytes=1 << 20, disk_bytes=1 << 21), "r1")
    assert found.state == State.FINE
    (found,) = recordings(RecordConfig(folder=folder, disk_bytes=LARGE), "r2")
    assert (found.state, found.text.startswith("off")) == (State.FINE, True)
