"""Samples that are broadcast, on the loopback interface: it carries multicast to other sessions of the host."""

import json
import socket
import threading
from dataclasses import replace
from itertools import count, pairwise
from unittest.mock import Mock, call

import pytest
import zenoh
from hypothesis import given
from hypothesis import strategies as st

from proxy.bridge import broadcast as broadcast_module
from proxy.bridge import keys, radio
from proxy.bridge.broadcast import Broadcast, broadcast_options, pattern
from proxy.bridge.send_buffers import SendBuffers
from proxy.bridge.sessions import zenoh_session
from proxy.bridge.tuning import TUNING
from proxy.core.interface.events import SampleHeard
from proxy.errors import SessionError
from tests.ports import free_port
from tests.proxy.bridge import robots
from tests.proxy.bridge.robots import wait_interest
from tests.proxy.nodes import Heard, closing, pass_fence, plain_session
from tests.waiting import wait_until

LOOPBACK = "lo"


@pytest.fixture
def group():
    """A group that nobody else uses."""
    return f"224.0.0.226:{free_port()}"


@pytest.fixture
def team(stack, tmp_path, group):
    """Three robots that broadcast, each of which hears the other two."""
    made = robots.team(stack, tmp_path, transport="broadcast", group=group, interface=LOOPBACK)
    wait_until(lambda: all(robot.data.describe()["heard"] == 2 for robot in made), what="all on the group")
    return made


def test_digests_are_heard_where_somebody_attends_to_them(stack, group):
    """Of Sendworthy's own keys nothing else is, nor are digests taken for samples."""
    made, heard = opened(stack, group)
    other, told = opened(stack, group)[0], []
    wait_until(lambda: made.describe()["heard"] == 1, what="the other one")
    made.attend(lambda key, sample: told.append((key, sample.payload.to_string())))
    key = keys.digest("r2", "a1b2c3d4")

    def say():
        other.announce(keys.state("r2", "a1b2c3d4"), b"state")
        other.announce(key, b"digest")
        return told

    wait_until(say, what="a digest")
    assert set(told) == {(key, "digest")}
    assert heard == []
    made._reopen("nobody was heard")
    told.clear()
    wait_until(say, what="a digest after the session was opened anew")


def test_nobody_knows_when_what_was_broadcast_has_left(stack, group):
    """So what is decided keeps its pace: of frames in a burst a radio that is full loses some, without a word."""
    made, _ = opened(stack, group)
    buffers = SendBuffers(made)
    assert buffers.clear
    assert not buffers.idle


def opened(stack, group, *, others=False):
    """A broadcast, and what is heard by it."""
    mesh = closing(stack, plain_session("peer"))
    made, heard = Broadcast(group, LOOPBACK, mesh, lambda: others), []
    stack.callback(made.close)
    made.listen(lambda key, sample: heard.append((key, sample.payload.to_string())))
    return made, heard


def test_each_sample_arrives_once_where_it_is_wanted_and_the_core_hears_it_everywhere(team):
    """An app gets what it subscribes to; the core learns of covered samples that no app of its robot wants, too."""
    heard = Heard(team[1].node(), "**")
    wait_interest(team[1], team[0], keys=("**",))
    app = team[0].node()
    for i in range(20):
        app.put("free/a", str(i), congestion_control=zenoh.CongestionControl.BLOCK)
        app.put("covered/a", str(i), congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: len(team[0].asked) == 20, what="the covered ones")
    for asked in team[0].asked:
        team[0].bridge.forward(asked.sample)
    wait_until(lambda: all(len(robot.posted(SampleHeard)) == 20 for robot in team[1:]), what="all overheard")
    wait_until(lambda: len(heard.samples) == 40, what="all delivered")
    for key in ("free/a", "covered/a"):
        assert [s.payload.to_string() for s in heard.samples if str(s.key_expr) == key] == [str(i) for i in range(20)]
    delivered = [0, 40, 0]
    wait_until(lambda: [r.bridge.describe()["delivered"] for r in team] == delivered, what="the count")
    event = team[2].posted(SampleHeard)[0]
    assert (event.key, event.size, event.origin) == ("covered/a", 1, str(team[0].mesh.zid()))


