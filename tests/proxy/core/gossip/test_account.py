"""What robots tell each other, paid for from the allowance."""

import pytest

from planner.measures import Energy
from proxy.core.coordination.budget import Budget
from proxy.core.coordination.coordination import Coordination
from proxy.core.gossip.account import Account
from proxy.core.gossip.digest_budget import DigestBudget
from proxy.core.gossip.tuning import TUNING
from proxy.core.model.limits import Limit, allowance_of, limits_of
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.digest_codec import pack_digest
from proxy.core.protocol.messages import Digest, State
from proxy.core.view.view import SharedView
from tests.proxy.core.talk import UNLIMITED
from tests.proxy.core.view.met import lose

ALLOWANCE, WINDOW = 0.05, 2.0
AIR = """
[[constraint]]
kind = "airtime"
limit = "50 %"
rate = "6 Mbit/s"
window = "2 s"
"""
OWN_ENERGY = Limit("energy", 2.0, 3.0, Energy(3.0, 2.0, per_byte=1e-3))


class Books:
    """The account of robot r1 in a team, and what it books in."""

    def __init__(self, specs, *, peers=2, private=False, **rest):
        self.view = SharedView(CoreSettings("r1", "z-r1", allowance=ALLOWANCE, **rest), specs)
        for number in range(peers):
            self.view.add_peer(0.0, f"p{number}", f"z-p{number}")
        limits = (OWN_ENERGY,) if private else limits_of(specs, ALLOWANCE, peers + 1)
        coordination = Coordination(0.0, self.view.settings, self.view)
        coordination.set_limits(0.0, limits)
        in_force = Budget(self.view, coordination)
        in_force.set_limits(limits)
        self.budget = DigestBudget(0.0)
        self.account = Account(self.view, in_force, self.budget)
        self.account.set_rate(1.0, follows=False)

    @property
    def counted(self):
        """What was told and heard [B]."""
        return self.account.told + self.account.heard

    @property
    def allowed(self):
        """What all may tell in a window without that it counts [B]."""
        return allowance_of(self.view.specs, ALLOWANCE, len(self.view.peers) + 1) * WINDOW


@pytest.fixture
def make_books(make_specs):
    return lambda text=None, **rest: Books(make_specs(window=WINDOW, text=text), **rest)


@pytest.mark.parametrize(("part", "follows", "share"), [(1.0, False, TUNING.digests), (0.8, True, 0.8)])
def test_digests_have_most_of_the_allowance_that_is_left(make_books, part, follows, share):
    """Where limits follow the channel they have all of it, as they tell of the channel."""
    books = make_books()
    books.account.set_rate(part, follows=follows)
    assert books.budget.rate == pytest.approx(share * ALLOWANCE * 10_000)


@pytest.mark.parametrize(
    ("peers", "rest", "states", "digests"),
    [
        (0, {"relayed": True, "digests_on_air": True}, 0, 0),
        (3, {}, 3, 3),
        (3, {"relayed": True}, 4, 4),
        (3, {"digests_on_air": True}, 3, 1),
    ],
)
def test_what_is_for_all_goes_to_each_robot_and_to_the_router(make_books, peers, rest, states, digests):
    """A digest that is broadcast goes once; who is alone tells nobody."""
    account = make_books(peers=peers, **rest).account
    assert (account.copies, account.digest_copies) == (states, digests)


def test_digests_that_were_lost_cost_as_much_as_those_that_came(make_books):
    """Of those that others send we hear the part that comes."""
    costs = []
    for received in (100, 50):
        books = make_books()
        lose(books.view.peers["z-p0"], 100, received)
        assert books.view.paths.mean_loss() == pytest.approx(1.0 - received / 100)
        books.account.heard_digest(3.0, 10_000)
        costs.append(books.counted)
    assert costs[1] - costs[0] == 2 * 10_000


