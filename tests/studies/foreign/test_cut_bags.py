"""Bags without their end."""

import pytest
from mcap.writer import CompressionType

from studies.foreign.cut_bags import CutFile, files_of
from tests.studies.foreign.rosbags_written import BEGIN, write_mcap


@pytest.mark.parametrize("compression", list(CompressionType))
@pytest.mark.parametrize("chunked", [True, False])
def test_messages_are_read_in_whatever_way_they_are_packed(tmp_path, compression, chunked):
    """Chunks or none, with each compression; of a file that was cut off each message that is there whole."""
    path = tmp_path / "a.mcap"
    size = write_mcap(path, compression=compression, use_chunking=chunked, chunk_size=1000)
    whole = CutFile(path)
    read = list(whole.messages())
    assert [(topic.topic, topic.msgtype, at - BEGIN, data) for topic, at, data in read] == [
        (f"/r1/{'ab'[i % 2]}", "std_msgs/msg/String", i * 10**9, bytes([i]) * 50) for i in range(200)
    ]
    assert whole.problem == ""
    for keep in range(0, size, size // 20):
        path.write_bytes(path.read_bytes()[: size - keep])
        cut = CutFile(path)
        assert list(cut.messages()) == read[: cut.count]
        assert cut.count == 200 or f"{size - keep:,}" in cut.problem or not cut.count


def test_a_damaged_part_is_left_out(tmp_path):
    """And told, with what is missing at the end."""
    path = tmp_path / "a.mcap"
    write_mcap(path, compression=CompressionType.NONE, chunk_size=1000)
    data = bytearray(path.read_bytes())
    at = data.index(bytes([100]) * 50)
    data[at] += 1
    path.write_bytes(data[: data.index(bytes([190]) * 50)])
    cut = CutFile(path)
    found = {data[0] for _, _, data in cut.messages()}
    assert 100 not in found
    assert {50, 150} < found
    assert "was cut off or damaged after byte" in cut.problem
    assert "and has 1 damaged parts: " in cut.problem


def test_what_is_no_bag_has_no_messages(tmp_path):
    """MCAP of another profile, other files."""
    write_mcap(tmp_path / "a.mcap", profile="other")
    (tmp_path / "b.mcap").write_bytes(b"hello")
    (tmp_path / "c.txt").write_bytes(b"hello")
    for name in ("a.mcap", "b.mcap", "c.txt"):
        assert not list(CutFile(tmp_path / name).messages())


def test_the_files_of_a_bag_are_in_the_order_of_their_numbers(tmp_path):
    """And nothing else of the folder."""
    for name in ("bag_0.mcap", "bag_10.mcap", "bag_2.mcap", "metadata.yaml"):
        (tmp_path / name).touch()
    assert [path.name for path in files_of(tmp_path)] == ["bag_0.mcap", "bag_2.mcap", "bag_10.mcap"]
    assert files_of(tmp_path / "bag_0.mcap") == [tmp_path / "bag_0.mcap"]
