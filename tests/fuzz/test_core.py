"""Whatever is said on Sendworthy's keys, the core goes on: nothing raises, nothing grows, honest robots stay known."""

import msgpack
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule

from proxy.core.interface import events as ev
from proxy.core.model.mode import Mode
from proxy.core.protocol.digest_codec import unpack_digest
from proxy.core.protocol.envelope import VERSION, MalformedWireError
from proxy.core.protocol.messages import tag
from proxy.core.protocol.state_codec import unpack_state
from tests.fuzz.hostile import HONEST, KEY, Besieged
from tests.fuzz.target import specs
from utility_specs import Specs

SPECS = specs()
ZIDS = st.one_of(
    st.sampled_from(("eeeeeeee01", "eeeeeeee02", "ffffffff01", "0000000001", "00000000ff")),
    st.integers(0, 2**40).map(lambda number: f"b{number:011x}"),
)
NAMES = st.sampled_from(("evil", "honest", "r1", "", "x" * 1000, "evil-eeee"))
KEYS = st.one_of(
    st.sampled_from((KEY, "robot/r1/camera", "robot/x/camera", "other", "a//b", "\x00", "robot/x/camera/")),
    st.integers(0, 10_000).map(lambda number: f"robot/{number}/camera"),
)
EXPRESSIONS = st.sampled_from(("robot/*/camera", "**", "robot/$*/camera", "@v/**", "a//b", "", KEY))
COUNTS = st.one_of(st.integers(0, 50), st.sampled_from((2**16, 2**31, 2**40, 2**50, 2**53)))
TICKS = st.one_of(st.integers(-100, 10**6), st.sampled_from((10**9, -(10**9), 10**14, -(10**14))))
VALUES = st.one_of(st.integers(0, 65_535), st.floats(width=32))
ANY = st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=5), st.binary(max_size=5))
STREAM = st.tuples(st.integers(0, 2000), COUNTS, COUNTS, TICKS, TICKS, COUNTS, VALUES).map(list)
TAGS = st.sampled_from((0xAAAAAAAA, 0, 0xEEEEEEEE, "zz"))
MILD_STREAM = st.tuples(
    *(st.integers(0, 20), st.integers(5, 60), st.integers(0, 5), st.integers(0, 50_000), st.integers(-9, 9)),
    *(st.integers(0, 9000), st.integers(0, 65_535)),
).map(list)
MILD = st.tuples(
    *(st.just(VERSION), st.just(0), st.integers(0, 9), st.integers(0, 9), st.integers(0, 99)),
    st.lists(MILD_STREAM, max_size=30),
).map(list)
WILD = st.tuples(
    *(st.just(VERSION), TICKS, COUNTS, COUNTS, COUNTS),
    st.lists(st.one_of(STREAM, ANY), max_size=40),
    st.lists(st.tuples(TAGS, st.integers(0, 65_535), TICKS, COUNTS, VALUES, VALUES), max_size=3).map(
        lambda echoes: [f for e in echoes for f in e]
    ),
    st.lists(VALUES, max_size=2),
    st.one_of(st.just([]), st.just([1]), ANY),
).map(list)
BRIEF = st.tuples(
    *(st.just(VERSION), st.one_of(st.just(0), TICKS), st.integers(0, 9)),
    st.lists(st.one_of(st.sampled_from((5, 6, 7)).flatmap(lambda n: MILD_STREAM.map(lambda s: s[:n])), STREAM, ANY)),
).map(list)
"""An announcement, or something like it."""
STREAM_STATE = st.tuples(
    st.integers(0, 2000), KEYS, st.sampled_from(("camera", "x")), VALUES, VALUES, COUNTS, st.just("periodic")
).map(list)


