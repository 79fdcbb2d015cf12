"""What the core tells of its decisions, as transcripts."""

import pytest

from planner import SearchSettings, start
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide
from proxy.core.model.mode import Mode
from tests.proxy.core.talk import only

KEY = "robot/r1/camera"


def decisions(talk, now, key=KEY, last=16, after=0):
    return talk.core.why(now, key, last, after)["decisions"]


def contend(talk, until=40):
    """Publish more than there is room for; return the plans by the number of the sample."""
    plans = {}
    for n in range(1, until):
        now = 0.05 * n
        sample, commands = talk.publish(now, size=3000, red=0.5 if n % 3 else 0.0)
        while decides := only(commands, Decide):
            search = start(decides[0].problem, SearchSettings(), decides[0].seed)
            search.run(decides[0].iterations)
            plans[sample] = search.plan()
            commands = talk.tell(ev.DecisionReady(now + 0.01, decides[0].ticket, plans[sample]))
    return plans


@pytest.mark.parametrize("mode", [Mode.ENFORCE, Mode.SHADOW])
def test_a_search_is_told_with_both_plans_and_who_competed(make_talk, mode):
    """The numbers are those of the plan; in shadow it is told what would have been dropped."""
    talk = make_talk(mode=mode)
    talk.want(0.0)
    plans = contend(talk)
    told = [each for each in decisions(talk, 2.1) if each["search"]]
    assert told
    known = {(plan.utility, sum(plan.prices)): plan for plan in plans.values()}
    for each in told:
        search = each["search"]
        plan = known[search["with"] if search["send"] else search["without"], search["price"]]
        assert search["send"] == plan.send
        assert (search["iterations"], search["gap"], search["earns"]) == (plan.iterations, plan.gap, plan.earns)
        if not plan.send:
            assert (search["with"], search["lead"]) == (plan.opposite, None if plan.lead is None else -plan.lead)
        if search["difference"] is not None:
            assert search["difference"] == pytest.approx(search["with"] - search["without"])
        if plan.send and search["lead"] is not None:
            assert search["lead"] <= plan.earns + 1e-9
        assert search["own"]["key"] == KEY
        assert search["allowed"] == 300
    dropped = [each for each in decisions(talk, 2.1) if each["reason"].startswith("dropped:")]
    assert dropped
    assert all(each["shadowed"] is each["sent"] is (mode is Mode.SHADOW) for each in dropped)


def test_samples_that_are_sent_as_they_come_are_one_decision(make_talk, make_specs):
    """There is room for all."""
    talk = make_talk(make_specs("80 Mbit/s"), settle=0.0)
    talk.want(0.0)
    for n in range(30):
        talk.publish(0.2 * n + 0.1, size=100)
        if n < 20:
            for decide in [c for c in talk.said if isinstance(c, Decide)][-1:]:
                talk.answer(0.2 * n + 0.11, decide, send=True)
    last = decisions(talk, 6.0)[-1]
    assert (last["reason"], last["cause"], last["sent"]) == ("forwarded", "unneeded", True)
    assert last["count"] > 1
    assert last["first_age"] > last["age"] >= 0.0


def test_what_does_not_fit_is_told_with_the_limit(make_talk):
    """By its name; and only what is newer than asked for."""
    talk = make_talk()
    talk.want(0.0)
    for n in range(12):
        _, commands = talk.publish(0.1 + 0.01 * n)
        for decide in only(commands, Decide):
            talk.answer(0.105 + 0.01 * n, decide, send=True)
    told = decisions(talk, 1.0)
    assert (told[-1]["reason"], told[-1]["lacking"]) == ("dropped:constraint", ["throughput"])
    assert told[-1]["worth"] > 0.0
    assert decisions(talk, 1.0, after=told[-1]["number"]) == []
    assert len(decisions(talk, 1.0, last=2)) == 2


def test_what_is_being_decided_is_told(make_talk):
    """And what gave way to a newer one."""
    talk = make_talk()
    talk.want(0.0)
    for now in (0.1, 0.2, 0.3):
        talk.publish(now)
    told = talk.core.why(0.4, KEY, 3, 0)
    assert [each["deciding"] for each in told["undecided"]] == [False, True]
    assert [each["reason"] for each in told["decisions"]] == ["dropped:superseded"]
    assert told["decisions"][0]["size"] is None
    assert talk.core.decided_keys() == [KEY]


def test_unknown_streams_have_no_decisions(make_talk):
    """Nor a type."""
    told = make_talk().core.why(0.0, "other", 3, 0)
    assert (told["type"], told["decisions"], told["undecided"]) == (None, [], [])


def test_a_key_that_was_only_deleted_yet_has_no_decisions(make_talk):
    """No sample of it was generated; the question was answered with an error."""
    talk = make_talk()
    talk.publish(1.0, size=0, delete=True)
    assert talk.core.decided_keys() == [KEY]
    told = talk.core.why(2.0, KEY, 3, 0)
    assert (told["type"], told["generated"], told["decisions"]) == ("camera", 0, [])


def test_late_and_failed_searches_are_told(make_talk):
    """And what nobody wants, and what the mesh did not take."""
    talk = make_talk()
    talk.want(0.0)
    _, commands = talk.publish(0.1)
    talk.tell(ev.DecisionLate(0.2, only(commands, Decide)[0].ticket))
    sample, commands = talk.publish(0.3)
    talk.tell(ev.DecisionReady(0.31, only(commands, Decide)[0].ticket, None, "boom"))
    talk.tell(ev.SampleRefused(0.32, sample))
    talk.tell(ev.PeerGone(0.4, "op", "zz-op"))
    talk.publish(0.5)
    told = [(each["reason"], each["cause"]) for each in decisions(talk, 1.0)]
    assert told == [
        ("passed:fallback", "late"),
        ("passed:fallback", "rule"),
        ("dropped:egress", ""),
        ("passed:unwanted", ""),
    ]
