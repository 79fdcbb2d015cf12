"""What judging a file may take."""

import pytest

from tests.utility_specs.bad_specs import GOOD
from utility_specs import SpecsError
from utility_specs.effort import ENOUGH, MOST_TEXT
from utility_specs.loader import load_set


def problems(path, text):
    path.write_text(text)
    with pytest.raises(SpecsError) as caught:
        load_set([path])
    return [problem.message for problem in caught.value.problems]


def types(count, more):
    """So many types, each with these lines."""
    one = '[[information_type]]\nname = "t{0}"\nkeys = ["k/{0}"]\nutility = {{ kind = "video" }}\n'
    return "".join(one.format(number) + more + "\n" for number in range(count))


def test_after_enough_wrong_tables_the_others_are_not_judged(tmp_path):
    """The file says so."""
    found = problems(tmp_path / "s.toml", types(ENOUGH + 5, 'scale = "redd"'))
    assert found == ['unknown feature "redd" (this type has no features)'] * ENOUGH + ["is not judged any further"]


def test_until_then_all_are_judged(tmp_path):
    """Nothing is said of others where there are none."""
    assert len(problems(tmp_path / "s.toml", types(ENOUGH, 'scale = "redd"'))) == ENOUGH


def test_tables_with_too_many_items_are_refused_before_any_is_judged(tmp_path):
    """However wrong these are."""
    constants = "[constants]\n" + "".join(f'c{i} = "1 mn"\n' for i in range(100))
    assert problems(tmp_path / "s.toml", constants + GOOD) == ["must hold at most 64 values, not 100"]


def test_expressions_of_a_file_have_room_for_so_many_characters(tmp_path):
    """All together; the first that is too much is refused."""
    long = "1" + " + 1" * 45
    count = MOST_TEXT // len(long) + 1
    (message, *_) = problems(tmp_path / "s.toml", types(count, f'scale = "{long}"'))
    assert message == f"the expressions of this file have more than {MOST_TEXT} characters in all"