def test_a_sample_keeps_all_that_it_has(team):
    """Also one of many frames, and a delete: by broadcast it arrives as the app published it."""
    heard = Heard(team[1].node(), "free/**")
    wait_interest(team[1], team[0], keys=("free/**",))
    app = team[0].node()
    source = zenoh.SourceInfo(app.id, 7)
    common = {
        "attachment": b"\x01attached",
        "priority": zenoh.Priority.INTERACTIVE_HIGH,
        "congestion_control": zenoh.CongestionControl.BLOCK,
        "express": True,
        "timestamp": team[0].node().new_timestamp(),
        "source_info": source,
    }
    encoding = zenoh.Encoding.IMAGE_JPEG.with_schema("mono")
    app.put("free/all", b"\x00\xff" * 60_000, encoding=encoding, **common)
    app.delete("free/all", **common)
    wait_until(lambda: len(heard.samples) == 2, what="both")
    put, delete = heard.samples
    assert (bytes(put.payload), put.encoding, put.kind) == (b"\x00\xff" * 60_000, encoding, zenoh.SampleKind.PUT)
    assert delete.kind == zenoh.SampleKind.DELETE
    for sample in (put, delete):
        assert str(sample.key_expr) == "free/all"
        assert {name: getattr(sample, name) for name in common if name not in ("attachment", "source_info")} == {
            name: value for name, value in common.items() if name not in ("attachment", "source_info")
        }
        assert bytes(sample.attachment) == b"\x01attached"
        assert str(sample.source_info.source_id) == str(source.source_id)
        assert sample.source_info.source_sn == source.source_sn


def test_what_nobody_wants_is_not_transmitted(stack, team, group):
    """Zenoh would: on a group it knows of no subscribers."""
    listener, heard = opened(stack, group)
    wait_until(lambda: listener.describe()["heard"] == 3, what="the robots")
    app, block = team[0].node(), zenoh.CongestionControl.BLOCK
    app.put("free/a", "before anybody wants it", congestion_control=block)
    pass_fence(app, team[0].app)
    other = Heard(team[1].node(), "free/*")
    wait_interest(team[1], team[0], keys=("free/*",))
    wait_until(lambda: app.put("free/a", "wanted") or ("free/a", "wanted") in heard, what="the sample")
    wait_until(lambda: "wanted" in other.payloads, what="its delivery")
    other.subscriber.undeclare()
    wait_until(lambda: team[0].bridge.demand.silent("free/a"), what="the end of the wish")
    app.put("free/a", "unwanted", congestion_control=block)
    pass_fence(app, team[0].app)
    Heard(team[2].node(), "free/*")
    wait_interest(team[2], team[0], keys=("free/*",))
    wait_until(lambda: app.put("free/a", "wanted again") or ("free/a", "wanted again") in heard, what="the last one")
    assert {payload for key, payload in heard if key == "free/a"} == {"wanted", "wanted again"}


def test_nothing_of_sendworthys_own_is_heard(stack, group):
    """Whoever is on the group can forge; digests, states and presence come by the mesh session only."""
    _, heard = opened(stack, group)
    forger = closing(stack, zenoh_session(broadcast_options(group, LOOPBACK)))
    for prefix in (f"{keys.ON_AIR}/", "", "sendworthy-broadcast-x/"):
        for key in ("@sendworthy/r2/digest", "@sendworthy/r2/state"):
            forger.put(f"{prefix}{key}", "forged")
    forger.put("sendworthy-broadcast-sampling/a", "below a chunk that is like ours")
    wait_until(lambda: forger.put(f"{keys.ON_AIR}/last", "last") or heard, what="the last one")
    assert set(heard) == {("last", "last")}


