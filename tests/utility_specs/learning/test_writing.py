"""The whole file, as the person who learns reads it."""

import pytest

from proxy.core.forecast.schedule import Schedule
from tests.utility_specs.learning.team import json_bytes, regular, team
from utility_specs import digests, load_specs
from utility_specs.constraint_tables import FLOOR
from utility_specs.learning import Observed, learn, writing
from utility_specs.toml_source import LARGEST_FILE


def loaded(text, folder):
    file = folder / "learned.toml"
    file.write_text(text)
    return load_specs(file)


def test_the_head_says_what_there_is_and_what_is_left_to_do():
    """A table of all types, the one of most bytes first, and notes."""
    text = learn(team("r1", "r2"), Schedule, notes=lambda: ["A note."])
    head = text.partition("\n\n")[0].splitlines()
    assert head[0].startswith("# Learned by `sendworthy learn` from what was seen: 6")
    assert [line.split()[1] for line in head[3:8]] == ["camera", "map", "pose", "battery", "alarm"]
    assert [line.split()[1] for line in head if line[4:6] in {"1.", "2.", "3."}] == ["1.", "2.", "3."]
    assert head[-1] == "# A note."


def test_the_limit_follows_the_channel_up_to_what_was_seen(tmp_path):
    """Twice the most, in as many copies as there may be; a fixed one is at hand."""
    samples = regular("k", 10.0, lambda _: b"\xff" * 1250)
    (constraint,) = loaded(learn(samples, Schedule), tmp_path).constraints
    assert (constraint.measure.limit / constraint.measure.window, constraint.least) == (25_000.0, FLOOR)
    (constraint,) = loaded(text := learn(samples, Schedule, ["r1", "r2", "r3"]), tmp_path).constraints
    assert constraint.measure.limit / constraint.measure.window == 50_000.0
    assert 'limit = "200 kbit/s" is what' in text.replace("\n# ", " ")


def test_the_limit_leaves_room_beside_what_daemons_tell_each_other(tmp_path):
    """However little was seen: twice a battery's samples are less than daemons tell, and half of them were dropped."""
    text = learn(regular("robot/r1/battery", 10.0, lambda _: json_bytes(charge=0.5)), Schedule, ["r1", "r2"])
    (constraint,) = loaded(text, tmp_path).constraints
    assert constraint.measure.limit / constraint.measure.window == pytest.approx(1875.0)
    assert digests.warning(constraint.measure, digests.TEAM) == ""
    assert "2 times that or, as is more here, to 15 kbit/s" in text.replace("\n# ", " ")


def test_types_beyond_those_that_a_file_has_room_for_are_counted(tmp_path, monkeypatch):
    """Those of most bytes stay."""
    monkeypatch.setattr(writing, "MOST_TYPES", 2)
    samples = [sample for size in (1, 2, 3) for sample in regular("abc"[size - 1], 1.0, lambda _, n=size: b"\xff" * n)]
    text = learn(samples, Schedule)
    assert [each.name for each in loaded(text, tmp_path).types] == ["c", "b"]
    assert "# Left out: 1 of the types, those of fewest bytes." in text


def test_a_file_is_no_larger_than_one_that_can_be_read(tmp_path):
    """However long the keys are: types of fewest bytes are left out."""
    kinds = [letter * 500 for letter in "abcdefgh"]
    samples = [
        Observed(0.0, f"{long}/{number:08x}a", b"\xff" * 9 * 2**kind)
        for kind, long in enumerate(kinds)
        for number in range(60)
    ]
    text = learn([*samples, *(Observed(0.0, f"{long}/other", b"{}") for long in kinds)], Schedule)
    assert len(text.encode()) < LARGEST_FILE
    assert 0 < len(loaded(text, tmp_path).types) < 16
    assert "of the types, those of fewest bytes." in text


@pytest.mark.parametrize("seconds", [1.0, 20.0])
def test_however_short_it_was(tmp_path, seconds):
    """A single sample will do."""
    assert loaded(learn(regular("k", 1.0, lambda _: json_bytes(x=1), seconds), Schedule), tmp_path).types
