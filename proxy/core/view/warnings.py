"""What an operator must be told although everything runs: robots or specs that do not fit together."""

from collections.abc import Iterable, Mapping

from planner import Airtime
from proxy.core.model.limits import Limit
from proxy.core.model.mode import Mode
from proxy.core.model.settings import CoreSettings, is_broadcast
from proxy.core.view.peer import Peer
from utility_specs import digests


def transport_warnings(settings: CoreSettings, peers: Mapping[str, Peer]) -> list[str]:
    """Name every robot whose samples travel in another way than ours; it may not have said yet."""
    ours = settings.transport
    return [
        f"robot {peer.robot} has mesh.transport {peer.state.transport}, this one {ours}: "
        "what one of them broadcasts does not reach the other"
        for peer in peers.values()
        if peer.state.transport and peer.state.transport != ours
    ]


def mode_warnings(mode: Mode, peers: Mapping[str, Peer], limits: Iterable[Limit]) -> list[str]:
    """Say where some robots enforce shared limits and others send everything: those take the room of the first."""
    if not any(limit.shared for limit in limits):
        return []
    if mode is Mode.ENFORCE:
        return [
            f"robot {peer.robot} is in mode {peer.state.mode}: it sends everything, and this robot gives way to it; "
            "put all in one mode"
            for peer in peers.values()
            if peer.state.mode in (Mode.SHADOW.value, Mode.PASS.value)
        ]
    enforcing = sorted(peer.robot for peer in peers.values() if peer.state.mode == Mode.ENFORCE.value)
    if not enforcing:
        return []
    who, give = ", ".join(enforcing), "give" if len(enforcing) > 1 else "gives"
    return [f"this robot is in mode {mode.value}: it sends everything, and {who} {give} way to it; put all in one mode"]


def namesake_warning(name: str, zid: str, shown: str) -> str:
    """Say that another robot has a name that was taken; here it is `shown` as another one."""
    return f"two robots on the mesh are called {name!r}: rename one; the one of session {zid} is {shown!r} here"


def namesake_warnings(settings: CoreSettings, peers: Mapping[str, Peer]) -> list[str]:
    """Name every robot with a name that was taken when it came; who starts with one adds a part of its id itself."""
    robots = [(peer.name, peer.zid) for peer in peers.values()] + [(settings.robot, settings.zid)]
    names = {name for name, _ in robots}
    renamed = [(name.removesuffix(f"-{zid[:4]}"), zid, name) for name, zid in robots]
    return [
        *(namesake_warning(peer.name, peer.zid, peer.robot) for peer in peers.values() if peer.is_namesake),
        *(namesake_warning(name, zid, shown) for name, zid, shown in renamed if name != shown and name in names),
    ]


def cast_warnings(limits: Iterable[Limit], transport: str) -> list[str]:
    """Name every limit of airtime that counts another kind of transmission than there is."""
    cast = "multicast" if is_broadcast(transport) else "unicast"
    return [
        f'{limit.name} counts airtime with cast = "{limit.measure.cast}", but samples go by {cast}: correct the spec'
        for limit in limits
        if isinstance(limit.measure, Airtime) and limit.measure.cast != cast
    ]


def digest_warnings(limits: Iterable[Limit], robots: int) -> list[str]:
    """Name every limit of which the digests of so many robots leave little."""
    said = {limit.name: digests.warning(limit.measure, robots) for limit in limits}
    return [f'constraint "{name}": {warning}' for name, warning in said.items() if warning]
