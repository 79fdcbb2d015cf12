"""When digests may go out, within the allowance of the team."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.gossip.digest_budget import DigestBudget, RecentBytes, StateBudget
from proxy.core.gossip.tuning import TUNING
from proxy.core.protocol.messages import Echo
from utility_specs.digests import LEAST_RATE

SIZE = 40
AHEAD = 5.0
OVERHEAD = TUNING.overhead
SAVED = TUNING.state_savings


def budget_of(rate, robots=1, **rest):
    made = DigestBudget(0.0, **rest)
    made.set_rate(rate, robots, robots)
    return made


def paid_at(budget, now):
    """When another state may follow, as of now."""
    budget.advance(now)
    return now + budget.states.paid_in


@pytest.mark.parametrize(("announcing", "part"), [(False, 1.0), (True, TUNING.ordinary)])
def test_ordinary_news_of_a_robot_stay_within_its_part(announcing, part):
    """An equal one of what announcements leave: over twenty seconds no more, those of the beginning aside."""
    budget, now, spent, copies = budget_of(2500.0, robots=5), 0.0, 0, 4
    while now < 20.0:
        now += 0.05
        if announcing:
            budget.heard(now, 75, copies)
        if budget.due(now, apart=0.0, copies=copies) <= now:
            budget.sent(now, SIZE, copies)
            spent += (SIZE + OVERHEAD) * copies
    assert 0.8 * part * 10_000 <= spent <= part * 10_000 + 2000


@given(
    st.integers(1, 6),
    st.lists(st.tuples(st.integers(0, 5), st.booleans(), st.floats(0.0, 0.5), st.integers(20, 300)), max_size=150),
)
def test_in_the_long_run_all_robots_together_are_within_the_rate(robots, wanted):
    """Whoever announces, and whoever tells all: besides what was saved, spent ahead, and one of each that was begun."""
    rate, now, spent, largest = 1000.0, 0.0, 0, 0
    team = [budget_of(rate, robots, turn=number / robots) for number in range(robots)]
    for who, announces, pause, size in wanted:
        now += pause
        budget = team[who % robots]
        due = budget.due_ahead(now, AHEAD, announces=True) if announces else budget.due(now, apart=0.0, copies=1)
        if due > now:
            continue
        budget.sent(now, size, 1, announces=announces)
        for other in team:
            if other is not budget:
                other.heard(now, size, 1)
        spent += size + OVERHEAD
        largest = max(largest, size + OVERHEAD)
    ordinary = 3 * robots * largest + 100.0 * robots
    assert spent <= rate * (now + TUNING.spare + AHEAD) + ordinary + largest


@given(st.lists(st.tuples(st.sampled_from(("digest", "state", "question")), st.integers(1, 3000)), max_size=80))
def test_what_is_paid_for_later_is_within_our_part(sent):
    """Digests and, beside them, states and questions: besides what was saved, and a few of each that were begun."""
    budget, now, spent, largest = budget_of(500.0), 0.0, 0, 0
    for kind, size in sent:
        if kind == "digest":
            now = max(now, budget.due(now, apart=0.0, copies=2))
            budget.sent(now, size, 2)
        elif kind == "state":
            now = paid_at(budget, now)
            budget.states.owe(size, 2)
        else:
            now = paid_at(budget, now)
            budget.states.owe(size, 1)
        spent += (size + OVERHEAD) * (1 if kind == "question" else 2)
        largest = max(largest, size + OVERHEAD)
    assert spent <= (1.0 + TUNING.states) * 500.0 * (now + SAVED) + SAVED * 100.0 + 3 * 4 * largest + 500.0


def test_digests_go_on_while_a_state_is_paid_for():
    """With half of our part; another state waits."""
    budget = budget_of(1000.0)
    budget.states.owe(3000, 4)
    before = paid_at(budget, 0.0)
    assert before > 20.0
    for number in range(1, 11):
        now = budget.due(float(2 * number), apart=0.0, copies=4)
        assert now <= 2 * number + 1.0
        budget.sent(now, SIZE, 4)
    assert paid_at(budget, 21.0) <= before


def test_ordinary_news_pay_for_states():
    """What states take beyond what is saved for them these do not tell meanwhile."""
    told = {}
    for owed in (0, 9000):
        budget, told[owed] = budget_of(2500.0, robots=5), 0
        budget.states.owe(owed, 4)
        for number in range(400):
            now = 0.05 * number
            if budget.due(now, apart=0.0, copies=4) <= now:
                budget.sent(now, SIZE, 4)
                told[owed] += 1
    assert 0 < told[9000] < 0.8 * told[0]


def test_what_was_sent_is_announced_ahead_of_time_by_whom_it_concerns():
    """One robot may use what all do not, but no more of it than so many seconds' worth ahead."""
    budget, told = budget_of(1000.0, robots=10), 0
    while budget.due_ahead(0.0, AHEAD) <= 0.0:
        budget.sent(0.0, SIZE, 9, announces=True)
        told += 1
    assert AHEAD * 1000.0 <= told * (SIZE + OVERHEAD) * 9 <= (AHEAD + TUNING.spare) * 1000.0 + (SIZE + OVERHEAD) * 9
    assert budget.due_ahead(0.0, AHEAD) < 1.0
    assert budget.due_ahead(0.0, 0.0) == pytest.approx(AHEAD, rel=0.15)


