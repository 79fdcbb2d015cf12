"""Three robots, real sessions: who hears what, how often, and unchanged."""

import zenoh

from proxy.bridge.sample import origin_of
from proxy.core.interface.events import SampleHanded, SampleHeard, SampleRefused, SamplesPassed
from proxy.core.model.mode import Mode
from tests.proxy.bridge.robots import fence, observes, wait_interest
from tests.proxy.nodes import Heard, closing, plain_session, wait_matching
from tests.waiting import wait_until


def everywhere(team, key):
    """An app on each robot that subscribes to `key`, known to all the others."""
    apps = [robot.node() for robot in team]
    heard = [Heard(app, key) for app in apps]
    for robot in team:
        wait_interest(robot, *(other for other in team if other is not robot), keys=(key,))
    return apps, heard


def test_every_sample_arrives_exactly_once_everywhere(team):
    """With three robots and nobody deciding anything, each app hears each app exactly once, in order."""
    apps, heard = everywhere(team, "free/**")
    for i in range(20):
        for n, app in enumerate(apps):
            app.put(f"free/{n}", f"{n}:{i}", congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: all(len(h.samples) >= 60 for h in heard), what="60 samples on each robot")
    for app in apps:
        app.put("free/end", "end")
    wait_until(lambda: all(h.payloads.count("end") == 3 for h in heard), what="the last samples")
    for h in heard:
        for n in range(3):
            assert [p for p in h.payloads if p.startswith(f"{n}:")] == [f"{n}:{i}" for i in range(20)]


def test_overlapping_subscriptions_deliver_once_each(team):
    """An app with overlapping subscriptions gets a sample from the mesh once per subscription, as from a router."""
    app = team[0].node()
    expressions = ("over/a", "over/*", "over/**", "*/a")
    heard = [Heard(app, expression) for expression in expressions]
    wait_interest(team[0], team[1], keys=expressions)
    other = team[1].node()
    for i in range(10):
        other.put("over/a", str(i), congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: all(len(h.samples) >= 10 for h in heard), what="ten samples per subscription")
    heard[1].subscriber.undeclare()
    wait_until(lambda: "over/*" not in team[0].bridge.describe()["subscriptions"], what="the undeclaration")
    fence(team[0], team[1])
    other.put("over/a", "last", congestion_control=zenoh.CongestionControl.BLOCK)
    remaining = (heard[0], heard[2], heard[3])
    wait_until(lambda: all("last" in h.payloads for h in remaining), what="the last sample")
    assert all(h.payloads == [*map(str, range(10)), "last"] for h in remaining)


def test_attributes_of_a_put_are_preserved(pair):
    """Key, payload, encoding, schema, attachment, priority, congestion control, express, timestamp, source."""
    heard = Heard(pair[1].node(), "free/all")
    wait_interest(pair[1], pair[0], keys=("free/all",))
    app = pair[0].node()
    stamp = pair[0].node().new_timestamp()  # of somebody else: who numbers and stamps is another matter
    source = zenoh.SourceInfo(app.id, 7)
    app.put(
        "free/all",
        b"\x00\xffpayload",
        encoding=zenoh.Encoding.IMAGE_JPEG.with_schema("mono"),
        attachment=b"\x01attached",
        priority=zenoh.Priority.INTERACTIVE_HIGH,
        congestion_control=zenoh.CongestionControl.BLOCK,
        express=True,
        timestamp=stamp,
        source_info=source,
    )
    wait_until(lambda: heard.samples, what="the sample")
    (sample,) = heard.samples
    assert str(sample.key_expr) == "free/all"
    assert bytes(sample.payload) == b"\x00\xffpayload"
    assert str(sample.encoding) == "image/jpeg;mono"
    assert bytes(sample.attachment) == b"\x01attached"
    assert sample.priority == zenoh.Priority.INTERACTIVE_HIGH
    assert sample.congestion_control == zenoh.CongestionControl.BLOCK
    assert sample.express
    assert sample.timestamp == stamp
    assert str(sample.source_info.source_id) == str(source.source_id)
    assert sample.source_info.source_sn == 7


