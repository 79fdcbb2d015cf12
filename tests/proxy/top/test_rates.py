"""What happens in a second, from two statuses."""

import pytest

from proxy.top.rates import Change
from tests.proxy.top.statuses import R1, later


def test_without_a_first_status_no_rate_is_known():
    """One picture has no speed."""
    change = Change(R1)
    assert change.rate("counts", "in") is change.mean("decisions", "seconds", "made") is None
    assert change.dropped() == {}
    assert all(stream["made"] is stream["unsent"] is stream["bytes"] is None for stream in change.streams())


def test_rates_are_by_the_clock_of_the_daemon():
    """However long the answers took."""
    change = Change(R1).then(later(R1))
    assert change.rate("counts", "in") == pytest.approx(30.0)
    assert change.mean("decisions", "seconds", "made") == pytest.approx(0.005)
    assert change.dropped() == pytest.approx({"dropped:planner": 10.0, "dropped:constraint": 2.0})


def test_each_stream_has_its_rates_and_the_reasons_of_its_drops():
    """Of others' streams no reasons are known."""
    for stream in Change(R1).then(later(R1)).streams():
        assert (stream["made"], stream["sent"], stream["unsent"]) == pytest.approx((10.0, 6.0, 4.0))
        assert stream["bytes"] == pytest.approx(6.0 * stream["size"])
        assert stream["why"] == ({"dropped:planner": pytest.approx(4.0)} if stream["robot"] == "r1" else {})


def test_rates_of_others_are_by_the_times_of_their_samples():
    """What they tell comes now and then: ten samples may be news of half a second or of two."""
    (stream,) = [each for each in R1["streams"] if each["robot"] != "r1"][:1]
    before = R1 | {"streams": [stream | {"last_generated": 0.1}]}
    for age, rate in ((0.1, 10.0), (1.1, 20.0), (2.1, 10.0)):  # the last: nothing that anybody could divide by
        after = later(before)
        after["streams"] = [each | {"last_generated": age} for each in after["streams"]]
        (row,) = Change(before).then(after).streams()
        assert row["made"] == pytest.approx(rate)


def test_a_daemon_that_started_anew_begins_anew():
    """Its counts are smaller: that is no rate."""
    change = Change(later(R1)).then(R1)
    assert change.before is None


def test_a_stream_that_is_new_has_no_rates_yet():
    """Nor one of a status that does not tell of counts at all."""
    change = Change(R1 | {"streams": []}).then(later(R1))
    assert {stream["made"] for stream in change.streams()} == {None}
    assert Change({"uptime": 1.0}).then({"uptime": 2.0, "streams": [{}]}).rate("counts", "in") == 0.0