def test_what_others_tell_is_taken_from_the_same_pool():
    """An announcement waits for it where they have spent as much ahead of time as may be."""
    budget = budget_of(1000.0, robots=3)
    budget.heard(0.0, 5000 - OVERHEAD, 1)
    assert budget.due_ahead(0.0, AHEAD) <= 0.0
    budget.heard(0.0, 500 - OVERHEAD, 2)
    assert budget.due_ahead(0.0, AHEAD) == pytest.approx(1.0)


def test_nobody_is_silenced_by_what_others_tell():
    """Whatever they say, ordinary news go out every second or two, and announcements when it is over."""
    budget, told = budget_of(1000.0, robots=3), []
    for step in range(1000):
        now = 0.02 * step
        budget.heard(now, 8000, 2)
        if budget.due(now, apart=0.0, copies=2) <= now:
            budget.sent(now, SIZE, 2)
            told.append(now)
    assert len(told) >= 12
    assert max(after - before for before, after in pairwise(told)) <= 2.0 * TUNING.slowest_digest + 0.021
    assert budget.due_ahead(20.0, AHEAD) <= 20.0 + TUNING.deepest_debt - AHEAD


def test_who_is_in_debt_by_what_others_told_announces_about_half_as_much_as_its_part():
    """Those who did not hear that go on to use up the allowance, so the debt lasts."""
    budget, told, cost = budget_of(1000.0, robots=3), 0, (SIZE + OVERHEAD) * 3
    budget.sent(0.0, SIZE, 3, announces=True)
    budget.heard(0.0, 60_000, 1)
    for step in range(1000):
        now = 0.02 * step
        budget.heard(now, 20 - OVERHEAD, 1)
        if budget.due_ahead(now, AHEAD, announces=True) <= now:
            budget.sent(now, SIZE, 3, announces=True)
            told += 1
    assert 0.8 <= told * cost / (0.5 * 1000.0 * 20.0 / 3) <= 1.0


@pytest.mark.parametrize("more", [100, 1000, 4000])
def test_who_counts_a_little_more_as_owed_announces_nearly_as_often(more):
    """Three always have something to announce; one of them heard of more than the others."""
    budgets, told = [budget_of(1000.0, robots=3) for _ in range(3)], [0, 0, 0]
    for budget in budgets:
        budget.heard(0.0, 5000, 1)
    budgets[0].heard(0.0, more, 1)
    for step in range(6000):
        now = 0.01 * step
        first = min(range(3), key=lambda at: budgets[at].due_ahead(now, AHEAD, announces=True))
        if budgets[first].due_ahead(now, AHEAD, announces=True) > now:
            continue
        told[first] += 1
        budgets[first].sent(now, SIZE, 3, announces=True)
        for other in {0, 1, 2} - {first}:
            budgets[other].heard(now, SIZE, 3)
    cost = (SIZE + OVERHEAD) * 3
    assert told[0] >= 0.4 * max(told)
    assert sum(told) * cost <= 1000.0 * 60.0 + TUNING.deepest_debt * 1000.0


