"""What the status says of prices, and of how old samples are where they are wanted; seen at a core that talks."""

import pytest

from proxy.core.interface.commands import Decide, Drop, Forward
from tests.proxy.core.talk import only

SPEC = """
[[constraint]]
kind = "throughput"
limit = "1 Mbit/s"
window = 0.5
[[constraint]]
kind = "messages"
limit = 1000
window = 10
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
utility = { kind = "video" }
"""


@pytest.fixture
def make_robot(make_talk, make_specs):
    """A robot whose camera somebody wants."""

    def make():
        talk = make_talk(make_specs(text=SPEC))
        talk.want(-10.0, keys=("robot/**",))
        return talk

    return make


def run(talk, begin, end, *, size, look=None):
    """Publish frames of `size` at 10 Hz; return what became of them, and have somebody `look` now and then."""
    outcomes = []
    for step in range(round(begin * 10), round(end * 10)):
        now = 0.1 * step
        _, said = talk.publish(now, "robot/r1/camera", size=size)
        for decide in only(said, Decide):
            said += talk.answer(now + 0.002, decide, send=step % 2 == 0)
        outcomes += only(said, Forward, Drop, Decide)
        if look is not None:
            look(now + 0.003)
    return outcomes


def status_at(talk, now):
    return talk.core.status(now)


def test_room_costs_nothing_while_there_is_enough(make_robot):
    """Ten small frames a second are far from any limit."""
    talk = make_robot()
    run(talk, -10.0, 0.0, size=1000)
    assert [(limit["price"], limit["price_per_kb"]) for limit in status_at(talk, 0.0)["budget"]] == [(0, 0), (0, 0)]


def test_scarce_room_has_a_price_per_unit_and_per_kilobyte(make_robot):
    """A limit of bytes has one for a kilobyte; one of messages is not scarce here, and is not used by bytes at all."""
    talk = make_robot()
    run(talk, -10.0, 0.0, size=40_000)
    throughput, messages = status_at(talk, 0.0)["budget"]
    assert throughput["price"] > 0.0
    assert throughput["price_per_kb"] == pytest.approx(1000 * throughput["price"])
    assert (messages["price"], messages["price_per_kb"]) == (0.0, 0.0)


def test_what_all_use_is_what_this_robot_and_the_others_sent(make_robot):
    """Alone, that is what it sent itself."""
    talk = make_robot()
    run(talk, -10.0, 0.0, size=1000)
    throughput, _ = status_at(talk, 0.0)["budget"]
    assert throughput["used_by_all"] == throughput["used"] >= 4000


def test_the_age_at_receivers_is_that_of_the_newest_sample_there(make_robot):
    """It grows while nothing comes, and is not known where nobody wants the stream or none has arrived."""
    talk = make_robot()
    run(talk, -10.0, 0.0, size=1000)
    (stream,) = status_at(talk, 0.5)["streams"]
    assert stream["latency"] is not None
    assert stream["age"] == pytest.approx(0.6, abs=1e-6)  # the last one was published at -0.1
    (later,) = status_at(talk, 2.5)["streams"]
    assert later["age"] == pytest.approx(2.6, abs=1e-6)
    (before,) = status_at(talk, -20.0)["streams"]
    assert before["age"] is None
    talk.want(2.6, keys=())
    (unwanted,) = status_at(talk, 2.7)["streams"]
    assert (unwanted["latency"], unwanted["age"]) == (None, None)


def test_looking_changes_nothing(make_robot):
    """Whoever asks for the status at any time gets the same decisions as who never does."""
    alone, watched = make_robot(), make_robot()
    undisturbed = run(alone, -10.0, 5.0, size=20_000)
    assert undisturbed == run(watched, -10.0, 5.0, size=20_000, look=watched.core.status)


def test_prices_are_those_by_which_was_decided_last(make_robot):
    """Nothing is cleared anew for who looks, unless nothing was decided for a while."""
    talk = make_robot()
    run(talk, -10.0, 0.0, size=40_000)
    disputes, budget = talk.core.gate.appraisal.disputes, talk.core.budget
    last = disputes.last_prices(0.0, budget.limits)
    assert last is not None
    assert [limit["price"] for limit in status_at(talk, 0.0)["budget"]] == list(last)
    assert disputes.last_prices(0.0, ()) is None
    assert talk.core.gate.appraisal.last_prices(5.0) is None
    assert len(status_at(talk, 5.0)["budget"]) == 2


def test_totals_are_those_of_all_streams(make_robot):
    """By information type; they say nothing of each stream, and else the same as the status."""
    talk = make_robot()
    run(talk, -10.0, 0.0, size=40_000)
    status, totals = status_at(talk, 0.0), talk.core.totals(0.0)
    (stream,) = status["streams"]
    assert totals["types"] == {
        "camera": {"streams": 1, "generated": stream["generated"], "by_reason": stream["by_reason"]}
    }
    assert totals["streams"] == []
    assert {name: value for name, value in totals.items() if name not in ("streams", "types")} == {
        name: value for name, value in status.items() if name != "streams"
    }


def test_who_looks_again_and_again_is_told_less_of_each_stream(make_robot):
    """What `sendworthy top` shows, as the status has it."""
    talk = make_robot()
    run(talk, -10.0, 0.0, size=1000)
    status, live = status_at(talk, 0.0), talk.core.live(0.0)
    (whole,), (row,) = status["streams"], live["streams"]["rows"]
    part = dict(zip(live["streams"]["columns"], row, strict=True))
    assert set(whole) > set(part) >= {"robot", "key", "type", "size", "generated", "forwarded", "by_reason", "age"}
    assert all(whole[name] == value for name, value in part.items())
    assert {**live, "streams": []} == {**status, "streams": []}
