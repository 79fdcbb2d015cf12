"""The columns of the status."""

import pytest

from proxy.status.fields import Part
from proxy.status.model import Status
from proxy.status.tables import TABLES


def model_at(path):
    """The table of the format whose rows are at a path of the JSON."""
    model = Status
    for name in path.split("."):
        found = next(f for key, f in model.model_fields.items() if name in (key, f.alias))
        model = next(
            part
            for part in (found.annotation, *getattr(found.annotation, "__args__", ()))
            if isinstance(part, type) and issubclass(part, Part)
        )
    return model


@pytest.mark.parametrize("table", TABLES, ids=lambda table: table.title)
def test_columns_are_made_of_fields_that_there_are(table):
    """And each says what it means, by a name that no other column of its table has."""
    known = (
        model_at(table.path).model_fields
        if table.path != "daemon.denied"
        else model_at("daemon.denied.out").model_fields
    )
    for column in table.columns:
        assert set(column.fields) <= set(known)
        assert column.means
    assert len({column.head for column in table.columns}) == len(table.columns)
    assert table.columns[0].name