@pytest.mark.parametrize("rate", [LEAST_RATE, 1e18])
def test_an_announcement_has_a_time_whatever_the_allowance_is(rate):
    """A limit that is meant for none leaves so much that no clock tells how long a digest takes of it."""
    budget = budget_of(rate, robots=3)
    budget.sent(1e6, SIZE, 3, announces=True)
    assert budget.due_ahead(1e6, AHEAD, announces=True) == 1e6


@pytest.mark.parametrize("window", [0.25, 0.5, 0.9])
def test_nobody_is_silenced_by_others_that_use_up_the_allowance(window):
    """A window and a digest's turn after its part paid for it a robot tells its news, whatever the others do."""
    budget, told = DigestBudget(0.0), 0
    budget.set_rate(1000.0, 4, 1)
    for step in range(3000):
        now = 0.02 * step
        budget.follow(now, splits=False, quiet=False, begins=False, window=window)
        budget.heard(now, 6, 1)
        if budget.due(now, apart=0.0, copies=1) <= now:
            budget.sent(now, SIZE, 1)
            told += 1
    assert told >= 30


def test_two_robots_that_waited_for_the_allowance_do_not_tell_at_the_same_moment():
    """They begin with other turns, and each digest moves its robot's on."""
    one, other = (budget_of(1000.0, robots=2, turn=turn) for turn in (0.1, 0.6))
    for _ in range(4):
        for budget in (one, other):
            budget.heard(0.0, 300, 1)
            budget.sent(0.0, SIZE, 1)
        due = [budget.due(0.05, apart=0.0, copies=1) for budget in (one, other)]
        assert abs(due[0] - due[1]) > 0.01


def test_without_news_a_digest_goes_out_slowly():
    """Once a second, so that clocks and counts stay known."""
    budget = budget_of(1e6)
    budget.sent(5.0, SIZE, 1)
    assert budget.due(5.1, apart=TUNING.slowest_digest, copies=1) == pytest.approx(5.0 + TUNING.slowest_digest)


@pytest.mark.parametrize("follows", [True, False])
def test_where_limits_follow_the_channel_digests_go_on_though_all_owe_for_what_was_told(follows):
    """They tell of it. Else nobody plans with them where each has its part, and they wait until it is paid."""
    budget = DigestBudget(0.0)
    budget.set_rate(1_000.0, 4, 4, follows=follows)
    budget.follow(1.0, splits=True, quiet=False, begins=False, window=0.5)
    budget.heard(1.0, 1_500, 4)
    assert (budget.due(4.0, apart=0.0, copies=4) <= 6.0) is follows


@pytest.mark.parametrize("follows", [True, False])
def test_where_limits_follow_the_channel_nobody_is_silent_for_long_whatever_it_owes(follows):
    """Silence would be taken for a full channel. All together stay within the allowance; elsewhere debts come first."""
    budget = DigestBudget(0.0)
    budget.set_rate(500.0, 5, 5, follows=follows)
    budget.follow(0.0, splits=True, quiet=False, begins=False, window=0.5)
    for tenth in range(10):
        budget.sent(tenth / 10.0, 110, 5)
    told = [0.9]
    while (due := budget.due(told[-1] + 0.1, apart=0.0, copies=5)) < 100.0:
        budget.sent(due, 110, 5)
        told.append(due)
    assert (len(told) > 5 and told[1] < 15.0) is follows
    assert (len(told) - 1) * 5 * (110 + OVERHEAD) * 5 <= 500.0 * 100.0


def test_the_first_agreement_may_take_what_was_saved():
    """Until the team has begun; what is left of it is not spent later."""
    budget = budget_of(1000.0, robots=10, saved=15.0)
    budget.follow(0.0, splits=True, quiet=False, begins=True, window=2.0)
    for _ in range(20):
        assert budget.due_ahead(0.0, 0.0) == 0.0
        budget.sent(0.0, SIZE, 9, announces=True)
    budget.follow(5.0, splits=True, quiet=False, begins=False, window=2.0)
    budget.sent(5.0, SIZE, 9, announces=True)
    assert budget.due_ahead(5.0, 0.0) > 5.0