def test_deletes_cross_with_their_attributes(pair):
    """A delete arrives as a delete, with attachment, priority and timestamp."""
    heard = Heard(pair[1].node(), "free/gone")
    wait_interest(pair[1], pair[0], keys=("free/gone",))
    app = pair[0].node()
    stamp = app.new_timestamp()
    app.delete("free/gone", attachment=b"why", priority=zenoh.Priority.DATA_LOW, express=True, timestamp=stamp)
    wait_until(lambda: heard.samples, what="the delete")
    (sample,) = heard.samples
    assert sample.kind == zenoh.SampleKind.DELETE
    assert bytes(sample.attachment) == b"why"
    assert sample.priority == zenoh.Priority.DATA_LOW
    assert sample.express
    assert sample.timestamp == stamp


def test_unstamped_samples_leave_with_the_daemons_timestamp(pair):
    """A sample without timestamp is stamped with the id of the mesh session it leaves by; nothing else is added."""
    heard = Heard(pair[1].node(), "free/plain")
    wait_interest(pair[1], pair[0], keys=("free/plain",))
    pair[0].node().put("free/plain", b"x")
    wait_until(lambda: heard.samples, what="the sample")
    (sample,) = heard.samples
    assert origin_of(sample.timestamp) == str(pair[0].mesh.zid())
    assert sample.attachment is None
    assert sample.source_info is None


def test_dropped_samples_never_reach_the_mesh_but_always_local_apps(team):
    """What the decision drops is heard by apps of the same robot, at once, and by nobody else."""
    publisher, local = team[0].node(), Heard(team[0].node(), "covered/**")
    remote = Heard(team[1].node(), "covered/**")
    wait_interest(team[0], keys=("covered/**",))
    wait_interest(team[1], team[0], keys=("covered/**",))
    for i in range(10):
        publisher.put("covered/a", str(i), congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: len(local.samples) == 10, what="local delivery")
    wait_until(lambda: len(team[0].asked) == 10, what="ten questions")
    assert not remote.samples
    for event in list(team[0].asked):
        if event.sample % 2:
            team[0].bridge.payloads.drop(event.sample)
        else:
            team[0].bridge.forward(event.sample)
    wait_until(lambda: len(team[0].posted(SampleHanded)) == 5, what="five samples handed over")
    wait_until(lambda: len(remote.samples) >= 5, what="the forwarded samples")
    assert [int(p) % 2 for p in remote.payloads] == [1] * 5  # sample numbers start at 1
    assert local.payloads == [str(i) for i in range(10)]
    assert team[0].bridge.describe()["held"] == 0


def test_a_covered_sample_is_described_to_the_core(pair):
    """The core learns key, size with attachment, priority, origin and generation time; so does the receiver's core."""
    remote = Heard(pair[1].node(), "covered/b")
    wait_interest(pair[1], pair[0], keys=("covered/b",))
    app = pair[0].node()
    stamp = app.new_timestamp()
    app.put("covered/b", b"12345", priority=zenoh.Priority.DATA_HIGH, timestamp=stamp, attachment=b"why")
    wait_until(lambda: pair[0].asked, what="the question")
    (asked,) = pair[0].asked
    assert pair[0].attachments == [b"why"]
    assert (asked.key, asked.size, asked.priority, asked.delete) == ("covered/b", 8, 4, False)
    assert asked.origin == str(app.zid())
    assert 0.0 <= asked.now - asked.t_gen < 1.0
    pair[0].bridge.forward(asked.sample)
    wait_until(lambda: pair[1].posted(SampleHeard), what="the receiver's core")
    (heard,) = pair[1].posted(SampleHeard)
    assert (heard.key, heard.size, heard.origin) == ("covered/b", 8, str(app.zid()))
    wait_until(lambda: len(remote.samples) == 1, what="the sample")


