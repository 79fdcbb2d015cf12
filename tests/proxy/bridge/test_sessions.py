"""Configurations of both sessions, and what happens when one cannot be opened."""

import json
import subprocess
import sys
import threading
from pathlib import Path

import pytest
import zenoh

from proxy.bridge.sessions import MESH_GROUP, app_options, bounded, merged, mesh_options, open_session
from proxy.errors import PortInUseError, SessionError
from tests.proxy.counting import Counting
from tests.proxy.nodes import Heard, closing, free_endpoint, plain_session, wait_matching
from tests.waiting import wait_until


def mesh(listen, connect=(), **changes):
    options = {"scouting": False, "interface": "auto", "zenoh_options": {}} | changes
    return mesh_options([listen], connect, **options)


def test_tables_are_merged_deeply_and_everything_else_is_replaced():
    """The user's tables are laid upon ours key by key; lists and values of theirs replace ours."""
    base = {"a": {"b": 1, "c": {"d": 2}}, "e": [1, 2]}
    assert merged(base, {"a": {"c": {"x": 3}}, "e": [4], "f": 5}) == {
        "a": {"b": 1, "c": {"d": 2, "x": 3}},
        "e": [4],
        "f": 5,
    }
    assert merged(base, {"a": 7}) == {"a": 7, "e": [1, 2]}


@pytest.mark.parametrize(
    ("endpoint", "expected"),
    [
        ("tcp/[::]:7500", "tcp/[::]:7500#so_sndbuf=65536;so_rcvbuf=65536"),
        ("tls/r2:7500#iface=wlan0", "tls/r2:7500#iface=wlan0;so_sndbuf=65536;so_rcvbuf=65536"),
        ("tcp/r2:7500#so_sndbuf=1000", "tcp/r2:7500#so_sndbuf=1000"),
        ("udp/r2:7500", "udp/r2:7500"),
    ],
)
def test_tcp_endpoints_get_small_buffers_unless_they_say_their_own(endpoint, expected):
    """Large socket buffers hide seconds of queue; who names one knows what they do."""
    assert bounded(endpoint) == expected


@pytest.mark.parametrize(
    ("listen", "connect", "protocols"),
    [
        ("tls/0.0.0.0:7500", "tls/r2:7500", ["tls", "unixsock-stream"]),
        ("tls/0.0.0.0:7500", "quic/r2:7500", ["quic", "tls", "unixsock-stream"]),
        ("tls/0.0.0.0:7500", "tcp/r2:7500", None),
        ("tcp/0.0.0.0:7500", "tcp/r2:7500", None),
    ],
)
def test_where_all_endpoints_are_secured_no_other_link_is_made(listen, connect, protocols):
    """Scouting finds whoever answers: a plain node was dialled, heard all, and was heard."""
    options = mesh(listen, [connect], scouting=True)
    config = zenoh.Config.from_json5(json.dumps(options))
    assert options["transport"]["link"].get("protocols") == protocols
    assert json.loads(config.get_json("transport/link/protocols")) == protocols


@pytest.mark.parametrize("scouting", [True, False])
def test_zenoh_accepts_the_options_and_reads_what_is_meant(scouting):
    """Zenoh's own reader takes both configurations; without scouting nothing is connected by itself."""
    zenoh.Config.from_json5(json.dumps(app_options(["tcp/127.0.0.1:7447"], {})))
    options = mesh("tcp/0.0.0.0:7500", ["tcp/r2:7500"], scouting=scouting)
    config = zenoh.Config.from_json5(json.dumps(options))
    multicast = json.loads(config.get_json("scouting/multicast"))
    assert (multicast["enabled"], multicast["address"]) == (scouting, MESH_GROUP)
    gossip = json.loads(config.get_json("scouting/gossip"))
    assert gossip["autoconnect"] == multicast["autoconnect"] == {"peer": ["peer"] if scouting else []}
    assert not json.loads(config.get_json("transport/shared_memory/enabled"))