def test_what_was_saved_for_the_beginning_is_still_there_however_late_that_is():
    """What a team tells while nobody sends anything comes back."""
    budget = budget_of(1000.0, robots=10, saved=15.0)
    budget.follow(0.0, splits=False, quiet=False, begins=True, window=2.0)
    for second in range(60):
        budget.heard(float(second), SIZE, 9)
    assert budget.due_ahead(60.0, -14.0) == 60.0
    budget.heard(60.0, SIZE, 9)
    assert budget.due_ahead(60.0, 0.0) == 60.0
    assert budget.due_soon(60.0) > 60.0


def test_who_waits_for_room_waits_on_while_others_tell():
    """It waits no less as the allowance of all is used up: five of eight robots told then at one moment."""
    budget = budget_of(1000.0, robots=4)
    budget.follow(0.0, splits=False, quiet=False, begins=False, window=0.5)
    budget.due(10.0, apart=0.0, copies=3)
    budget.sent(10.0, 300, 3)
    affordable = next(t for t in map(float, np.arange(10.0, 40.0, 0.01)) if budget.due(t, apart=0.0, copies=3) <= t)
    budget.heard(affordable, 450, 1)
    budget.heard(affordable + 0.2, 4000, 1)
    assert affordable + 0.5 < budget.due(affordable + 0.2, apart=0.0, copies=3) <= affordable + 1.0


def test_two_that_wait_for_the_same_room_do_not_take_it_at_one_moment():
    """Though others tell something meanwhile, and all look again when the room is there."""
    due = []
    for turn in (0.2, 0.7):
        budget = budget_of(1000.0, robots=4, turn=turn)
        budget.follow(10.0, splits=False, quiet=False, begins=False, window=0.5)
        budget.sent(10.0, 33, 3, announces=True)
        budget.heard(10.0, 300, 1)
        budget.heard(10.3, 20, 1)
        moments = map(float, np.arange(10.3, 12.0, 0.001))
        due.append(next(t for t in moments if budget.due_in_turn(t, -math.inf, 0.5, 3) <= t))
    assert 10.5 < due[0] < due[1] - 0.05


@given(st.lists(st.floats(0.0, 0.6), min_size=1, max_size=60), st.integers(20, 90))
def test_where_each_has_its_part_no_window_holds_more_than_its_allowance(pauses, size):
    """Of news of parts and of ordinary ones together: parts leave the limit no more than that."""
    budget, now, window, told = budget_of(1000.0, robots=4, turn=0.3), 10.0, 2.0, []
    budget.follow(now, splits=True, quiet=False, begins=False, window=window)
    budget.sent(now, size, 3)
    budget.heard(now, size, 3)
    told += [(now, (size + OVERHEAD) * 3)] * 2
    for place, pause in enumerate(pauses):
        now += pause
        aside = place % 2 == 0
        due = budget.due_in_turn(now, -math.inf, 5.0, 3) if aside else budget.due(now, apart=0.0, copies=3)
        if due <= now:
            budget.sent(now, size, 3, announces=aside)
            told.append((now, (size + OVERHEAD) * 3))
        assert sum(cost for t, cost in told if t > now - window) <= 1000.0 * window


def test_where_robots_announce_ordinary_news_wait_until_the_window_has_room_for_them():
    """Not for ever: who announces much does not take the place of all other news. Announcements do not wait."""
    budget = budget_of(1000.0, robots=4)
    budget.follow(0.0, splits=False, quiet=False, begins=False, window=0.5)
    assert budget.due(10.0, apart=0.0, copies=3) == 10.0
    for k in range(60):
        budget.heard(10.0 + 0.1 * k, 68, 1)
    assert budget.due_ahead(16.0, 5.0) == 16.0
    assert budget.due(16.0, apart=0.0, copies=3) == 16.0
    budget.sent(16.0, SIZE, 3)
    budget.heard(16.0, 300, 1)
    assert 16.0 < budget.due(16.0, apart=0.0, copies=3) <= 16.0 + 2.0 * TUNING.slowest_digest


