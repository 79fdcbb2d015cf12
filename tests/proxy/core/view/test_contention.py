"""Which streams compete: always those that a look at every one of them finds."""

from itertools import count

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from proxy.core.interface.events import SampleHeard
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import Digest, State, StreamDigest, StreamState
from proxy.core.view.contention import Contention
from proxy.core.view.stream import Generated, Sent
from proxy.core.view.view import SharedView
from tests.proxy.core.view.met import digest, meet
from utility_specs import load_specs

TEXT = """
[[information_type]]
name = "recent"
keys = ["*/recent"]
utility = { kind = "video" }
[[information_type]]
name = "once"
keys = ["*/once"]
aggregation = "once"
utility = { kind = "video" }
"""
OWN = "r0"
ROBOTS = ("r1", "r2", "r3")
KEYS = ("recent", "once")


@pytest.fixture(scope="module")
def specs(tmp_path_factory):
    path = tmp_path_factory.mktemp("specs") / "spec.toml"
    path.write_text(TEXT)
    return load_specs(path)


class Course:
    """A view in which things happen, one after the other, 0.3 s apart."""

    def __init__(self, specs):
        self.view = SharedView(CoreSettings(OWN, "z-r0", streams=6), specs)
        self.now = 1.0
        self._states = count(1)
        self._counts = count(1)

    def do(self, what, robot, key, number):
        self.now += 0.3
        getattr(self, what)(robot, f"{robot}/{key}", number)

    def come(self, robot, *_):
        self.view.add_peer(self.now, robot, f"z-{robot}")

    def go(self, robot, *_):
        self.view.gone(1.0, f"z-{robot}")

    def state(self, robot, _key, number):
        streams = tuple(StreamState(i, f"{robot}/{name}", name, 0.2 * number) for i, name in enumerate(KEYS))
        wanted = (("*/recent",), ("**",), ())[number % 3]
        transport = ("unicast", "broadcast 224.0.0.1:1")[number % 2]
        number = next(self._states)
        state = State(robot, f"z-{robot}", "enforce", "", streams, wanted, transport=transport, number=number)
        self.view.heard_state(self.now, state)

    def digest(self, robot, key, number):
        made = next(self._counts)
        news = StreamDigest(KEYS.index(key.split("/")[1]), made, made // 2, self.now, self.now, 10 * number, number / 3)
        self.view.heard_digest(self.now, Digest(robot, f"z-{robot}", self.now, 0, 0, (news,)))

    def hear(self, robot, key, number):
        self.view.overhearing.take(SampleHeard(self.now, key, 10 * number, f"z-{robot}", None, None))

    def publish(self, _robot, key, number):
        stream = self.view.streams.touch(self.now, OWN, key)
        stream.note_generated(stream.generated + 1, Generated(self.now, 10 * number, number / 2))

    def send(self, _robot, key, *_):
        stream = self.view.streams.touch(self.now, OWN, key)
        self.view.traffic.note_sent(stream, stream.forwarded + 1, Sent(self.now, self.now, 10, 1.0))

    def miss(self, robot, *_):
        for stream in self.view.streams.own():
            stream.miss((f"z-{robot}",))

    def match(self, _robot, key, number):
        self.view.streams.match(key, matching=number % 2 == 0)

    def want(self, _robot, _key, number):
        self.view.subscribers.set_own((("**",), ())[number % 2])

    def wait(self, _robot, _key, number):
        self.now += 3.0 * number


DEEDS = [name for name in vars(Course) if name != "do" and not name.startswith("_")]
deeds = st.tuples(st.sampled_from(DEEDS), st.sampled_from(ROBOTS), st.sampled_from(KEYS), st.integers(1, 5))


def contention_of(view):
    """One of its own, that has not looked yet."""
    return Contention(view.streams, view.subscribers, view.staleness)


def competing(view, now):
    """Every stream, looked at now."""
    return sorted((s for s in view.streams if view.contention.competes(now, s)), key=lambda s: (s.robot, s.key))


def chosen(view, now, most):
    """By the definition: half of the places for what is worth most, half for what comes next."""
    found = competing(view, now)
    if len(found) <= most:
        return found

    def due(stream):
        return max(now, stream.schedule.prospect()[1])

    def worth(stream):
        return (
            stream.last.scale
            * len(view.subscribers.gaining(stream))
            / max(stream.last.size * view.subscribers.copies(stream), 1)
        )

    rated = sorted(found, key=lambda s: (-worth(s), due(s), s.robot, s.key))
    soonest = sorted(rated[most // 2 :], key=lambda s: (due(s), s.robot, s.key))
    return sorted((*rated[: most // 2], *soonest[: most - most // 2]), key=lambda s: (s.robot, s.key))


@settings(max_examples=60, deadline=None)
@given(st.lists(deeds, min_size=5, max_size=50), st.integers(1, 5))
def test_whatever_happened_the_rows_say_what_the_streams_do(specs, happened, most):
    """Nothing that bears on who competes, and on how streams rate, escapes notice."""
    course = Course(specs)
    contention = contention_of(course.view)
    for robot in ROBOTS:
        course.do("come", robot, "recent", 1)
        course.do("state", robot, "recent", 1)
    for deed in happened:
        course.do(*deed)
        assert [id(s) for s in contention.all(course.now)] == [id(s) for s in competing(course.view, course.now)]
        found = contention.chosen(course.now, most)
        assert [(s.robot, s.key) for s in found] == [(s.robot, s.key) for s in chosen(course.view, course.now, most)]
        assert all(s is course.view.streams.known(s.robot, s.key) for s in found)


def test_nobody_competes_where_there_is_no_stream(specs):
    """An empty view has no rows."""
    assert contention_of(SharedView(CoreSettings(OWN, "z-r0"), specs)).chosen(0.0, 5) == []


def test_a_stream_without_a_period_comes_last(specs):
    """Of one that was seen once nobody knows when it comes again; more places are for those of which it is known."""
    course = Course(specs)
    course.do("come", "r1", "recent", 1)
    course.do("state", "r1", "recent", 4)
    for robot in ("r1", "r2", "r1", "r2", "r1", "r2", "r3"):
        course.do("publish", robot, "recent", 2)
    for robot in ROBOTS:
        course.do("match", robot, "recent", 2)
    contention = contention_of(course.view)
    assert [s.key for s in contention.chosen(course.now, 3)] == ["r1/recent", "r2/recent", "r3/recent"]
    assert [s.key for s in contention.chosen(course.now, 2)] == ["r1/recent", "r2/recent"]


WANTED = [("publish", "r1", "recent", 1), ("publish", "r1", "recent", 1)]
HEARD = [("come", "r1", "recent", 1), ("state", "r1", "recent", 1), ("digest", "r1", "recent", 1)]
ONCE = [("come", "r1", "once", 1), ("state", "r1", "once", 4), *[("publish", "r1", "once", 1)] * 2]


@pytest.mark.parametrize(
    ("key", "before", "deed", "then"),
    [
        ("r1/recent", WANTED, ("match", "r1", "recent", 2), True),
        ("r1/recent", [*WANTED, ("match", "r1", "recent", 2)], ("match", "r1", "recent", 1), False),
        ("r1/once", ONCE, ("send", "r1", "once", 1), False),
        ("r1/once", [*ONCE, ("send", "r1", "once", 1)], ("miss", "r1", "once", 1), True),
        ("r1/once", ONCE, ("go", "r1", "once", 1), False),
        ("r1/recent", HEARD, ("want", "r1", "recent", 2), True),
        (
            "r1/recent",
            [*HEARD, ("want", "r1", "recent", 2), ("wait", "r1", "recent", 5), ("digest", "r1", "once", 1)],
            ("state", "r1", "recent", 31),
            True,
        ),
    ],
)
def test_whether_a_stream_competes_is_looked_at_anew_after_what_makes_the_difference(specs, key, before, deed, then):
    """One deed, between two looks."""
    course = Course(specs)
    for each in before:
        course.do(*each)
    contention = contention_of(course.view)
    assert (key in [s.key for s in contention.chosen(course.now, 5)]) is not then
    course.do(*deed)
    found = contention.chosen(course.now, 5)
    assert found == competing(course.view, course.now)
    assert (key in [s.key for s in found]) is then


def test_a_stream_that_ended_takes_no_part(view):
    """After ten seconds, or four periods, without news."""
    stream = view.streams.touch(0.0, "r1", "robot/r1/camera")
    stream.matching = True
    assert not view.contention.competes(0.0, stream)
    stream.note_generated(1, Generated(0.0, 10, 1.0))
    assert view.contention.competes(9.0, stream)
    assert not view.contention.competes(11.0, stream)
    stream.note_generated(2, Generated(20.0, 10, 1.0))
    assert view.contention.competes(99.0, stream)
    assert not view.contention.competes(100.0, stream)


def test_a_stream_that_is_silent_for_long_by_its_own_measure_competes_no_more(view):
    """As far as its robot's news tell: while there are none, it may well go on."""
    meet(view)
    view.subscribers.set_own(("**",))
    for k in range(1, 12):
        view.heard_digest(100.0 + 0.1 * k, digest(5.0 + 0.1 * k, StreamDigest(7, k, 0, 5.0 + 0.1 * k, 0.0, 10, 2.0)))
    (stream,) = view.streams
    assert view.contention.competes(130.0, stream)
    view.heard_digest(102.2, digest(7.2))
    assert view.contention.competes(130.0, stream)
    view.heard_digest(102.7, digest(7.7))
    assert not view.contention.competes(102.7, stream)
    view.gone(1.0, "z-r2")
    assert list(view.streams) == []


@pytest.mark.parametrize(("aggregation", "first"), [("most_recent", "r2"), ("current", "r1")])
def test_what_a_sample_ends_counts_as_its_worth(tmp_path, aggregation, first):
    """Where a window has places for few: what still shows too much is among them with `current`."""
    path = tmp_path / "spec.toml"
    spec = f'aggregation = "{aggregation}"\nname = "a"\nkeys = ["*/a"]\nutility.kind = "video"\n'
    path.write_text(f"[[information_type]]\n{spec}")
    view = SharedView(CoreSettings("r1", "z-r1"), load_specs(path))
    view.subscribers.set_own(("**",))
    for robot, scale in (("r1", 0.0), ("r2", 1.0), ("r3", 0.5)):
        stream = view.streams.touch(0.0, robot, f"{robot}/a")
        stream.matching = True
        for number in range(10):
            stream.note_generated(number + 1, Generated(0.1 * number, 100, scale))
    view.streams.known("r1", "r1/a").note_sent(1, Sent(0.1, 0.1, 100, 5.0))
    worthiest = view.contention.chosen(0.95, 2)
    assert first in [stream.robot for stream in worthiest]
