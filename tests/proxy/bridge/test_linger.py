"""The kernel keeps no thread of Zenoh's waiting for a link that is closed."""

import socket
import struct

from proxy import clock
from proxy.bridge.linger import Linger
from proxy.bridge.sessions import mesh_options, open_session
from proxy.bridge.sockets import Sockets
from tests.proxy.nodes import closing, free_endpoint, plain_session
from tests.waiting import wait_until


def lingering(session):
    """For each link of a session, whether closing it may take a while; nothing as long as not all are known."""
    sockets = Sockets(session)
    sockets.refresh()
    found = []
    for _, number in sockets.ends:
        borrowed = socket.socket(fileno=number)
        on, _ = struct.unpack("@ii", borrowed.getsockopt(socket.SOL_SOCKET, socket.SO_LINGER, 8))
        found.append(bool(on))
        borrowed.detach()
    return found


def test_links_old_and_new_are_closed_at_once(stack):
    """Zenoh would have each of them waited for."""
    endpoint = free_endpoint()
    options = mesh_options([endpoint], [], scouting=False, interface="auto", zenoh_options={})
    session = closing(stack, open_session(options, "mesh"))
    linger = Linger(session)
    for links in (1, 2):
        closing(stack, plain_session("peer", connect=(endpoint,)))
        wait_until(lambda links=links: len(lingering(session)) == links, what="the link")
        assert any(lingering(session))

        def cared_for(links=links):
            """Zenoh tells of a new link a little after it lists it."""
            linger.check(clock.monotonic())
            return lingering(session) == [False] * links

        wait_until(cared_for, what="all links to be closed at once")
