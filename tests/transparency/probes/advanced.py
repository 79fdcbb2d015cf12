"""Advanced publishers and subscribers (`zenoh.ext`) on different robots."""

from tests.transparency.arrangements import MEMORY, SOCKET
from tests.transparency.feature import feature

GROUP = "Advanced publishers and subscribers"
_LOSSY = {"low_pass_filter": [{"messages": ["put"], "flows": ["egress"], "key_exprs": ["**"], "size_limit": 50}]}
"""An application that loses what is larger than 50 B, always: its sample never leaves its session."""
_STAMPS = {"timestamping": {"enabled": True}}
"""A cache without sequence numbers needs timestamps of its own session."""
_LOST, _LOST_TOO = "lost " * 12, "lost too " * 12
_SOON = 0.5
"""How long what comes again has to come again [s]."""


def after_a_loss(team, publish, *, miss, recovery, count, stamps=None):
    """What an advanced subscriber on robot b hears, and which misses it is told, when robot a loses samples."""
    subscriber = team.b.app.advanced_subscriber("adv/lossy", recovery=recovery)
    misses = subscriber.listen("miss_listener")
    app = team.a.open("lossy", **_LOSSY | (stamps or {}))
    publisher = app.advanced_publisher("adv/lossy", cache=10, miss=miss, detection=True, label="publisher")
    team.settle()
    publish(publisher)
    subscriber.came(count=count)
    subscriber.came(count=count + 1, timeout=_SOON)
    heard = subscriber.heard("payload")
    return {
        "heard, each once": list(dict.fromkeys(heard)),
        "some heard twice": len(set(heard)) < len(heard),
        "misses": misses.heard(),
    }


def _gap(publisher):
    for payload in ("1", _LOST, _LOST_TOO, "4"):
        publisher.publish(payload)


def _end(publisher):
    for payload in ("1", _LOST):
        publisher.publish(payload)


@feature(GROUP, "samples as they come")
def samples(team):
    """Puts and deletes of an advanced publisher at an advanced and at a plain subscriber; source info."""
    listeners = {
        "advanced": team.b.app.advanced_subscriber("adv/it"),
        "plain": team.b.other.subscriber("adv/it"),
        "plain, near": team.a.other.subscriber("adv/it"),
    }
    publisher = team.a.app.advanced_publisher("adv/it", cache=5, miss={}, label="publisher", priority="DATA_HIGH")
    team.settle()
    publisher.publish("1", encoding="text/csv", attachment="a")
    publisher.publish("2")
    publisher.publish()
    team.flush()
    fields = ("kind", "payload", "encoding", "attachment", "priority", "source")
    return {name: listener.heard(*fields) for name, listener in listeners.items()}


@feature(GROUP, "history")
def history(team):
    """A late subscriber fetches from the cache: all, at most 2 samples, only those of the last minute."""
    publisher = team.a.open("stamps", **_STAMPS).advanced_publisher("adv/it", cache=5)
    for payload, stamp in (("1", -3600), ("2", -1800), ("3", 0), ("4", 0), ("5", 0), ("6", 0)):
        publisher.publish(payload, timestamp=stamp)
    team.settle()
    wanted = {"all": {}, "2 samples": {"max_samples": 2}, "a minute": {"max_age": 60}}
    listeners = {name: team.b.app.advanced_subscriber("adv/*", history=options) for name, options in wanted.items()}
    for listener, count in zip(listeners.values(), (5, 2, 4), strict=True):
        listener.came(count=count)
    publisher.publish("7")
    for listener, count in zip(listeners.values(), (6, 3, 5), strict=True):
        listener.came(count=count)
    team.flush()
    return {name: listener.heard("payload") for name, listener in listeners.items()}


@feature(GROUP, "history of several robots")
def history_of_several(team):
    """A late subscriber fetches the caches of publishers on its own robot and on two others."""
    for robot in (team.a, team.b, team.c):
        publisher = robot.open("stamps", **_STAMPS).advanced_publisher(f"adv/{robot.name}", cache=2)
        for number in range(3):
            publisher.publish(f"{robot.name}{number}")
    team.settle()
    listener = team.a.other.advanced_subscriber("adv/*", history={})
    listener.came(count=6)
    team.flush()
    return {"heard": sorted(listener.heard("payload"))}


@feature(GROUP, "plain query to a cache")
def cache(team):
    """A cache is a queryable: what a plain query for its key and for `**/@adv/**` gets."""
    publisher = team.a.open("stamps", **_STAMPS).advanced_publisher("adv/it", cache=3)
    for number in range(4):
        publisher.publish(str(number))
    team.settle()
    seen = {}
    for selector in ("adv/it", "adv/it/@adv/**", "adv/it/@adv/**?_max=2"):
        replies = team.b.app.get(selector, consolidation="NONE", accept_replies="ANY", timeout=10.0)
        seen[selector] = replies.heard("key", "kind", "payload", over=True)
    return seen


