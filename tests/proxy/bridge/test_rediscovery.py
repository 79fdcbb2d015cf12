"""Robots that were lost are asked for more often than Zenoh asks, from Zenoh's own socket."""

import json
import socket
import struct

import pytest
import zenoh

from proxy.bridge.rediscovery import Rediscovery, answer, opened
from proxy.bridge.sessions import mesh_options, open_session
from proxy.bridge.tuning import TUNING
from tests.ports import free_port
from tests.proxy.nodes import closing, free_endpoint, plain_session
from tests.waiting import wait_until

GROUP = "224.0.0.225"


class Bench:
    """A session that scouts on loopback, and what is asked there."""

    def __init__(self, stack, *, scouting=True):
        self.port, self.endpoint = free_port(), free_endpoint()
        self._group = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        for option in (socket.SO_REUSEADDR, socket.SO_REUSEPORT):
            self._group.setsockopt(socket.SOL_SOCKET, option, 1)
        self._group.bind((GROUP, self.port))
        member = struct.pack("4s4s", socket.inet_aton(GROUP), socket.inet_aton("127.0.0.1"))
        self._group.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
        self._group.settimeout(30.0)
        address = {"scouting": {"multicast": {"address": f"{GROUP}:{self.port}"}}}
        options = mesh_options([self.endpoint], [], scouting=scouting, interface="lo", zenoh_options=address)
        self.session, sockets = opened(lambda: open_session(options, "mesh"))
        closing(stack, self.session)
        self.rediscovery = Rediscovery(self.session, options, sockets)
        stack.callback(self.rediscovery.close)
        self.sockets = sockets

    def question(self):
        """The next question on the group, and who asks."""
        return self._group.recvfrom(1000)

    def asked(self, now):
        """Whether a look at `now` asks."""
        sent = []
        (scouting,) = self.rediscovery._sockets
        self.rediscovery._sockets = [Recorded(scouting, sent)]
        self.rediscovery.check(now)
        self.rediscovery._sockets = [scouting]
        return bool(sent)

    def linked(self, count):
        wait_until(lambda: len(list(self.session.info.peers_zid())) == count, what=f"{count} links")


class Recorded:
    """A socket, and what was sent with it."""

    def __init__(self, real, sent):
        self._real = real
        self._sent = sent

    def sendto(self, data, address):
        self._sent.append(data)
        return self._real.sendto(data, address)


@pytest.fixture
def bench(stack):
    return Bench(stack)


def test_questions_are_those_of_zenoh_and_come_from_its_socket(stack, bench):
    """So it is Zenoh that gets the answers."""
    own = bench.question()
    peer = closing(stack, plain_session("peer", connect=(bench.endpoint,)))
    bench.linked(1)
    bench.rediscovery.check(1.0)
    peer.close()
    bench.linked(0)
    (scouting,) = bench.rediscovery._sockets
    scouting.sendto(b"mark", bench.rediscovery._group)
    bench.rediscovery.check(2.0)
    while bench.question()[0] != b"mark":
        pass
    assert bench.question() == own


def test_who_is_missing_is_asked_for_until_all_are_back_or_given_up(stack, bench):
    """The more links are left the less often, for all who hear a question answer it."""
    stays = closing(stack, plain_session("peer", connect=(bench.endpoint,)))
    goes = closing(stack, plain_session("peer", connect=(bench.endpoint,)))
    bench.linked(2)
    assert not bench.asked(1.0)
    goes.close()
    bench.linked(1)
    assert bench.asked(10.0)
    assert not bench.asked(10.0 + 1.9 * TUNING.rediscovery_interval)
    assert bench.asked(10.0 + 2.0 * TUNING.rediscovery_interval)
    stays.close()
    bench.linked(0)
    assert bench.asked(20.0)
    assert bench.asked(20.0 + TUNING.rediscovery_interval)
    assert bench.asked(19.0 + TUNING.rediscovery_time)
    assert not bench.asked(20.0 + TUNING.rediscovery_time)


def test_where_nobody_is_looked_for_there_is_nothing_to_ask_with(stack):
    """Without scouting only named endpoints are dialled."""
    assert Bench(stack, scouting=False).sockets == []


def test_an_answer_is_that_of_zenoh(bench):
    """Byte by byte, as the session itself answers."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asking:
        asking.bind(("127.0.0.1", 0))
        asking.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
        asking.settimeout(30.0)
        asking.sendto(b"\x01\x09\x02", (GROUP, bench.port))
        assert asking.recv(1000) == answer(str(bench.session.zid()), bench.endpoint)


def test_who_was_dialled_is_dialled_again_where_no_question_reaches_it(stack, bench):
    """It hears no multicast: it is known by what others told, as robots are that are several hops away."""
    place = free_endpoint()
    peer = plain_session("peer", listen=(place,), connect=())
    zid = str(peer.zid())
    (scouting,) = bench.sockets
    scouting.sendto(answer(zid, place), ("127.0.0.1", scouting.getsockname()[1]))
    bench.linked(1)
    bench.rediscovery.check(1.0)
    peer.close()
    bench.linked(0)
    config = zenoh.Config.from_json5(json.dumps({"id": zid, "mode": "peer", "listen": {"endpoints": [place]}}))
    config.insert_json5("scouting/multicast/enabled", "false")
    closing(stack, zenoh.open(config))
    bench.rediscovery.check(2.0)
    bench.linked(1)