def test_who_could_afford_nothing_for_long_waits_for_room_all_the_same():
    """One short window at most: else all that may tell something do at one moment."""
    budget = budget_of(1000.0, robots=4)
    budget.follow(0.0, splits=False, quiet=False, begins=False, window=0.5)
    budget.due(10.0, apart=0.0, copies=3)
    budget.sent(10.0, 300, 3)
    affordable = next(t for t in map(float, np.arange(10.0, 40.0, 0.01)) if budget.due(t, apart=0.0, copies=3) <= t)
    assert affordable > 10.0 + 2.0 * TUNING.slowest_digest
    budget.heard(affordable, 450, 1)
    assert affordable < budget.due(affordable, apart=0.0, copies=3) <= affordable + 2.0 * 0.5


def test_robots_with_news_of_parts_do_not_speak_at_one_moment():
    """Each waits for a bit more of the allowance than the last one."""
    due = []
    for turn in (0.0, 0.4, 0.8):
        budget = budget_of(1000.0, robots=4, turn=turn)
        budget.follow(0.0, splits=True, quiet=False, begins=False, window=2.0)
        budget.heard(0.0, 400, 3)
        due.append(budget.due_in_turn(0.0, -math.inf, 0.5, 3))
    assert due == sorted(set(due))


def test_news_of_parts_cost_what_such_news_take():
    """However much the last digest took that told all: two in each window go beside it, not one in two."""
    budget = budget_of(1000.0, robots=4)
    budget.follow(0.0, splits=True, quiet=False, begins=False, window=0.5)
    budget.sent(0.0, 150, 4)
    budget.sent(0.0, 30, 4, announces=True)
    assert budget.due_in_turn(10.0, -math.inf, 0.5, 4) == 10.0
    budget.heard(10.0, 30, 4)
    assert budget.due_in_turn(10.0, -math.inf, 0.5, 4) == 10.0


def test_slots_are_passed_on_while_the_first_agreement_is_paid_for():
    """Half of the allowance is left for that; else nobody would for as long as debts last."""
    budget = budget_of(1000.0, robots=4)
    budget.follow(0.0, splits=True, quiet=False, begins=False, window=0.5)
    budget.sent(0.0, 40, 4, announces=True)
    for _ in range(100):
        budget.heard(0.0, 85, 1)
    assert budget.due_ahead(0.0, 0.5) > 5.0
    cost, told = (40 + OVERHEAD) * 4, [0.0]
    while told[-1] < 4.0:
        told.append(budget.due_with_parts(told[-1], 0.5))
        assert budget.due_in_turn(told[-2], -math.inf, 0.5, 4) <= told[-1] + cost / 1000.0
        budget.heard(told[-1], 40, 4)
    rates = [cost / (later - earlier) for earlier, later in pairwise(told[1:])]
    assert all(0.3 * 1000.0 < rate <= TUNING.parts_in_debt * 1000.0 + 1e-6 for rate in rates)


def test_digests_that_go_to_all_at_once_are_paid_for_once():
    """On the air a newcomer has what one digest takes, not one for each robot."""
    spent = {}
    for copies in (1, 50):
        budget, now = DigestBudget(0.0), 0.0
        budget.set_rate(5_000.0, 51, copies)
        spent[copies] = 0
        while now < 5.0:
            if budget.due(now, apart=0.0, copies=copies) <= now:
                budget.sent(now, 200, copies)
                spent[copies] += (200 + OVERHEAD) * copies
            now += 0.01
    assert spent[1] <= 5.0 * 5_000.0 / 51 + 4 * (200 + OVERHEAD)


def test_a_large_team_tells_in_turn():
    """Of fifty that begin to split at one moment no two tell at once."""
    due = []
    for number in range(50):
        budget = DigestBudget(0.0, number / 50)
        budget.set_rate(5_000.0, 50, 49)
        budget.follow(0.0, splits=True, quiet=True, begins=False, window=0.5)
        due.append(budget.due(0.0, apart=0.0, copies=49))
    assert min(after - before for before, after in pairwise(sorted(due))) > 0.5


