"""What applications see around them: how they connect, shared memory, namespaces, the admin space."""

from tests.transparency.arrangements import SOCKET
from tests.transparency.feature import Limit, feature

GROUP = "Connections and surroundings"
SHARED = {"transport": {"shared_memory": {"enabled": True}}}


def _heard(*, shared):
    """The samples of the probe, both in shared memory or neither."""
    return [{"payload": payload, "shared": shared} for payload in ("50000 B, 03513e2daabb", "small")]


@feature(
    GROUP,
    "shared memory",
    Limit(
        "Shared memory is off on the side of the applications: a router keeps 16 MB mapped of every session that ever "
        "published a large sample. `[app.zenoh.transport.shared_memory] enabled = true` switches it on.",
        {"same robot": (_heard(shared=True), _heard(shared=False))},
    ),
)
def shared_memory(team):
    """A payload in shared memory: it arrives on both robots, in shared memory on the publisher's own."""
    publisher, near = (team.a.open(name, **SHARED) for name in ("shm1", "shm2"))
    listeners = {
        "same robot": near.subscriber("place/shm"),
        "same robot, without shared memory": team.a.app.subscriber("place/shm"),
        "other robot": team.b.open("shm", **SHARED).subscriber("place/shm"),
    }
    team.settle()
    publisher.put("place/shm", payload={"shared": "in memory " * 5000}, congestion_control="BLOCK")
    publisher.put("place/shm", payload={"shared": "small"}, congestion_control="BLOCK")
    team.flush()
    return {where: listener.heard("payload", "shared") for where, listener in listeners.items()}


@feature(GROUP, "applications at a unix socket")
def unix_socket(team):
    """An application that connects by `unixsock-stream`: samples, queries and tokens, both ways."""
    app = team.a.open("unix", connect={"endpoints": [f"unixsock-stream/{SOCKET}"]})
    return _all_ways(team, app, team.b.app)


@feature(GROUP, "applications in peer mode")
def peer_mode(team):
    """Applications that are peers of their router, not clients: samples, queries and tokens, both ways."""
    scouting = {"multicast": {"enabled": False}, "gossip": {"enabled": True}}
    options = {"mode": "peer", "listen": {"endpoints": ["tcp/0.0.0.0:0"]}, "scouting": scouting}
    return _all_ways(team, team.a.open("peer", **options), team.b.open("peer", **options))


@feature(GROUP, "namespaces")
def namespaces(team):
    """Applications in namespace `ns1`: samples, queries and tokens; what one outside of it sees."""
    one, other = team.a.open("ns", namespace="ns1"), team.b.open("ns", namespace="ns1")
    outside, apart = team.b.app.subscriber("ns1/place/**"), team.b.other.subscriber("place/**")
    seen = _all_ways(team, one, other)
    return seen | {"outside": sorted(outside.heard("key")), "without the prefix": apart.heard("key")}


def _all_ways(team, one, other):
    """Samples, queries and tokens between two applications."""
    listener, back = other.subscriber("place/it"), one.subscriber("place/back")
    other.queryable("place/ask", answers=[{"reply": {"payload": "answer"}}])
    one.token("place/token")
    team.settle()
    publisher = one.publisher("place/it")
    replies = one.get("place/ask", payload="question", timeout=10.0)
    publisher.publish("x")
    other.put("place/back", payload="y")
    team.flush()
    return {
        "heard": listener.heard("key", "payload"),
        "heard back": back.heard("key", "payload"),
        "replies": replies.heard("key", "payload", over=True),
        "token": other.tokens("place/token", count=1),
    }


@feature(GROUP, "session info")
def info(team):
    """What a session tells of its surroundings: how many routers and peers it is linked to, and how."""
    told = team.a.app.info()
    return {"routers": len(told["routers"]), "peers": len(told["peers"]), "links": told["links"]}


@feature(
    GROUP,
    "scouting",
    Limit(
        "The side of the applications neither scouts nor answers scouts: what scouts on a radio's interface goes "
        "around the daemon. Applications are told where it is, as in deploy/apps/client.json5.",
        {"its own robot's router": (True, False), "routers of other robots": (True, False)},
    ),
)
def scouting(team):
    """What an application finds that scouts with Zenoh's defaults on robot b."""
    found = team.b.app.scout("router|peer", timeout=0.5)
    own = team.b.app.info()["routers"]
    zids = {hello["zid"] for hello in found.heard(raw=True)}
    return {"its own robot's router": own[0] in zids, "routers of other robots": bool(zids - set(own))}


@feature(
    GROUP,
    "admin space: who is there",
    Limit(
        "Zenoh's admin space describes the network of one robot. What is on others is what `sendworthy status` tells.",
        {"nodes": (["@/router/router"] * 3, ["@/router/router"])},
    ),
)
def admin_nodes(team):
    """The nodes that answer `@/*/*`, asked from robot b."""
    team.rest()
    return {"nodes": sorted(team.b.app.get("@/*/*", target="ALL", timeout=5.0).heard("key", over=True))}


@feature(
    GROUP,
    "admin space: what is declared",
)
def admin_declared(team):
    """Subscribers, queryables and tokens of an application, as its own router and another robot's list them."""
    for app, name in ((team.a.app, "a"), (team.b.app, "b")):
        app.subscriber(f"place/{name}")
        app.queryable(f"place/{name}", answers=[])
        app.token(f"place/{name}")
    team.rest()
    (own,) = team.b.app.info()["routers"]
    seen = {}
    for kind in ("subscriber", "queryable", "token"):
        for name in ("a", "b"):
            replies = team.b.app.get(f"@/{own}/router/{kind}/place/{name}", target="ALL", timeout=5.0)
            seen[f"{kind} of robot {name} at the router of b"] = sorted(replies.heard("key", over=True))
    return seen


@feature(GROUP, "admin space: configuration")
def admin_write(team):
    """The router's configuration can be read by applications, and not written."""
    team.rest()
    (own,) = team.b.app.info()["routers"]
    replies = team.b.app.get(f"@/{own}/router/config/**", target="ALL", timeout=5.0)
    return {"readable": bool(replies.heard("key", over=True))}
