"""Results on disk."""

import json

import pytest

from studies.study.store import Store
from studies.study.tasks import VERSION, Task

ONE, OTHER = Task("best", "mixed", 5.0, 0), Task("best", "mixed", 5.0, 1)


@pytest.fixture
def path(tmp_path):
    """A store with one record."""
    with Store(tmp_path / "deep" / "records.jsonl") as store:
        store.add(ONE, {"utility": 1.0})
    return store.path


def test_what_was_stored_is_known_to_the_next_run(path):
    """And only the rest is missing, each task once."""
    store = Store(path)
    assert store[ONE] == {"utility": 1.0}
    assert store.get(OTHER) is None
    assert store.missing([ONE, OTHER, OTHER]) == [OTHER]
    assert store.of([ONE, OTHER]) == {ONE: {"utility": 1.0}}


def test_a_line_that_was_cut_off_costs_its_record_alone(path):
    """The next one begins a line of its own."""
    with path.open("a") as file:
        file.write('{"version": 1, "task": {"cont')
    with Store(path) as store:
        store.add(OTHER, {"utility": 2.0})
    found = Store(path)
    assert (found[ONE]["utility"], found[OTHER]["utility"]) == (1.0, 2.0)


def test_records_of_another_version_are_flown_anew(path):
    """What they mean may have changed."""
    entry = json.loads(path.read_text())
    assert entry["version"] == VERSION
    path.write_text(json.dumps(entry | {"version": VERSION + 1}) + "\n")
    assert len(Store(path)) == 0


def test_nothing_is_added_to_a_store_that_is_not_open(path):
    """It would be lost."""
    with pytest.raises(ValueError, match="not open"):
        Store(path).add(OTHER, {})