def test_robots_that_answer_one_do_so_within_the_allowance():
    """One after the other, in the time that it has room for all; who passes a slot on does not wait."""
    due, cost = [], 4 * (SIZE + OVERHEAD)
    for number in range(10):
        budget = budget_of(1_000.0, robots=10, turn=number / 10)
        budget.follow(0.0, splits=True, quiet=False, begins=False, window=2.0)
        budget.sent(0.0, SIZE, 4, announces=True)
        due.append(budget.due_in_turn(20.0, 20.0, 0.5, 4) - 20.0)
        assert budget.due_in_turn(20.0, -math.inf, 0.5, 4) == 20.0
    late = sorted(due)
    assert min(after - before for before, after in pairwise(late)) > cost / 1_000.0
    assert late[-1] - late[0] < 2.0 * 10 * cost / 1_000.0


WINDOW = 1.0


@given(
    st.lists(st.tuples(st.integers(1, 600).map(lambda n: n / 1024), st.integers(1, 300)), max_size=40),
    st.integers(0, 2048).map(lambda n: n / 1024),
    st.integers(0, 600),
)
def test_it_says_how_much_is_in_a_window_and_since_when_there_is_room(told, later, room):
    """As adding it all up says: the last moment from which on no window holds more."""
    recent, now, all_of_it = RecentBytes(), 0.0, []
    for pause, amount in told:
        now += pause
        recent.advance(now, WINDOW)
        recent.add(now, amount)
        all_of_it.append((now, amount))
        assert recent.total == sum(amount for t, amount in all_of_it if t >= now - WINDOW)

    def until(end):
        """What a window holds that ends just before this moment."""
        return sum(amount for t, amount in all_of_it if end - WINDOW <= t <= end)

    now += later
    recent.advance(now, WINDOW)
    full = [t + WINDOW for t, _ in all_of_it if until(t + WINDOW) > room]
    since = recent.fits_since(WINDOW, room)
    assert since == max(full, default=-math.inf) or max(since, *full) < now


@pytest.fixture
def budget():
    """Of ten robots that may tell each other 1,000 B/s, with nothing saved."""
    made = StateBudget(0.0)
    made.set_rate(1000.0, 10)
    return made


def test_what_went_out_is_paid_for_in_time(budget):
    """With the part for states of the part of this robot; what is more than may be saved is lost."""
    assert budget.paid_in == 0.0
    budget.owe(500 - TUNING.overhead, 2)
    assert budget.paid_in == pytest.approx(1000.0 / (TUNING.states * 100.0))
    assert budget.takes(500 - TUNING.overhead, 2) == budget.paid_in
    budget.gain(5.0)
    assert budget.paid_in == pytest.approx(1000.0 / (TUNING.states * 100.0) - 5.0)
    budget.gain(1000.0)
    saved = TUNING.state_savings * TUNING.states * 100.0
    budget.owe(round(saved) - TUNING.overhead, 1)
    assert budget.paid_in == 0.0


def test_a_flood_of_questions_is_paid_for_within_a_minute(budget):
    """However many there were: a robot tells its state again then."""
    for _ in range(3000):
        budget.owe(2000, 1)
    assert budget.paid_in == pytest.approx(TUNING.deepest_state_debt)
    assert budget.paid_in < 60.0


def test_questions_of_all_robots_take_the_whole_allowance(budget):
    """Each with its answer."""
    assert budget.question_takes() == pytest.approx(10 * (TUNING.question + TUNING.answer) / 1000.0)


def allowed(rate, robots=1):
    made = DigestBudget(0.0)
    made.set_rate(rate, robots, robots)
    return made


def echo(peer):
    return Echo(peer, 0.0, 0.0, 0, 0.0)


def echoed(budget, now, echoes, copies):
    """What is echoed now of all that could be."""
    budget.advance(now)
    return budget.echoes.take(now, echoes, copies, 0)


def test_each_peer_is_echoed_about_once_a_second():
    """If the allowance is large."""
    budget = allowed(1e6)
    assert [e.peer for e in echoed(budget, 1.0, [echo("a"), echo("b")], 2)] == ["a", "b"]
    assert echoed(budget, 1.9, [echo("a")], 2) == ()
    assert {e.peer for e in echoed(budget, 2.0, [echo("a"), echo("b")], 2)} == {"a", "b"}