def test_what_cannot_be_broadcast_goes_by_the_mesh(team):
    """Keys with verbatim chunks that no pattern matches: puts and deletes arrive, each once, where they are wanted."""
    heard = [Heard(robot.node(), "@own/**") for robot in team[1:]]
    for robot in team[1:]:
        wait_interest(robot, team[0], keys=("@own/**",))
    app, block = team[0].node(), zenoh.CongestionControl.BLOCK
    for i in range(5):
        app.put("@own/a", str(i), congestion_control=block)
        app.delete("@own/a", congestion_control=block)
    for each in heard:
        wait_until(lambda each=each: len(each.samples) == 10, what="all of them")
        assert [str(s.key_expr) for s in each.samples] == ["@own/a"] * 10
        assert [s.payload.to_string() for s in each.samples[::2]] == list("01234")
        assert all(s.kind == zenoh.SampleKind.DELETE for s in each.samples[1::2])


def test_a_key_that_is_too_long_for_the_air_goes_by_the_mesh(team):
    """Below the chunk that robots match it would be longer than Zenoh takes, and a panic ended the daemon."""
    longest = "k" * (keys.LONGEST - len("free/"))
    heard = Heard(team[1].node(), "free/*")
    wait_interest(team[1], team[0], keys=("free/*",))
    app, block = team[0].node(), zenoh.CongestionControl.BLOCK
    app.put(f"free/{longest}", "by the mesh", congestion_control=block)
    app.put("free/a", "on the air", congestion_control=block)
    wait_until(lambda: len(heard.samples) == 2, what="both")
    assert set(heard.payloads) == {"by the mesh", "on the air"}


def test_an_interface_that_is_none_is_named_with_its_key(stack, group):
    """The operator learns what to correct."""
    complaint = rf"^mesh\.interface nope, mesh\.group {group}: cannot broadcast: Interface nope not found"
    with pytest.raises(SessionError, match=complaint):
        Broadcast(group, "nope", closing(stack, plain_session("peer")), lambda: False)


def test_an_interface_without_an_address_for_the_group_is_told_what_it_lacks(stack, monkeypatch):
    """Zenoh says only that an argument is invalid."""
    monkeypatch.setattr(broadcast_module, "only_link_local", lambda *_: True)
    complaint = r"cannot broadcast: for a group of IPv6 the interface needs an address that is not link-local$"
    with pytest.raises(SessionError, match=complaint):
        Broadcast("[ff02::226]:7449", "nope", closing(stack, plain_session("peer")), lambda: False)


def test_a_session_that_hears_nobody_although_there_are_others_is_opened_anew(stack, group, monkeypatch, caplog):
    """Zenoh never uses a group again after an error of the radio. An interface that is still gone is said."""
    caplog.set_level("INFO")
    quick = replace(TUNING, group_check=0.01, group_silent=0.02, longest_group_silent=0.05)
    monkeypatch.setattr(broadcast_module, "TUNING", quick)
    first, heard = opened(stack, group, others=True)
    wait_until(lambda: first.describe()["reopened"], what="a first time")
    (silent,) = first.unheard(2)
    assert silent.startswith(
        f"no robot is heard on mesh.group {group}, of 2 that broadcast there: let multicast through"
    )
    assert first.unheard(0) == []
    monkeypatch.setattr(first, "_interface", "nope")
    wait_until(lambda: "nope" in caplog.text, what="the warning")
    monkeypatch.setattr(first, "_interface", LOOPBACK)
    monkeypatch.setattr(broadcast_module, "TUNING", replace(quick, group_silent=5.0, longest_group_silent=5.0))
    second, _ = opened(stack, group)
    wait_until(lambda: second.describe()["heard"] == first.describe()["heard"] == 1, what="each other")
    assert f"nobody was heard on {group}: joined the group anew" in caplog.text
    wait_until(lambda: not first.unheard(2), what="the end of the warning")
    wait_until(lambda: second.put("k", "x") or heard, what="a sample")
    assert heard[0] == ("k", "x")


def test_while_a_session_gives_way_to_a_new_one_no_sample_comes_twice(stack, group, monkeypatch):
    """Where it still hears something, and takes long to close."""
    (first, heard), (second, _) = opened(stack, group), opened(stack, group)
    wait_until(lambda: second.describe()["heard"] == first.describe()["heard"] == 1, what="each other")
    close, numbers = broadcast_module._close, count()

    def late(session):
        wait_until(lambda: second.put("k", str(next(numbers))) or len(heard) >= 20, what="samples that both can hear")
        close(session)

    with monkeypatch.context() as closing_late:
        closing_late.setattr(broadcast_module, "_close", late)
        first._reopen("nobody was heard")
    wait_until(lambda: second.put("k", "next") or ("k", "next") in heard, what="a sample that the new one hears")
    told = [text for _, text in heard if text != "next"]
    assert len(told) == len(set(told))