class Siege(RuleBasedStateMachine):
    """Arbitrary sequences of honest and hostile events."""

    @initialize(coordination=st.sampled_from(("announce", "split")))
    def begin(self, coordination):
        self.core = Besieged(SPECS, coordination)
        self.tokens = [("eeeeeeee01", "evil")]
        self.core.act(ev.PeerAppeared(0.0, "evil", "eeeeeeee01"))

    def hear(self, zid, robot, fields, *, unpack, make):
        name = tag(zid)
        if name == tag(HONEST):
            return
        try:
            heard = unpack(msgpack.packb(fields), robot, name)
        except (MalformedWireError, OverflowError):
            self.core.act(ev.MalformedHeard(self.core.now, robot))
        else:
            self.core.act(make(self.core.now, heard))

    @rule(zid=ZIDS, robot=NAMES)
    def a_token_appears(self, zid, robot):
        self.tokens.append((zid, robot))
        self.core.act(ev.PeerAppeared(self.core.now, robot, zid))

    @rule(data=st.data())
    def a_token_vanishes(self, data):
        zid, robot = data.draw(st.one_of(st.sampled_from(self.tokens), st.just((HONEST[:-1] + "2", "honest"))))
        self.core.act(ev.PeerGone(self.core.now, robot, zid))

    @rule(
        data=st.data(),
        other=st.one_of(st.none(), st.none(), NAMES),
        fields=st.one_of(MILD, WILD, BRIEF),
        now=st.booleans(),
    )
    def a_digest_comes(self, data, other, fields, now):
        zid, robot = data.draw(st.sampled_from(self.tokens))
        robot = robot if other is None else other
        if now or fields[1] == 0:
            fields = [fields[0], round(self.core.now * 1e4), *fields[2:]]
        self.hear(zid, robot, fields, unpack=unpack_digest, make=ev.DigestHeard)

    @rule(
        data=st.data(),
        other=st.one_of(st.none(), st.none(), NAMES),
        number=COUNTS,
        since=st.sampled_from((0, 0, 1, 2**53)),
        streams=st.one_of(
            st.lists(STREAM_STATE, max_size=5),
            st.lists(st.tuples(st.integers(0, 20), KEYS, st.just("camera")), max_size=20, unique_by=lambda s: s[0]),
        ),
        subscriptions=st.lists(EXPRESSIONS, max_size=5),
        origins=st.lists(st.one_of(st.just(HONEST), st.just("0000000001"), ZIDS), max_size=5),
    )
    def a_state_comes(self, data, other, *, number, since, streams, subscriptions, origins):
        zid, robot = data.draw(st.sampled_from(self.tokens))
        robot = robot if other is None else other
        rest = ["enforce", "s", 10**13, "broadcast x", subscriptions, origins]
        fields = [VERSION, zid, number, since, streams, *rest]
        self.hear(zid, robot, fields, unpack=lambda data, robot, _: unpack_state(data, robot), make=ev.StateHeard)

    @rule(key=KEYS, origin=st.one_of(st.none(), ZIDS), stamp=st.one_of(st.none(), st.floats(0, 1e10)), size=COUNTS)
    def a_sample_is_heard(self, key, origin, stamp, size):
        self.core.act(ev.SampleHeard(self.core.now, key, size, origin, stamp, None))

    @rule(key=KEYS, size=st.integers(0, 10**6), superseded=st.integers(0, 2), delete=st.booleans(), origin=ZIDS)
    def an_app_publishes(self, key, size, superseded, delete, origin):
        del origin
        self.core.publish(key, size, superseded=superseded, delete=delete)

    @rule(send=st.booleans())
    def the_worker_answers(self, send):
        self.core.decide(send=send)

    @rule()
    def the_driver_reads_again(self):
        self.core.read()

    @rule(seconds=st.sampled_from((0.001, 0.3, 2.0, 15.0, 200.0)))
    def time_passes(self, seconds):
        self.core.pass_time(seconds)

    @rule()
    def the_honest_robot_speaks(self):
        self.core.speak()

    @rule(key=KEYS, matching=st.booleans())
    def demand_changes(self, key, matching):
        self.core.act(ev.MatchingChanged(self.core.now, key, matching))

    @rule(keys=st.lists(EXPRESSIONS, max_size=3), mode=st.sampled_from(Mode))
    def the_operator_and_the_apps_do_things(self, keys, mode):
        self.core.act(ev.InterestChanged(self.core.now, tuple(keys)))
        self.core.act(ev.ModeChanged(self.core.now, mode))
        self.core.act(ev.StateAsked(self.core.now))
        self.core.act(ev.SpecsChanged(self.core.now, SPECS))

    @invariant()
    def what_must_hold_holds(self):
        if hasattr(self, "core"):
            self.core.check()

    def teardown(self):
        if hasattr(self, "core"):
            self.core.finish()


TestSiege = Siege.TestCase
TestSiege.settings = settings(max_examples=settings().max_examples // 4, stateful_step_count=25, deadline=None)


def test_without_specs_nothing_is_kept_of_strangers():
    """What no type covers has no stream."""
    core = Besieged(SPECS)
    core.act(ev.SpecsChanged(core.now, Specs.empty()))
    core.act(ev.SampleHeard(core.now, "robot/x/camera", 10, "feed", None, None))
    assert list(core.core.view.streams) == []


def test_a_flood_of_robots_leaves_the_honest_one():
    """Tokens, origins and digests of thousands."""
    core = Besieged(SPECS)
    for number in range(600):
        zid = f"b{number:011x}"
        core.act(ev.PeerAppeared(core.now, "evil", zid))
        core.act(ev.SampleHeard(core.now, f"robot/{number}/camera", 10, f"plain{number}", None, None))
    core.finish()