def test_of_many_peers_a_few_are_echoed_in_turn():
    """As many as a digest holds, and as a quarter of the allowance pays for."""
    peers = [echo(f"p{number:02}") for number in range(40)]
    budget = allowed(1e6)
    told = [e.peer for now in (1.0, 1.1, 1.2, 1.3, 1.4) for e in echoed(budget, now, peers, 40)]
    assert told == [e.peer for e in peers]
    assert len(told) == 5 * TUNING.echoed
    poor = allowed(100.0)
    told = [e.peer for now in range(1, 101) for e in echoed(poor, float(now), peers[:4], 4)]
    assert 100.0 * 100.0 / 4.0 * 0.8 <= len(told) * 23 * 4 - TUNING.echoes_ahead <= 100.0 * 100.0 / 4.0 * 1.1
    assert all(abs(told.count(e.peer) - len(told) / 4) <= 1 for e in peers[:4])
    broadcast = allowed(100.0)
    assert len([e for now in range(1, 101) for e in echoed(broadcast, float(now), peers[:4], 1)]) > 3 * len(told)


def test_a_digest_takes_no_more_than_a_window_holds_for_the_sake_of_echoes():
    """But for one; where limits follow the channel, or what was saved is there, as many go as are paid for."""
    peers = [echo(f"p{number}") for number in range(8)]

    def told(size, *, follows=False, saved=0.0):
        budget = DigestBudget(0.0, saved=saved)
        budget.set_rate(1e5, 5, 5, follows=follows)
        budget.follow(0.1, splits=False, quiet=False, begins=saved > 0.0, window=0.005)
        return len(budget.echoes.take(0.1, peers, 4, size))

    assert told(30) == 3
    assert told(90) == told(300) == 1
    assert told(300, follows=True) == told(300, saved=1.0) == 8


def test_a_robot_that_begins_has_room_for_a_few_echoes():
    """Before it knows how many there are, too: without any nobody knows how long the way is."""
    budget = DigestBudget(0.0)
    budget.advance(0.1)
    budget.set_rate(1_000.0, 11, 11)
    budget.advance(0.2)
    assert budget.echoes.affords(10) == 2


@pytest.mark.parametrize("splits", [False, True])
@pytest.mark.parametrize(
    "due",
    [
        lambda budget, now: budget.due(now, apart=0.0, copies=4),
        lambda budget, now: budget.due_in_turn(now, -math.inf, 0.5, 4),
        lambda budget, now: budget.due_ahead(now, AHEAD),
    ],
    ids=["news", "parts", "announcements"],
)
def test_who_says_too_much_silences_nobody_for_good(splits, due):
    """However much one robot says: what we have to say goes out, whatever it is."""
    budget, said = budget_of(1000.0, robots=4), []
    budget.follow(0.0, splits=splits, quiet=False, begins=False, window=0.5)
    for step in range(6000):
        now = step / 20
        budget.heard(now, 60, 4)
        if due(budget, now) <= now:
            said.append(now)
            budget.sent(now, 60, 4)
    assert len(said) >= 3
    assert said[-1] > 200.0


@pytest.mark.parametrize("size", [60, 300])
def test_a_team_that_always_has_news_of_parts_stays_within_its_allowance(size):
    """However much larger these are than the last ordinary news: nobody waits for the others any less for it."""
    rate, copies, seconds, spent = 2000.0, 3, 60, 0
    team = [budget_of(rate, robots=4, turn=turn) for turn in (0.0, 0.25, 0.5, 0.75)]
    for each in team:
        each.follow(0.0, splits=True, quiet=False, begins=False, window=0.5)
    for step in range(100 * seconds):
        now = step / 100
        for each in team:
            if each.due_in_turn(now, -math.inf, 0.5, copies) <= now:
                each.sent(now, size, copies, announces=True)
                spent += (size + OVERHEAD) * copies
                for other in team:
                    if other is not each:
                        other.heard(now, size, copies)
    assert 0.9 <= spent / (rate * seconds) <= 1.1
