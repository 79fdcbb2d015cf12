"""Robot names, endpoints, interfaces and groups."""

import pytest
import zenoh
from hypothesis import given
from hypothesis import strategies as st

from proxy.bridge.bounds import BOUNDS
from proxy.config_values import (
    LONGEST_NAME,
    endpoint,
    http_address,
    interface,
    multicast_group,
    remote_endpoint,
    robot_name,
    robot_of_host,
    this_robot,
)
from utility_specs.suggestions import quoted


@pytest.mark.parametrize("name", ["r1", "robot-7", "Ω", "a@b", "r.1", 120 * "r"])
def test_one_chunk_is_a_name(name):
    """A name is taken as it is."""
    assert robot_name(name) == name


def test_others_take_every_name():
    """Also with what a daemon puts behind one that is taken."""
    assert LONGEST_NAME + len("-0123") <= BOUNDS.name_length


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("", "must not be empty"),
        ("@r1", 'must not start with "@": "@r1"'),
        ("a/b", 'must be one chunk of a key, without /: "a/b"'),
        ("r*#", 'must be one chunk of a key, without # *: "r*#"'),
        ("r 1", "must be one chunk of a key, without ' ': \"r 1\""),
        (121 * "r", f"must have at most 120 letters, not 121: {quoted(121 * 'r')}"),
    ],
)
def test_what_is_no_chunk_is_refused(name, message):
    """A name that would change the meaning of a key is refused, and the message names the culprits."""
    with pytest.raises(ValueError) as refused:  # noqa: PT011 - the whole message is compared
        robot_name(name)
    assert str(refused.value) == message


@given(st.text())
def test_every_host_name_becomes_a_valid_robot_name(host):
    """Whatever the host is called, the default name is a valid key chunk for us and for Zenoh."""
    name = robot_of_host(host)
    assert robot_name(name) == name
    assert str(zenoh.KeyExpr(f"@sendworthy/{name}/status")) == f"@sendworthy/{name}/status"


def test_ordinary_host_names_stay():
    """Nothing is changed without need."""
    assert robot_of_host("turtle-3.local") == "turtle-3.local"
    assert robot_of_host("@home/$x") == "home--x"
    assert robot_of_host("@") == "robot"
    assert robot_name(this_robot())


@pytest.mark.parametrize(
    "text",
    [
        "tcp/127.0.0.1:7447",
        "tcp/[::1]:7447",
        "udp/224.0.0.225:7448#iface=wlan0",
        "tls/robot-2.local:7500?prio=1-3#root_ca_certificate=/etc/ca.pem",
        "unixsock-stream//run/sendworthy/zenoh.sock",
        "serial//dev/ttyUSB0#baudrate=115200",
    ],
)
def test_endpoints_as_zenoh_writes_them(text):
    """What Zenoh takes as an endpoint is taken."""
    assert endpoint(text) == text


@pytest.mark.parametrize(
    ("text", "cause"),
    [
        ("localhost:7447", ""),
        ("", ""),
        ("tcp/", ""),
        ("tpc/1.2.3.4:5", ': unknown protocol "tpc" (did you mean "tcp"?)'),
        ("tcp/1.2.3.4", ": the address must be HOST:PORT or [IPv6]:PORT"),
        ("tcp/::1:7447", ": the address must be HOST:PORT or [IPv6]:PORT"),
        ("tcp/1.2.3.4:http", ": the address must be HOST:PORT or [IPv6]:PORT"),
        ("tcp/1.2.3.4:70000", ": a port is at most 65535"),
    ],
)
def test_what_is_no_endpoint_is_refused(text, cause):
    """The message shows a right endpoint, the wrong one and what is wrong with it."""
    with pytest.raises(ValueError) as refused:  # noqa: PT011 - the whole message is compared
        endpoint(text)
    assert str(refused.value) == f'must be an endpoint like "tcp/192.168.1.2:7500", not "{text}"{cause}'


def test_port_0_can_be_listened_on_but_not_dialled():
    """Port 0 means any free port, which only a listener can choose."""
    assert endpoint("tcp/0.0.0.0:0")
    assert remote_endpoint("tcp/1.2.3.4:1") == "tcp/1.2.3.4:1"
    with pytest.raises(ValueError, match="port 0 cannot be dialled"):
        remote_endpoint("tcp/1.2.3.4:0")


@pytest.mark.parametrize("text", ["", "127.0.0.1:9447", "[::1]:9447", "localhost:1"])
def test_http_addresses(text):
    """A host and a port, or nothing."""
    assert http_address(text) == text


@pytest.mark.parametrize(
    "text", ["9447", ":9447", "127.0.0.1", "127.0.0.1:0", "127.0.0.1:65536", "http://a:1", "::1:2"]
)
def test_what_is_no_http_address_is_refused(text):
    """The message shows a right one."""
    with pytest.raises(ValueError, match="must be a host and a port like"):
        http_address(text)


@pytest.mark.parametrize("text", ["auto", "wlan0", "192.168.1.2", "fe80::1%wlan0"])
def test_interfaces(text):
    """An interface is named or given by its address; whether it exists shows later."""
    assert interface(text) == text


@pytest.mark.parametrize("text", ["", "wlan 0", "wlan\t0", "wlan\0", "/dev/wlan0"])
def test_what_is_no_interface_is_refused(text):
    """A name that no interface can have is a mistake."""
    with pytest.raises(ValueError, match='must be "auto" or an interface like "wlan0"'):
        interface(text)


@pytest.mark.parametrize("text", ["224.0.0.226:7449", "239.1.2.3:1", "[ff02::226]:7449"])
def test_multicast_groups(text):
    """A group is an address and a port."""
    assert multicast_group(text) == text


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("224.0.0.226", 'must be a multicast group and a port like "224.0.0.226:7449"'),
        ("radio:7449", "must be a multicast group and a port"),
        ("192.168.1.2:7449", "must be a multicast group and a port"),
        ("224.0.0.226:0", "must be a multicast group and a port"),
        ("224.0.0.226:65536", "must be a multicast group and a port"),
        ("224.0.0.224:7446", "224.0.0.224:7446 is where Zenoh finds others; take another one"),
        ("224.0.0.225:7448", "224.0.0.225:7448 is where Sendworthy finds others; take another one"),
    ],
)
def test_what_is_no_group_to_broadcast_on_is_refused(text, message):
    """Nor is a group on which robots are looked for."""
    with pytest.raises(ValueError, match=message):
        multicast_group(text)