def test_a_sample_that_meets_a_session_as_it_gives_way_goes_by_the_new_one(stack, group, monkeypatch):
    """An application may be about to publish while the old one is closed. Where none took its place it is an error."""
    (first, _), (second, heard) = opened(stack, group), opened(stack, group)
    wait_until(lambda: second.describe()["heard"] == first.describe()["heard"] == 1, what="each other")
    put, met = zenoh.Session.put, []

    def meet(session, *args, **options):
        met.append(session)
        if len(met) == 1:
            first._reopen("nobody was heard")
        put(session, *args, **options)

    monkeypatch.setattr(zenoh, "Session", Mock(put=meet))
    first.put("k", "x")
    wait_until(lambda: first.put("k", "y") or ("k", "y") in heard, what="what is said on the new session")
    assert met[0].is_closed()
    assert len(set(map(id, met))) == 2
    met[-1].close()
    with pytest.raises(zenoh.ZError, match="session closed"):
        first.put("k", "z")


def test_who_attends_while_a_session_is_opened_anew_hears_each_digest_once(stack, group, monkeypatch):
    """A daemon does as it starts, and a stranger may have closed the first session by then."""
    made, (other, _) = opened(stack, group)[0], opened(stack, group)
    told = []
    attending = threading.Thread(target=made.attend, args=(lambda _, sample: told.append(sample.payload.to_string()),))
    opens_anew = made._opened

    def meet():
        session = opens_anew()
        attending.start()
        return session

    monkeypatch.setattr(made, "_opened", meet)
    made._reopen("nobody was heard")
    attending.join()
    key, numbers = keys.digest("r2", "a1b2c3d4"), count()
    wait_until(lambda: other.announce(key, str(next(numbers)).encode()) or len(told) > 4, what="digests")
    assert len(told) == len(set(told))


@pytest.mark.full
def test_a_session_that_cannot_be_closed_in_time_ends_nothing(stack, group, caplog):
    """An application may hang with a sample of it for longer than Zenoh waits: 10 s. The new one is heard meanwhile."""
    (first, _), (second, _) = opened(stack, group), opened(stack, group)
    taken, go_on, heard = threading.Event(), threading.Event(), []
    stack.callback(go_on.set)
    first.listen(lambda *_: taken.set() or go_on.wait())
    wait_until(lambda: second.put("k", "x") or taken.is_set(), what="a sample in hand")
    first.listen(lambda _, sample: heard.append(sample.payload.to_string()))
    reopening = threading.Thread(target=first._reopen, args=("nobody was heard",))
    reopening.start()
    wait_until(lambda: second.put("k", "y") or "y" in heard, what="a sample on the new session")
    wait_until(lambda: "closes late" in caplog.text, what="the warning")
    reopening.join()


def test_what_is_no_message_of_zenoh_deafens_a_robot_for_a_moment_only(stack, group):
    """Zenoh hears nothing more after it: the session is opened anew at once, however often, and that is a warning."""
    first, heard = opened(stack, group)
    second, _ = opened(stack, group)
    wait_until(lambda: second.describe()["heard"] == first.describe()["heard"] == 1, what="each other")
    assert first.warnings() == []
    stray = stack.enter_context(Stray(group))
    for times in (1, 2):
        stray.send()
        wait_until(lambda times=times: first.describe()["reopened"] == times, what="a session that hears")
    (warning,) = first.warnings()
    assert f"what is no robot sends to mesh.group {group}: 2 times" in warning
    heard.clear()
    wait_until(lambda: second.put("k", "x") or heard, what="a sample")


