"""Reading values off a status."""

from proxy.metrics.metric import Metric, by_name, each_of, single


def test_a_value_is_found_by_its_path():
    """What is there and not known has no row."""
    rows = single("a", "b")
    assert list(rows({"a": {"b": 3}})) == [((), 3.0)]
    assert list(rows({"a": {"b": None}})) == []


def test_a_table_gives_a_row_for_each_name():
    """As far as names begin as they should."""
    status = {"by": {"dropped:a": 1, "passed:b": 2}}
    assert list(by_name("by")(status)) == [(("dropped:a",), 1.0), (("passed:b",), 2.0)]
    assert list(by_name("by", only="dropped:")(status)) == [(("dropped:a",), 1.0)]
    assert list(by_name("by", without="dropped:")(status)) == [(("passed:b",), 2.0)]


def test_a_list_gives_a_row_for_each_entry():
    """Its names are labels."""
    status = {"all": [{"name": "a", "value": 1}, {"name": "b", "value": None}]}
    assert list(each_of(("all",), ("name",), lambda entry: entry["value"])(status)) == [(("a",), 1.0)]


def test_a_counter_is_called_a_total():
    """As everywhere in Prometheus."""
    rows = single("a")
    assert Metric("things", "counter", "Things.", rows).exported == "sendworthy_things_total"
    assert Metric("things", "gauge", "Things.", rows).exported == "sendworthy_things"
