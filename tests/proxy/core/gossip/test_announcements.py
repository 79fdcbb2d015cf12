"""Which sends the others have to hear of at once, and what that takes of the allowance."""

import pytest

from proxy.core.coordination.budget import Budget
from proxy.core.coordination.coordination import Coordination
from proxy.core.coordination.team import sendable
from proxy.core.gossip.account import Account
from proxy.core.gossip.announcements import Announcements
from proxy.core.gossip.digest_budget import DigestBudget
from proxy.core.gossip.tuning import TUNING
from proxy.core.model.limits import limits_of
from proxy.core.model.settings import CoreSettings, broadcast
from proxy.core.model.tuning import TUNING as MODEL
from proxy.core.view.stream import Generated, Sent
from proxy.core.view.view import SharedView

WINDOW, LIMIT = 2.0, 20_000
LARGE = MODEL.large * LIMIT + 1.0
NOW = 20.0
COST = TUNING.announcement + TUNING.overhead


class Sender:
    """Robot r1 beside others, all of which want all cameras; each of the `sending` has one."""

    def __init__(self, specs, *, peers=2, sending=("r1", "p0"), size=1_000, period=1.0, **rest):
        self.view = SharedView(CoreSettings("r1", "z-r1", **rest), specs)
        for number in range(peers):
            self.view.add_peer(0.0, f"p{number}", f"z-p{number}")
            self.view.subscribers.set(f"z-p{number}", ("robot/**",))
        self.view.subscribers.set_own(("robot/**",))
        self.streams = {robot: self.film(robot, size, period) for robot in sending}
        self.coordination = Coordination(0.0, self.view.settings, self.view)
        limits = limits_of(specs, 0.0, peers + 1)
        self.coordination.set_limits(0.0, limits)
        self.coordination.set_members(0.0, self.view.peers)
        in_force = Budget(self.view, self.coordination)
        in_force.set_limits(limits)
        self.limits = limits
        self.budget = DigestBudget(0.0)
        account = Account(self.view, in_force, self.budget)
        account.set_rate(1.0, follows=False)
        self.announcements = Announcements(self.view, self.coordination, in_force, account, self.budget)
        self.look()

    def film(self, robot, size, period, place="front"):
        stream = self.view.streams.touch(0.0, robot, f"robot/{robot}-{place}/camera")
        for count in range(20):
            stream.note_generated(count + 1, Generated(NOW + (count - 19) * period, size, 1.0))
        return stream

    def share(self, now):
        """Return what part of the allowance it takes to announce what the team may send."""
        competing = self.view.contention.all(now)
        return self.announcements.share(sendable(now, self.view, competing, self.limits))

    def look(self, now=NOW):
        """The team looks anew who sends, and whether to split the limits."""
        self.coordination.advance(
            now, self.limits, 0.0, self.announcements.share, lambda _: 0.0, passes_at=self.announcements.passes_at
        )


@pytest.fixture
def make_sender(make_specs):
    return lambda **rest: Sender(make_specs(window=WINDOW), **rest)


def test_what_takes_more_than_a_little_of_a_limit_changes_what_others_plan(make_sender):
    """All copies together."""
    announcements = make_sender().announcements
    whole = announcements.changes_plans(round(LARGE))
    assert (whole, announcements.changes_plans(round(LARGE / 2)), announcements.changes_plans(round(LARGE / 2), 2)) == (
        True,
        False,
        True,
    )


def test_a_stream_is_large_by_what_it_sent_last(make_sender):
    """Of what nothing was sent nobody has heard."""
    sender = make_sender()
    stream = sender.streams["r1"]
    assert not sender.announcements.is_large(stream)
    for at, size, large in ((NOW, LARGE, True), (NOW + 1.0, 10, False)):
        sender.view.traffic.note_sent(stream, stream.forwarded + 1, Sent(at, at, round(size), 1.0))
        assert sender.announcements.is_large(stream) == large


def test_others_need_announcements_where_several_send_and_each_plans_for_all(make_sender):
    """Not where each has its part of the limits; and not where one robot alone sends, once all are known."""
    assert make_sender().announcements.needed
    assert not make_sender(coordination="split").announcements.needed
    alone = make_sender(sending=("r1",))
    assert not alone.announcements.needed
    alone.view.add_peer(NOW, "new", "z-new")
    alone.look(NOW + 1.0)
    assert alone.announcements.needed