def mapped():
    """How much shared memory this process has mapped [B]."""
    status = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) << 10 for line in status if line.startswith("RssShmem:"))


LARGE = 200_000
"""Samples of this size go through shared memory where both sides have it [B]."""
MANY = 200
"""So many are published at a time; all of them may go before Zenoh has shared memory ready."""
PUBLISHER = """
import json, sys, zenoh
options = {"mode": "client", "connect": {"endpoints": [sys.argv[1]]}, "scouting": {"multicast": {"enabled": False}}}
with zenoh.open(zenoh.Config.from_json5(json.dumps(options))) as session:
    for _ in sys.stdin:  # a session that closes at once may take the last samples with it
        for _ in range(int(sys.argv[3])):
            session.put("large", bytes(int(sys.argv[2])), congestion_control=zenoh.CongestionControl.BLOCK)
"""


@pytest.mark.parametrize(
    ("options", "stays"), [({}, False), ({"transport": {"shared_memory": {"enabled": True}}}, True)], ids=["off", "on"]
)
def test_nothing_of_an_application_that_published_stays_mapped(stack, options, stays):
    """Its shared memory would stay as long as the daemon runs; who switches it on gets it."""
    endpoint = free_endpoint()
    heard = Heard(closing(stack, open_session(app_options([endpoint], options), "app")), "large")
    before, command = mapped(), [sys.executable, "-c", PUBLISHER, endpoint, str(LARGE), str(MANY)]

    def shared():
        return mapped() - before > 1 << 20

    def published(publisher):
        expected = len(heard.samples) + MANY
        publisher.stdin.write("more\n")
        publisher.stdin.flush()
        wait_until(lambda: len(heard.samples) == expected, what="all samples")
        return shared() or not stays

    for _ in range(2):
        with subprocess.Popen(command, stdin=subprocess.PIPE, text=True) as publisher:
            wait_until(lambda publisher=publisher: published(publisher), what="samples in shared memory")
        assert publisher.returncode == 0
    assert shared() == stays


ALLOWING = {
    "enabled": True,
    "default_permission": "deny",
    "subjects": [{"id": "everybody"}],
    "policies": [{"subjects": ["everybody"], "rules": ["data"]}],
    "rules": [
        {
            "id": "data",
            "permission": "allow",
            "messages": ["put", "declare_subscriber", "declare_queryable", "liveliness_token"],
            "key_exprs": ["**"],
        }
    ],
}


def test_access_control_refuses_what_is_no_key_expression(stack):
    """Without it Zenoh panics at each new key after such a declaration, which ends the daemon."""
    endpoint = free_endpoint()
    robot = closing(stack, open_session(mesh(endpoint, zenoh_options={"access_control": ALLOWING}), "mesh"))
    carried, forged = bytearray(), {b"k$*/forged": b"k$x/forged", b"tok$*en": b"tok$xen"}
    relay = stack.enter_context(Counting(endpoint, taps=carried, replaced=forged))
    forger = closing(stack, plain_session("client", connect=(relay.endpoint,)))
    forger.declare_subscriber("k$*/forged", zenoh.handlers.Callback(print, indirect=False))
    forger.declare_queryable("k$*/forged", zenoh.handlers.Callback(print, indirect=False))
    forger.liveliness().declare_token("tok$*en")
    heard = Heard(forger, "key/**")
    wait_until(lambda: sum(map(carried.count, forged.values())) == 3, what="all that is forged")
    numbers = iter(range(1_000_000))
    wait_until(lambda: robot.put(f"key/{next(numbers)}", "x") or heard.samples, what="a sample of a new key")


def test_the_users_zenoh_options_win(stack):
    """`[mesh.zenoh]` is merged last, as far down as it goes."""
    options = mesh(free_endpoint(), zenoh_options={"transport": {"link": {"tx": {"lease": 5000}}}})
    assert options["transport"]["link"]["tx"]["lease"] == 5000
    assert options["transport"]["link"]["tcp"]["so_sndbuf"] == 65536
    closing(stack, open_session(options, "mesh"))