def test_a_zenoh_node_without_lanes_deafens_a_robot_for_a_moment_only(stack, group):
    """As one in Zenoh's defaults: its samples end the threads that hear the group, and the sockets stay open."""
    first, heard = opened(stack, group)
    second, _ = opened(stack, group)
    options = broadcast_options(group, LOOPBACK)
    del options["transport"]["multicast"]["qos"]
    foreign = closing(stack, zenoh_session(options))
    wait_until(lambda: first.describe()["heard"] == second.describe()["heard"] == 2, what="each other")
    wait_until(lambda: foreign.put("k", "x") or first.describe()["reopened"], what="a session that hears")
    assert f"what is no robot sends to mesh.group {group}: " in first.warnings()[0]
    foreign.close()
    wait_until(lambda: second.put("k", "x") or heard, what="a sample")


def test_who_is_busy_with_a_sample_is_not_taken_for_deaf(stack, group, monkeypatch):
    """An application that hangs may hold up a sample for seconds, and all that come after it."""
    first, _ = opened(stack, group)
    second, _ = opened(stack, group)
    wait_until(lambda: second.describe()["heard"] == 1, what="each other")
    taken, go_on = threading.Event(), threading.Event()
    stack.callback(go_on.set)
    first.listen(lambda *_: taken.set() or go_on.wait())
    wait_until(lambda: second.put("k", "x") or taken.is_set(), what="a sample in hand")
    monkeypatch.setattr(broadcast_module, "TUNING", replace(TUNING, group_check=0.01, group_unread=1))
    asked = Mock(wraps=first._sockets.stuck)
    monkeypatch.setattr(first._sockets, "stuck", asked)
    wait_until(lambda: second.put("k", "x") or asked.call_count > 20, what="some looks")
    assert first.describe()["reopened"] == 0


def test_who_takes_samples_is_not_taken_for_deaf(stack, group, monkeypatch):
    """Where more large ones come than can be read, always as much waits."""
    first, heard = opened(stack, group)
    second, _ = opened(stack, group)
    asked = Mock(return_value=False)
    monkeypatch.setattr(first._sockets, "stuck", asked)
    wait_until(lambda: second.put("k", "x") or heard, what="a sample")
    wait_until(lambda: any(look.kwargs["busy"] for look in asked.call_args_list), what="a look that knows of it")
    asked.reset_mock()
    wait_until(lambda: asked.call_args == call(TUNING.group_unread, busy=False), what="a look when none comes")


def test_a_host_that_sends_nothing_is_not_blamed_on_strangers(stack, group, monkeypatch, caplog):
    """As with its radio off: Zenoh closes the socket then, too. It is opened anew once, when that is over."""
    caplog.set_level("INFO")
    made, _ = opened(stack, group)
    stray = stack.enter_context(Stray(group))
    with monkeypatch.context() as off:
        off.setattr(broadcast_module, "refusal", lambda _, interface: f"{interface} is off")
        wait_until(lambda: stray.send() or made.warnings(), what="a socket that is closed")
        assert made.warnings() == [f"nothing is sent to mesh.group {group}, nor heard: lo is off"]
        assert made.describe()["reopened"] == 0
    joined = f"this host did not send (lo is off) on {group}: joined the group anew"
    wait_until(lambda: joined in caplog.text, what="a session that sends")
    assert made.describe()["reopened"] == 1
    assert made.warnings() == []


def test_a_radio_that_nobody_named_is_kept_as_long_as_it_is_there(stack, group, monkeypatch, caplog):
    """When it is gone one attempt in vain is enough, and strangers are not blamed for each look after it."""
    found = [LOOPBACK]
    monkeypatch.setattr(radio, "multicast_interfaces", lambda: found)
    monkeypatch.setattr(broadcast_module, "TUNING", replace(TUNING, group_check=0.01))
    made = Broadcast(group, "auto", closing(stack, plain_session("peer")), lambda: False)
    stack.callback(made.close)
    stray = stack.enter_context(Stray(group))
    found[:] = ["eth0", LOOPBACK]
    wait_until(lambda: stray.send() or made.describe()["reopened"], what="a session on the same radio")
    found[:] = []
    wait_until(lambda: stray.send() or "there is none" in caplog.text, what="an attempt in vain")
    warnings = made.warnings()
    asked = Mock(wraps=made._sockets.stuck)
    monkeypatch.setattr(made._sockets, "stuck", asked)
    wait_until(lambda: asked.call_count > 20, what="some looks")
    assert made.warnings() == warnings
    assert caplog.text.count("there is none") == 1