def test_what_passes_is_counted_with_its_copies(team):
    """Samples no type covers are counted, with the bytes all their copies take on the air."""
    heard = [Heard(robot.node(), "free/**") for robot in team[1:]]
    for robot in team[1:]:
        wait_interest(robot, team[0], keys=("free/**",))
        team[0].bridge.demand.note_robot(str(robot.mesh.zid()), ["free/**"])
    team[0].node().put("free/x", b"12345")
    wait_until(lambda: all(h.samples for h in heard), what="both copies")
    wait_until(lambda: team[0].posted(SamplesPassed), what="the count")
    (passed,) = team[0].posted(SamplesPassed)
    assert (passed.reason, passed.count, passed.size) == ("passed:no-spec", 1, 10)


def test_in_mode_pass_covered_samples_pass_undecided(pair):
    """After a switch to `pass` nobody is asked, and specs swapped in are used from the next sample on."""
    remote = Heard(pair[1].node(), "covered/**")
    wait_interest(pair[1], pair[0], keys=("covered/**",))
    pair[0].switch(Mode.PASS)
    pair[0].node().put("covered/a", b"x")
    wait_until(lambda: remote.samples, what="the sample")
    assert not pair[0].asked
    wait_until(lambda: pair[0].posted(SamplesPassed), what="the count")
    assert pair[0].posted(SamplesPassed)[0].reason == "passed:mode"


def test_forwarding_what_is_not_held_is_refused(pair):
    """A number that is not held (twice forwarded, say) is answered as refused, not ignored."""
    pair[0].bridge.forward(123)
    assert [event.sample for event in pair[0].posted(SampleRefused)] == [123]


def test_a_plain_node_on_the_mesh_hears_and_is_heard(stack, pair):
    """A mesh node without Sendworthy sees ordinary Zenoh: it hears the apps once, and they hear it."""
    plain = closing(stack, plain_session("peer", listen=("tcp/127.0.0.1:0",), connect=(pair[0].mesh_endpoint,)))
    outside, inside = Heard(plain, "free/**"), Heard(pair[0].node(), "free/**")
    wait_until(lambda: observes(pair[0], "free/**"), what="the plain node's subscription")
    wait_matching(plain, "free/from-mesh")
    pair[0].node().put("free/from-app", "app")
    plain.put("free/from-mesh", "mesh")
    wait_until(lambda: len(inside.payloads) >= 2 and "app" in outside.payloads, what="both directions")
    assert sorted(inside.payloads) == ["app", "mesh"]
    assert sorted(outside.payloads) == ["app", "mesh"]


def test_sendworthys_own_keys_are_not_bridged(pair):
    """`@sendworthy/**` of an app stays on its robot."""
    remote, last = Heard(pair[1].node(), "@sendworthy/**"), Heard(pair[1].node(), "free/last")
    wait_interest(pair[1], pair[0], keys=("free/last",))
    app = pair[0].node()
    app.put("@sendworthy/r9/digest", b"forged")
    app.put("free/last", b"x")
    wait_until(lambda: last.samples, what="the sample after it")
    assert "@sendworthy/r9/digest" not in {str(sample.key_expr) for sample in remote.samples}
    assert not any("sendworthy" in key for key in pair[1].bridge.describe()["subscriptions"])


def test_a_closed_bridge_delivers_nothing_more(pair):
    """It hands nothing on, and local apps still hear each other through the router session."""
    local, remote = Heard(pair[0].node(), "free/**"), Heard(pair[1].node(), "free/**")
    for robot, other in (pair, pair[::-1]):
        wait_interest(robot, other, keys=("free/**",))
    pair[0].bridge.close()
    pair[0].node().put("free/after", b"x")
    wait_until(lambda: local.samples, what="local delivery")
    assert not remote.samples
