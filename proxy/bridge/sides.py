"""Opens all sessions of a daemon: one per side, a mirror session beside each, and in broadcast one for the samples."""

import threading
import time
from contextlib import ExitStack
from dataclasses import dataclass

import zenoh

from proxy.bridge.broadcast import Broadcast, DataSession
from proxy.bridge.declarations.declarations import Declarations
from proxy.bridge.declarations.private_endpoint import PrivateEndpoint
from proxy.bridge.loopback import has_ipv6, present
from proxy.bridge.rediscovery import Rediscovery, opened
from proxy.bridge.sessions import app_options, let_group_in, mesh_options, open_session
from proxy.config import AppConfig, MeshConfig


@dataclass(frozen=True, slots=True)
class Sides:
    """The sessions of both sides. `wake` is set whenever somebody on either side declares something.

    Samples travel between robots on `data`: in unicast that is `mesh`. `apps` and `others` are what is declared on the
    app side and on the mesh.
    """

    app: zenoh.Session
    mesh: zenoh.Session
    data: DataSession
    apps: Declarations
    others: Declarations
    wake: threading.Event
    rediscovery: Rediscovery


def open_sides(app: AppConfig, mesh: MeshConfig, closing: ExitStack, farewell: float = 0.0) -> Sides:
    """Open them; `closing` closes them, the app side `farewell` [s] after its mirror session. Raises SessionError.

    A router whose link to another has just closed still works out its routes; closed meanwhile, it may panic.
    """
    endpoints = PrivateEndpoint(), PrivateEndpoint()
    for endpoint in endpoints:
        closing.callback(endpoint.close)
    wake = threading.Event()
    listen = present(app.listen, ipv6=has_ipv6())
    app_session = open_session(
        endpoints[0].added_to(app_options(listen, app.zenoh, connect=app.connect, scouting=app.scouting)), "app"
    )
    closing.callback(app_session.close)
    closing.callback(time.sleep, farewell)
    let_group_in(listen)
    options = mesh_options(
        mesh.listens,
        mesh.connect,
        scouting=mesh.scouts,
        interface=mesh.interface,
        zenoh_options=mesh.zenoh,
        relayed=mesh.relayed,
    )
    mesh_session, scouting = opened(lambda: open_session(endpoints[1].added_to(options), "mesh"))
    closing.callback(mesh_session.close)
    rediscovery = Rediscovery(mesh_session, options, scouting)
    closing.callback(rediscovery.close)
    data = _open_data(mesh, mesh_session, closing)
    others = Declarations(
        mesh_session, endpoints[1], side="mesh", mode="client", zenoh_options=mesh.zenoh, changed=wake.set
    )
    closing.callback(others.close)
    # Routers do not tell each other that what was behind a third router is gone; they do tell clients.
    apps = Declarations(
        app_session,
        endpoints[0],
        side="app",
        mode="client" if app.connect else "router",
        zenoh_options=app.zenoh,
        changed=wake.set,
    )
    closing.callback(apps.close)
    return Sides(app_session, mesh_session, data, apps, others, wake, rediscovery)


def _open_data(mesh: MeshConfig, session: zenoh.Session, closing: ExitStack) -> DataSession:
    if mesh.transport == "unicast":
        return session
    info = session.info
    # In mode "client" all others are behind routers.
    data = Broadcast(mesh.group, mesh.interface, session, lambda: bool(info.peers_zid() or info.routers_zid()))
    closing.callback(data.close)
    return data