def test_what_is_broadcast_is_overheard(make_sender):
    """So it is announced when it is sent, and takes nothing of the allowance."""
    sender = make_sender(transport=broadcast("224.0.0.226:7449"))
    sender.budget.sent(NOW, 10**6, 1)
    assert sender.announcements.overheard
    assert (sender.share(NOW), sender.announcements.due_at(NOW)) == (0.0, NOW)


def test_an_announcement_may_spend_the_allowance_ahead_of_time_but_not_for_ever(make_sender):
    """After that it waits for it where others send; who has only been met may be told at once."""
    sender, alone = make_sender(), make_sender(sending=("r1",))
    for each in (sender, alone):
        each.budget.sent(NOW, round(TUNING.announcement_debt * each.budget.rate / 2), 1, announces=True)
        assert each.announcements.due_at(NOW) == NOW
        each.budget.sent(NOW, round(TUNING.announcement_debt * each.budget.rate), 1, announces=True)
    assert sender.announcements.due_at(NOW) > NOW + 1.0
    assert alone.announcements.due_at(NOW) == NOW
    alone.view.add_peer(NOW, "new", "z-new")
    alone.look(NOW + 1.0)
    assert alone.announcements.needed
    assert alone.announcements.due_at(NOW + 1.0) == NOW + 1.0


@pytest.mark.parametrize("lost", [0, 30])
def test_what_nearly_all_overhear_is_announced_little_ahead_of_the_allowance(make_sender, monkeypatch, lost):
    """Where much is lost it is as in unicast."""
    sender = make_sender(transport=broadcast("224.0.0.226:7449"))
    monkeypatch.setattr(type(sender.view.paths), "mean_loss", lambda _: lost / 100)
    sender.budget.sent(NOW, round(0.9 * TUNING.announcement_debt * sender.budget.rate), 1, announces=True)
    assert (sender.announcements.tells_at(NOW) == NOW) is bool(lost)


def test_what_announcing_takes_grows_with_how_often_large_samples_come(make_sender):
    """Each is told to each robot. What is small is not announced."""
    twice = make_sender(size=round(LARGE), period=0.5)
    rate = 2 / 0.5
    assert twice.share(NOW) == pytest.approx(rate * COST * 2 / twice.budget.rate)
    before = twice.share(NOW)
    twice.film("r1", 10, 0.01, place="back")
    assert twice.share(NOW) == before
    twice.film("r1", round(LARGE), 0.5, place="side")
    assert twice.share(NOW) > before


def test_what_is_never_sent_is_not_announced(make_sender):
    """Frames that no limit lets pass made announcing what goes look cheap: it waited, and three quarters were free."""
    sender = make_sender(size=round(LARGE), period=0.5)
    share = sender.share(NOW)
    sender.film("p0", 50 * LIMIT, 0.1, place="back")
    assert sender.share(NOW) == share
    frames = max(sender.view.contention.all(NOW), key=lambda stream: stream.sizes.mean)
    sender.view.traffic.note_sent(frames, frames.forwarded + 1, Sent(NOW, NOW, 50 * LIMIT, 1.0))
    assert sender.share(NOW + 0.01) < share, "it is sent all the same"


def test_no_more_is_announced_than_the_limits_let_the_team_send(make_sender):
    """However often samples come."""
    for size in (1_000, 2_000):
        sender = make_sender(size=size, period=0.1)
        most = sender.limits[0].limit / (2 * size) / WINDOW
        assert sender.share(NOW) == pytest.approx(most * COST * 2 / sender.budget.rate)


def test_a_stream_of_one_sample_is_not_taken_to_come_a_thousand_times_a_second(make_sender):
    """Its period is not known: a single one made announcements seem too dear, and teams split."""
    sender = make_sender(size=round(LARGE), period=10.0)
    before = sender.share(NOW)
    new = sender.view.streams.touch(NOW, "r1", "robot/r1-new/camera")
    new.matching = True
    new.note_generated(1, Generated(NOW, round(LARGE), 1.0))
    more = sender.share(NOW) - before
    assert 0.0 <= more < 10 / WINDOW * COST * 2 / sender.budget.rate


def test_a_team_of_which_nothing_is_known_yet_sends_some_messages_in_each_window(make_sender):
    """Else a large team would find announcing cheap until it has begun."""
    sender = make_sender(sending=())
    rate = TUNING.fewest_sends / WINDOW
    assert sender.share(NOW) == pytest.approx(rate * COST * 2 / sender.budget.rate)
