"""Which classes a snapshot may have."""

from collections.abc import Iterator
from typing import Any, get_args, get_type_hints

import pytest

from planner import Plan, Problem
from proxy.core.core import Core
from proxy.core.interface.commands import Decide
from proxy.core.model.settings import CoreSettings
from proxy.recording.layouts import layout_of
from proxy.recording.snapshots import restored, taken
from tests.proxy.core.talk import SPEC, Talk
from utility_specs import load_specs


def classes_of(hint: Any, seen: set[type]) -> Iterator[type]:
    """Yield the classes of the planner that a value of this type may have, protocols aside."""
    for each in get_args(hint):
        yield from classes_of(each, seen)
    if isinstance(hint, type) and hint.__module__.startswith("planner.") and hint not in seen:
        seen.add(hint)
        if not getattr(hint, "_is_protocol", False):
            yield hint
            for field in get_type_hints(hint).values():
                yield from classes_of(field, seen)


@pytest.mark.parametrize("whole", [Problem, Plan])
def test_a_snapshot_may_have_all_that_a_decision_is_about(whole):
    """A class that the planner's data has anew was missing: no recording could begin while a search was under way."""
    found = list(classes_of(whole, set()))
    assert whole in found
    for each in found:
        assert layout_of(each).kind is each


@pytest.mark.parametrize("aggregation", ["most_recent", "best", "sum", "once", "current"])
def test_a_core_that_waits_for_a_search_has_a_snapshot(tmp_path, aggregation):
    """However the samples of its streams combine."""
    path = tmp_path / "spec.toml"
    path.write_text(SPEC.format(limit="40 kbit/s", window=1.0).replace("most_recent", aggregation))
    specs = load_specs(path)
    talk = Talk(Core(CoreSettings("r1", "z-r1"), specs, -10.0))
    talk.want(0.0)
    for number in range(3):
        talk.publish(5.0 + 0.1 * number, size=3000, red=0.1 * number)
    asked = talk.core.asked
    assert isinstance(asked, Decide)
    again = restored(taken(talk.core, 0, 5.3), specs)
    assert again.asked is not None
    assert (again.asked.problem.streams, again.asked.seed) == (asked.problem.streams, asked.seed)
