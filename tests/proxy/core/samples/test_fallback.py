"""What passes while the planner fails."""

from hypothesis import given
from hypothesis import strategies as st

from planner import Constraint
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward
from proxy.core.samples.fallback import TokenBuckets
from tests.proxy.core.talk import only

LIMITS = (Constraint("bytes", 1.0, 1000.0), Constraint("messages", 0.5, 4.0))
SIZE = 600
SIZES = [500.0, 2.0]
SAMPLES = st.tuples(st.floats(0.0, 0.4), st.floats(1.0, 900.0))


@given(st.lists(SAMPLES, max_size=60))
def test_in_any_time_no_more_passes_than_a_bucket_and_what_flows_into_it(samples):
    """Beside one sample that is larger than the bucket."""
    buckets, now, sent = TokenBuckets(), 0.0, []
    for pause, size in samples:
        now += pause
        buckets.fill(now, LIMITS, SIZES)
        if not buckets.lacking((size, 1.0)):
            buckets.take((size, 1.0))
            sent.append((now, size))
    for place, (begin, _) in enumerate(sent):
        for count, (end, size) in enumerate(sent[place:], 1):
            total = sum(each for _, each in sent[place : place + count])
            assert total <= SIZES[0] * (1.0 + end - begin) + max(0.0, size - SIZES[0]) + 1e-6
            assert count <= SIZES[1] * (1.0 + (end - begin) / 0.5) + 1e-6


def test_a_bucket_is_full_again_after_a_window():
    """And says until then which limit has no room."""
    buckets = TokenBuckets()
    buckets.fill(10.0, LIMITS, SIZES)
    buckets.take((400.0, 1.0))
    assert buckets.lacking((200.0, 1.0)) == ("bytes",)
    buckets.fill(10.25, LIMITS, SIZES)
    assert buckets.lacking((200.0, 1.0)) == ()
    buckets.take((100.0, 2.0))
    assert buckets.lacking((100.0, 1.0)) == ("messages",)
    buckets.fill(11.2, LIMITS, SIZES)
    assert buckets.lacking((500.0, 2.0)) == ()


def test_a_sample_larger_than_its_bucket_passes_when_that_is_full():
    """And is paid for afterwards."""
    buckets = TokenBuckets()
    buckets.fill(0.0, LIMITS, SIZES)
    assert buckets.lacking((900.0, 1.0)) == ()
    buckets.take((900.0, 1.0))
    buckets.fill(0.7, LIMITS, SIZES)
    assert buckets.lacking((1.0, 1.0)) == ("bytes",)
    buckets.fill(0.9, LIMITS, SIZES)
    assert buckets.lacking((1.0, 1.0)) == ()


def test_samples_that_are_not_urgent_leave_room_for_urgent_ones_however_small_they_are(make_talk):
    """They take half of the limit of 10 kB/s, and urgent ones the rest; what is undisputed needs no planner."""
    talk = make_talk()
    talk.want(0.0)
    passed = {5: 0, 2: 0}
    for i in range(400):
        now, priority = 0.1 + 0.01 * i, 2 if i % 20 == 0 and i >= 200 else 5
        _, commands = talk.publish(now, size=SIZE, priority=priority)
        decide = only(commands, Decide)
        if decide:
            commands = talk.tell(ev.DecisionReady(now, decide[0].ticket, None, "boom"))
        passed[priority] += SIZE * len(only(commands, Forward))
    assert 18_000 <= passed[5] <= 5_000 * (1 + 4.0) + SIZE
    assert passed[2] == 10 * SIZE
    assert talk.core.counts.by_reason["dropped:fallback"] > 0


def test_others_sends_leave_less(make_talk):
    """Where all plan for all, what others are known to have sent is not ours."""
    talk = make_talk(transport="broadcast")
    talk.want(0.0)
    talk.tell(ev.SampleHeard(0.05, "robot/op/camera", 7800, "zz-op", None, {"red": 0.0}))
    outcomes = []
    for now, size in ((0.1, 900), (0.12, 400), (0.14, 400)):
        _, commands = talk.publish(now, size=size, priority=2 if size == 400 and now > 0.13 else 5)
        (decide,) = only(commands, Decide)
        outcomes += only(talk.tell(ev.DecisionReady(now, decide.ticket, None, "boom")), Forward, Drop)
    assert [type(outcome) for outcome in outcomes] == [Forward, Drop, Forward]