def test_a_robot_that_is_deafened_as_its_session_opens_hears_again(stack, group):
    """Its socket is closed before anybody could have found it."""
    first, heard = opened(stack, group)
    second, _ = opened(stack, group)
    wait_until(lambda: second.describe()["heard"] == first.describe()["heard"] == 1, what="each other")
    stray = stack.enter_context(Stray(group))
    for made in (first, second):
        wait_until(lambda made=made: stray.send() or made.describe()["reopened"] > 2, what="sessions deafened at once")
    wait_until(lambda: second.put("k", "x") or heard, what="a sample")


def test_a_forged_declaration_silences_a_robot_for_a_moment_only(stack, group):
    """Zenoh panics at each sample after one of what is no key expression, which ended the daemon."""
    first, heard = opened(stack, group)
    second, answered = opened(stack, group)
    stray = stack.enter_context(Stray(group))
    said = recorded(stack, group, f"{keys.ON_AIR[:-1]}$*/forged")

    def forge():
        for datagram in said:
            stray.send(datagram.replace(b"$*/forged", b"$x/forged").replace(b"\xa1\xb2", b"\xa1\xb3"))
        first.put("k", "lost")
        return first.describe()["reopened"]

    wait_until(forge, what="a session anew")
    heard.clear()
    wait_until(lambda: second.put("k", "x") or ("k", "x") in heard, what="a sample")
    wait_until(lambda: first.put("k", "y") or ("k", "y") in answered, what="another one")


def recorded(stack, group, key):
    """Return what a node says on a group that joins it and declares a subscriber on a key."""
    address, port = group.split(":")
    air = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
    air.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    air.settimeout(60.0)
    air.bind((address, int(port)))
    member = socket.inet_aton(address) + socket.inet_aton("127.0.0.1")
    air.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
    said = []

    def record(part):
        while not said or part not in said[-1][0]:
            said.append(air.recvfrom(65_536))
        return said[-1][1]

    with zenoh_session({**broadcast_options(group, LOOPBACK), "id": "b2a1"}) as node:
        where = record(b"\xa1\xb2")
        node.declare_subscriber(key, zenoh.handlers.Callback(print, indirect=False))
        record(key.encode())
    return [datagram for datagram, at in said if at == where]


class Stray(socket.socket):
    """What is no robot and sends to a group."""

    def __init__(self, group):
        super().__init__(socket.AF_INET, socket.SOCK_DGRAM)
        self.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
        address, port = group.split(":")
        self._group = address, int(port)

    def send(self, datagram=b"x"):
        """Send something; one byte Zenoh cannot decode."""
        self.sendto(datagram, self._group)


def test_options_have_lanes_for_priorities_and_nothing_but_the_group():
    """Zenoh's own reader takes them."""
    config = zenoh.Config.from_json5(json.dumps(broadcast_options("224.0.0.226:7449", "wlan0")))
    assert json.loads(config.get_json("transport/multicast/qos/enabled"))
    assert json.loads(config.get_json("listen/endpoints")) == ["udp/224.0.0.226:7449#iface=wlan0"]
    assert not json.loads(config.get_json("scouting/multicast/enabled"))


BITS = st.integers(0, 2 ** (2 * len(keys.ON_AIR)) - 1)


@given(BITS)
def test_every_pattern_matches_the_prefix(number):
    """Whatever the number, it is a valid key expression."""
    assert zenoh.KeyExpr(pattern(number)).intersects(zenoh.KeyExpr(keys.ON_AIR))


def test_patterns_differ():
    """No two robots may subscribe to the same: Zenoh would repeat it without end."""
    numbers = [(i * 0x9E3779B97F4A7C15F39CC0605CEDC835) % 2 ** (2 * len(keys.ON_AIR)) for i in range(1, 2001)]
    patterns = sorted(map(pattern, numbers))
    assert all(one != other for one, other in pairwise(patterns))
