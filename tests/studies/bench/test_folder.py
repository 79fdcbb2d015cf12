"""The folder of missions."""

import subprocess

import pytest

from studies.bench.errors import BenchError
from studies.bench.folder import MISSIONS, SUMS, find, load, names, write_sums
from tests.studies.bench.small import lines, write


def test_ours_are_what_their_checksums_say():
    """As `sha256sum` finds, too; and they take little room."""
    for path in find(None):
        assert load(path).head.name == path.stem
    subprocess.run(["sha256sum", "--check", "--strict", SUMS], cwd=MISSIONS, check=True, capture_output=True)
    assert sum(path.stat().st_size for path in MISSIONS.iterdir()) < 300_000


def test_a_mission_that_was_changed_is_refused(tmp_path):
    """Of a folder with checksums; who writes them anew may read it."""
    path = write(tmp_path / "small.jsonl")
    write_sums(tmp_path)
    assert load(path).head.latency == 0.05
    write(path, lines(latency=0.5))
    with pytest.raises(BenchError, match=r"small\.jsonl is not what it was when .*SHA256SUMS was written"):
        load(path)
    write_sums(tmp_path)
    assert load(path).head.latency == 0.5


def test_a_mission_beside_checksums_has_to_be_among_them(tmp_path):
    """So nobody takes it for one of the benchmark."""
    write(tmp_path / "small.jsonl")
    write_sums(tmp_path)
    with pytest.raises(BenchError, match=r"SHA256SUMS does not know it"):
        load(write(tmp_path / "other.jsonl"))


def test_a_mission_without_checksums_is_read(tmp_path):
    """It is of whoever wrote it."""
    assert load(write(tmp_path / "small.jsonl")).head.name == "small"


def test_wrong_checksums_are_told_by_line(tmp_path):
    """With what a line should be."""
    path = write(tmp_path / "small.jsonl")
    (tmp_path / SUMS).write_text("abc small.jsonl\n")
    with pytest.raises(BenchError, match=r"SHA256SUMS:1: a line is a SHA-256, two spaces"):
        load(path)


def test_missions_are_found_by_name_or_file(tmp_path):
    """In the order in which they were asked for."""
    own = tmp_path / "small.jsonl"
    assert find(["paper-mixed", str(own)]) == [MISSIONS / "paper-mixed.jsonl", own]
    assert [path.stem for path in find(None)] == names()
    with pytest.raises(BenchError, match=r'no mission "paper-mixt" \(did you mean "paper-mixed"\?\)'):
        find(["paper-mixt"])
