"""The folder with a robot's recordings."""

from proxy.recording.folder import RecordingFolder


def test_files_are_named_by_robot_time_and_number(tmp_path):
    """The folder is made when it is missing."""
    folder = RecordingFolder(tmp_path / "new" / "recordings", "r 1", 1000, 0.0)
    assert folder.next(10).name == "r_1-19700101T000000Z-0001.mcap"
    assert folder.next(10).name == "r_1-19700101T000000Z-0002.mcap"


def test_a_file_that_is_there_is_not_touched(tmp_path):
    """Another daemon may have begun in the same second."""
    (tmp_path / "r1-19700101T000000Z-0001.mcap").write_bytes(b"there")
    assert RecordingFolder(tmp_path, "r1", 1000, 0.0).next(10).name == "r1-19700101T000000Z-0002.mcap"


def test_the_oldest_files_give_way(tmp_path):
    """All recordings of the robot stay within the bound; files of others and other files stay."""
    for name in ("r1-19690101T000000Z-0002", "r1-19690101T000000Z-0010", "r1-19680101T000000Z-0011"):
        (tmp_path / f"{name}.mcap").write_bytes(bytes(400))
    for name in ("r1-b-19600101T000000Z-0001.mcap", "r2-19600101T000000Z-0001.mcap", "notes.txt"):
        (tmp_path / name).write_bytes(bytes(5000))
    RecordingFolder(tmp_path, "r1", 1000, 0.0).next(400)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "notes.txt",
        "r1-19690101T000000Z-0010.mcap",
        "r1-b-19600101T000000Z-0001.mcap",
        "r2-19600101T000000Z-0001.mcap",
    ]


def test_files_of_this_recording_give_way_last(tmp_path):
    """A robot that boots without a clock names them after 1970: its recordings of before are older all the same."""
    before = tmp_path / "r1-20260101T000000Z-0001.mcap"
    before.write_bytes(bytes(400))
    folder = RecordingFolder(tmp_path, "r1", 1000, 0.0)
    first = folder.next(400)
    first.write_bytes(bytes(400))
    folder.next(400)
    assert (first.exists(), before.exists()) == (True, False)


def test_files_after_the_clock_was_set_are_named_by_it(tmp_path):
    """So the next recording knows how old they are; in this one numbers tell, wherever the clock was set to."""
    before = tmp_path / "r1-20250101T000000Z-0001.mcap"
    before.write_bytes(bytes(400))
    folder = RecordingFolder(tmp_path, "r1", 1200, 0.0)
    folder.set_clock(0.6)
    first = folder.next(400)
    first.write_bytes(bytes(400))
    folder.set_clock(1767225600.0)
    second = folder.next(400)
    second.write_bytes(bytes(400))
    folder.set_clock(-1e6)
    third = folder.next(400)
    third.write_bytes(bytes(400))
    assert [path.name for path in (first, second, third)] == [
        "r1-19700101T000000Z-0001.mcap",
        "r1-20260101T000000Z-0002.mcap",
        "r1-20251220T101320Z-0003.mcap",
    ]
    assert not before.exists()
    folder.next(400)
    assert sorted(tmp_path.iterdir()) == [third, second]