@pytest.mark.parametrize("tight", [True, False])
def test_what_is_told_beyond_a_tight_allowance_of_a_window_is_load(make_books, tight):
    """The limits leave room for no more. It leaves the window as samples do."""
    books = make_books()
    books.budget.follow(0.0, splits=False, quiet=False, begins=False, window=WINDOW, tight=tight)
    size = round(0.3 * books.allowed)
    for number in range(3):
        books.account.heard_digest(3.0 + 0.1 * number, size)
    cost = books.account.digest_copies * (size + TUNING.overhead)
    if not tight:
        assert not books.view.traffic.sends
        return
    first, *_ = load = books.view.traffic.sent_since(0.0)
    assert first[0] == 3.1
    assert sum(amount * copies for _, (amount, copies), *_ in load) == pytest.approx(3 * cost - books.allowed, abs=4)
    books.account.heard_digest(3.0 + 1.5 * WINDOW, size)
    assert books.view.traffic.sent_since(0.0) == load


def test_what_is_told_too_much_takes_the_air_in_all_its_copies(make_books):
    """Each copy is a frame with a preamble: one that is as large as all of them takes the air for half as long."""
    books = make_books(text=AIR + UNLIMITED)
    (limit,) = limits_of(books.view.specs, ALLOWANCE, 3)
    books.budget.follow(0.0, splits=False, quiet=False, begins=False, window=WINDOW, tight=True)
    for number in range(300):
        books.account.heard_digest(3.0 + 0.001 * number, 40)
    one = limit.measure.use(40 + TUNING.overhead, 2, own=False)
    last = [entry for entry in books.view.traffic.sends if entry[0] > 3.25]
    assert sum(limit.measure.use(*amount, own=False) for _, amount, *_ in last) == pytest.approx(one * len(last))


def test_while_more_is_told_all_the_time_all_of_it_is_load(make_books):
    """More than what exceeds the allowance, as not all that others tell is heard, nor at once."""
    books = make_books()
    books.budget.follow(0.0, splits=False, quiet=False, begins=False, window=WINDOW, tight=True)
    cost = round(0.1 * books.allowed)
    for number in range(30):
        books.account.heard_digest(3.0 + number * WINDOW / 15, cost // books.account.digest_copies - TUNING.overhead)
    end = 3.0 + 29 * WINDOW / 15
    told = books.view.traffic.sent_since(end - 0.99 * WINDOW)
    load = sum(amount * copies for _, (amount, copies), *_ in told)
    assert load == pytest.approx(1.5 * books.allowed, abs=cost)


def test_where_robots_share_no_limit_nothing_that_they_tell_is_load(make_books):
    """They may tell as much as they like."""
    books = make_books(private=True)
    books.budget.follow(0.0, splits=False, quiet=False, begins=False, window=WINDOW, tight=True)
    books.account.heard_digest(3.0, 10_000)
    assert not books.view.traffic.sends


def test_a_whole_state_of_another_robot_is_for_us_alone(make_books):
    """An update is for all."""
    whole, update = make_books(), make_books()
    whole.account.heard_state(1.0, State("p0", "z-p0", "", "", number=4), 10_000)
    update.account.heard_state(1.0, State("p0", "z-p0", "", "", number=4, since=3), 10_000)
    assert update.counted - whole.counted == 10_000 + TUNING.overhead


def test_on_the_air_a_digest_costs_its_key(make_books):
    """Else a number stands for that, but it goes to each robot."""
    digest = Digest("r1", "z-r1", 1.0, 0, 0)
    size = len(pack_digest(digest)) + TUNING.overhead
    for on_air, cost in ((False, 2 * size), (True, size + TUNING.on_air + len("r1"))):
        books = make_books(digests_on_air=on_air)
        for number in range(10):
            books.account.sent_digest(1.1 + 0.001 * number, digest, announces=True)
        assert books.counted == 10 * cost


def test_states_and_questions_are_paid_for_later(make_books):
    """From what is for states; digests go on meanwhile."""
    books = make_books()
    books.account.sent_other(1.0, 5_000, 2)
    assert books.budget.states.paid_in > 0.0
    assert books.budget.due_ahead(1.0, 0.0) == 1.0


def test_where_robots_share_no_limit_there_is_no_window(make_books):
    """The energy of each is its own."""
    assert make_books(private=True).account.window == 0.0


def test_the_status_says_what_was_told_and_heard(make_books):
    """Copies and overhead included, beside what may be told."""
    books = make_books()
    books.account.sent_other(0.0, 20, 2)
    books.account.heard_digest(0.0, 40)
    assert books.account.described() == {
        "allowance": books.allowed / WINDOW,
        "told": 2 * (20 + TUNING.overhead),
        "heard": books.account.digest_copies * (40 + TUNING.overhead),
    }