@feature(GROUP, "source info of cached samples")
def cache_source(team):
    """What is fetched from a cache has the numbers by which subscribers tell what they have."""
    publisher = team.a.app.advanced_publisher("adv/it", cache=3, miss={}, label="publisher")
    for number in range(2):
        publisher.publish(str(number))
    team.settle()
    replies = team.b.app.get("adv/it/@adv/**", consolidation="NONE", accept_replies="ANY", timeout=10.0)
    return {"replies": [[reply["payload"], reply["source"]] for reply in replies.heard(over=True)]}


@feature(GROUP, "late publisher")
def late_publisher(team):
    """A publisher that connects late: a subscriber that detects it fetches what it had published before."""
    subscriber = team.b.app.advanced_subscriber("adv/*", history={"detect_late_publishers": True})
    team.settle()
    door = team.a.place.memory / "late.sock"
    endpoints = {"endpoints": [f"unixsock-stream/{MEMORY / door.name}"], "timeout_ms": -1, "exit_on_failure": False}
    retry = {"period_init_ms": 50, "period_max_ms": 50}
    app = team.a.open("late", mode="peer", connect=endpoints | {"retry": retry}, listen={"endpoints": []})
    publisher = app.advanced_publisher("adv/late", cache=5, detection=True, miss={})
    for payload in ("1", "2"):
        publisher.publish(payload)
    door.symlink_to(SOCKET)
    subscriber.came(count=2)
    team.settle()
    publisher.publish("3")
    subscriber.came(count=3)
    team.flush()
    door.unlink()
    return {"heard": subscriber.heard("payload")}


@feature(GROUP, "recovery of a gap")
def recovery(team):
    """Samples that were lost before one that arrived are fetched from the publisher's cache."""
    return after_a_loss(team, _gap, miss={"heartbeat": 60}, recovery={"heartbeat": True}, count=4)


@feature(GROUP, "recovery of a gap between samples with timestamps")
def recovery_stamped(team):
    """The same with a publisher that gives its samples timestamps."""
    return after_a_loss(team, _gap, miss={"heartbeat": 60}, recovery={"heartbeat": True}, count=4, stamps=_STAMPS)


@feature(GROUP, "recovery of the last sample by heartbeat")
def heartbeat(team):
    """The last sample was lost: the publisher's heartbeat tells, and it is fetched."""
    return after_a_loss(team, _end, miss={"heartbeat": 0.1}, recovery={"heartbeat": True}, count=2)


@feature(GROUP, "recovery of the last sample by sporadic heartbeat")
def sporadic(team):
    """The same with a heartbeat that comes only after a sample."""
    return after_a_loss(team, _end, miss={"sporadic_heartbeat": 0.1}, recovery={"heartbeat": True}, count=2)


@feature(GROUP, "recovery of the last sample by periodic queries")
def periodic(team):
    """The last sample was lost: the subscriber asks now and then, and finds it."""
    return after_a_loss(team, _end, miss={}, recovery={"periodic_queries": 0.1}, count=2)


@feature(GROUP, "recovery of the last sample with a timestamp")
def last_stamped(team):
    """The same by heartbeat, with a publisher that gives its samples timestamps."""
    return after_a_loss(team, _end, miss={"heartbeat": 0.1}, recovery={"heartbeat": True}, count=2, stamps=_STAMPS)


@feature(GROUP, "late joiner that recovers")
def late_joiner(team):
    """A late subscriber fetches the history of numbered samples, then one that was lost, and hears the next."""
    publisher = team.a.open("lossy", **_LOSSY).advanced_publisher(
        "adv/it", cache=10, miss={"heartbeat": 0.1}, detection=True
    )
    for payload in ("1", "2"):
        publisher.publish(payload)
    team.settle()
    recovery, history = {"heartbeat": True}, {"detect_late_publishers": True}
    subscriber = team.b.app.advanced_subscriber("adv/it", recovery=recovery, history=history)
    subscriber.came(count=2)
    team.settle()
    for count, payload in ((3, _LOST), (4, "4")):
        publisher.publish(payload)
        subscriber.came(count=count)
    team.flush()
    return {"heard": subscriber.heard("payload")}


@feature(GROUP, "missed samples")
def missed(team):
    """Without recovery a subscriber is told how many samples of which publisher it has missed."""
    return after_a_loss(team, _gap, miss={}, recovery=None, count=2)


@feature(GROUP, "publisher detection")
def detection(team):
    """A subscriber is told of the publishers on other robots, those that are there and those that come and go."""
    team.a.app.advanced_publisher("adv/first", detection=True)
    team.settle()
    detected = team.b.app.advanced_subscriber("adv/*").listen("detect_publishers")
    detected.came(count=1)
    second = team.c.app.advanced_publisher("adv/second", detection=True)
    team.settle()
    second.undeclare()
    team.settle()
    return {"told": detected.heard(count=3)}


@feature(GROUP, "tokens of publishers and subscribers")
def tokens(team):
    """The liveliness tokens behind publisher and subscriber detection, as another robot finds them."""
    team.a.app.advanced_publisher("adv/it", cache=1, miss={}, detection=True)
    team.b.app.advanced_subscriber("adv/*", detection=True)
    team.settle()
    return {"found": sorted(team.c.app.tokens("adv/*/@adv/**", count=2))}
