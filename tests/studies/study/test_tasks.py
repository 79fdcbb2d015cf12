"""Tasks and their keys."""

from dataclasses import fields

from studies.study.tasks import Task

TASK = Task("best", "mixed", 5.0, 0)
OTHER = {str: "other", float: 77.0, int: 77, bool: True}


def test_the_key_depends_on_everything():
    """Two tasks with the same key would get each other's record."""
    keys = {TASK.key}
    for field in fields(Task):
        keys.add(TASK.but(**{field.name: OTHER[type(getattr(TASK, field.name))]}).key)
    assert len(keys) == 1 + len(fields(Task))


def test_whole_numbers_have_the_key_of_the_same_real_ones():
    """A limit of 5 is one of 5.0."""
    assert Task("best", "mixed", 5, 0, loss=0).key == TASK.key


def test_tasks_go_through_json():
    """As the store keeps them."""
    assert Task.from_dict(TASK.as_dict()) == TASK
