"""Whether an answer has the shape of a status."""

import copy
import json
from functools import reduce
from operator import getitem
from pathlib import Path

import pytest

from proxy.status.shape import fits

RECORDED = [json.loads(file.read_text()) for file in sorted((Path(__file__).parent / "recorded").glob("*.json"))]


def places(value, path=()):
    """Where there is anything in a status."""
    named = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for name, each in named:
        yield (*path, name)
        yield from places(each, (*path, name))


@pytest.mark.parametrize("status", RECORDED)
def test_what_daemons_say_fits_and_so_does_less_or_more(status):
    """Other versions do not say the same."""
    assert fits(status)
    assert fits({**status, "surprise": [1], "streams": [{"key": "a", "surprise": {}}], "mode": "another"})
    for name in status:
        assert fits({each: said for each, said in status.items() if each != name})


@pytest.mark.parametrize("status", RECORDED)
def test_what_is_of_another_kind_anywhere_does_not_fit(status):
    """In whichever table it stands."""
    assert not fits([status])
    for *path, name in places(status):
        changed = copy.deepcopy(status)
        table = reduce(getitem, path, changed)
        if table[name] is not None:
            table[name] = "strange" if isinstance(table[name], list) else ["strange"]
            assert not fits(changed), (*path, name)


@pytest.mark.parametrize(
    "wrong", [{"robot": 5}, {"uptime": "x"}, {"uptime": 10**400}, {"malformed": 0.5}, {"peers": [1]}, {"counts": []}]
)
def test_what_is_wrong_in_one_field_does_not_fit(wrong):
    """Whatever else is right."""
    assert not fits(RECORDED[0] | wrong)