def test_a_port_in_use_is_said_as_such(stack):
    """The error names the side, the endpoint and what is probably wrong."""
    endpoint = free_endpoint()
    closing(stack, open_session(app_options([endpoint], {}), "app"))
    with pytest.raises(PortInUseError, match=rf"^app\.listen: {endpoint}: port in use; another Zenoh router"):
        open_session(app_options([endpoint], {}), "app")


def test_options_that_zenoh_refuses_are_an_error_of_one_line():
    """An unknown key in `[app.zenoh]` names the side and Zenoh's complaint."""
    with pytest.raises(SessionError, match=r"^app: .*unknown field `wrong`") as raised:
        open_session(app_options([free_endpoint()], {"wrong": 1}), "app")
    assert "\n" not in str(raised.value)


def test_only_named_endpoints_are_dialled(stack):
    """Without scouting two peers that both know a third one do not connect to each other."""
    endpoints = [free_endpoint() for _ in range(3)]
    middle = closing(stack, open_session(mesh(endpoints[0]), "mesh"))
    ends = [closing(stack, open_session(mesh(endpoint, endpoints[:1]), "mesh")) for endpoint in endpoints[1:]]
    wait_until(lambda: len(middle.info.peers_zid()) == 2, what="both links")
    for end in ends:
        wait_until(end.info.peers_zid, what="its end of the link")
    heard = [str(zid) for end in ends for zid in end.info.peers_zid()]
    assert heard == [str(middle.zid())] * 2


def test_an_unreachable_peer_does_not_hold_up_the_start_and_is_dialled_later(stack):
    """The session opens at once, and links as soon as the peer is there."""
    endpoint = free_endpoint()
    early = closing(stack, open_session(mesh(free_endpoint(), [endpoint]), "mesh"))
    assert not early.info.peers_zid()
    late = closing(stack, open_session(mesh(endpoint), "mesh"))
    wait_until(lambda: early.info.peers_zid() and late.info.peers_zid(), what="the link")


BURST = 400
"""So many samples of 1 kB come at once: more than Zenoh's own queue and the small sockets between hold."""
ROOMY = {
    "mode": "client",
    "scouting": {"multicast": {"enabled": False}},
    "transport": {"link": {"tx": {"queue": {"congestion_control": {"drop": {"wait_before_drop": 60_000_000}}}}}},
}
"""An application that loses nothing on its own end."""


def test_a_burst_waits_for_an_app_that_stands_still_for_a_moment(stack):
    """What may be dropped is not, where all of it is little: Zenoh's own queue for an app holds 128 kB."""
    endpoint = free_endpoint()
    closing(stack, open_session(app_options([f"{endpoint}#so_sndbuf=65536;so_rcvbuf=65536"], {}), "app"))
    reader = closing(stack, plain_session("client", connect=(f"{endpoint}#so_rcvbuf=4096",)))
    goes_on, heard = threading.Event(), []

    def take(sample):
        goes_on.wait()
        heard.append(sample.payload.to_bytes()[0])

    reader.declare_subscriber("burst", zenoh.handlers.Callback(take, indirect=False))
    stack.callback(goes_on.set)
    options = ROOMY | {"connect": {"endpoints": [endpoint], "timeout_ms": 5000, "exit_on_failure": True}}
    writer = closing(stack, zenoh.open(zenoh.Config.from_json5(json.dumps(options))))
    wait_matching(writer, "burst")
    for number in range(BURST):
        writer.put("burst", bytes([number % 256]) + bytes(999))
    goes_on.set()
    wait_until(lambda: len(heard) == BURST, what=f"all {BURST} samples")
    assert heard == [number % 256 for number in range(BURST)]
