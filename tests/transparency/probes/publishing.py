"""What a subscriber sees of what a publisher says."""

from tests.transparency.feature import Limit, feature

GROUP = "Publishing"
PRIORITIES = (
    *("REAL_TIME", "INTERACTIVE_HIGH", "INTERACTIVE_LOW"),
    *("DATA_HIGH", "DATA", "DATA_LOW", "BACKGROUND"),
)


def _stamps(put, delete):
    return [{"kind": "PUT", "stamp": put}, {"kind": "DELETE", "stamp": delete}]


def heard_by_both(team, say, *fields, key="say/**"):
    """Let `say` run with an application on robot a; what one on a and one on b heard."""
    listeners = {"same robot": team.a.other.subscriber(key), "other robot": team.b.app.subscriber(key)}
    team.settle()
    say(team.a.app)
    team.flush()
    return {where: listener.heard(*fields) for where, listener in listeners.items()}


@feature(GROUP, "put")
def put(team):
    """Key, payload, encoding and every other attribute of a plain put."""
    return heard_by_both(team, lambda app: app.put("say/put", payload="hello"), *_FIELDS)


@feature(GROUP, "delete")
def delete(team):
    """A delete with and without attachment."""

    def say(app):
        app.delete("say/delete")
        app.delete("say/delete", attachment="why", congestion_control="BLOCK", express=True)

    return heard_by_both(team, say, *_FIELDS)


@feature(GROUP, "encoding and attachment")
def encoding(team):
    """Encodings: known ones, one with a schema, unknown words; attachments: text, empty, large."""

    def say(app):
        for number, name in enumerate(("application/cdr", "text/plain;utf-8", "my/own;schema", "")):
            app.put(f"say/encoding/{number}", payload="x", encoding=name)
        for attachment in ("small", "", "large " * 1000):
            app.put("say/attachment", payload="x", attachment=attachment)

    return heard_by_both(team, say, "key", "encoding", "attachment")


@feature(GROUP, "priority, congestion control, express")
def quality(team):
    """All seven priorities; drop, block and block first; express."""

    def say(app):
        for priority in PRIORITIES:
            app.put(f"say/{priority}", payload="x", priority=priority)
        for control in ("DROP", "BLOCK", "BLOCK_FIRST"):
            app.put(f"say/{control}", payload="x", congestion_control=control)
        for express in (False, True):
            app.put(f"say/{express}", payload="x", express=express)

    heard = heard_by_both(team, say, "key", "priority", "congestion", "express")
    return {where: sorted(items, key=lambda item: item["key"]) for where, items in heard.items()}


@feature(GROUP, "reliability")
def reliability(team):
    """Samples of a reliable and of a best-effort publisher arrive."""

    def say(app):
        for kind in ("RELIABLE", "BEST_EFFORT"):
            app.publisher(f"say/{kind}", reliability=kind).publish(kind)

    heard = heard_by_both(team, say, "key", "payload")
    return {where: sorted(items, key=lambda item: item["key"]) for where, items in heard.items()}


@feature(
    GROUP,
    "timestamp of none",
    Limit(
        "A router stamps puts as they pass. A daemon stamps puts and deletes when it takes them to the mesh, with the "
        "id of its session there, by which the daemons know whose sample it is; applications of one robot hear each "
        "other without a stamp. A router that stamps would replace stamps too, as below.",
        {
            "same robot": (_stamps("router", None), _stamps(None, None)),
            "other robot": (_stamps("router", None), _stamps("another", "another")),
        },
    ),
)
def stamped_on_the_way(team):
    """A put and a delete without a timestamp: who stamps them."""

    def say(app):
        app.put("say/stamp", payload="x")
        app.delete("say/stamp")

    return heard_by_both(team, say, "kind", "stamp")


@feature(GROUP, "timestamp of the application")
def stamped(team):
    """A sample with the application's own timestamp, now and an hour ago: it is not touched."""

    def say(app):
        app.put("say/now", payload="x", timestamp=0)
        app.put("say/past", payload="x", timestamp=-3600)

    listener, told = team.b.app.subscriber("say/**"), heard_by_both(team, say, "stamp")
    return told | {"an hour apart": _apart(listener)}


@feature(
    GROUP,
    "timestamp of the future",
    Limit(
        "A router replaces timestamps that are more than 0.5 s ahead of its clock. A daemon never touches one: robots "
        "without a common clock would lose theirs.",
        {
            "same robot": (["a.app", "router"], ["a.app", "a.app"]),
            "other robot": (["a.app", "router"], ["a.app", "a.app"]),
            "an hour apart": (False, True),
        },
    ),
)
def stamped_in_the_future(team):
    """A sample whose timestamp is an hour ahead."""

    def say(app):
        app.put("say/now", payload="x", timestamp=0)
        app.put("say/future", payload="x", timestamp=3600)

    listener, told = team.b.app.subscriber("say/**"), heard_by_both(team, say, "stamp")
    return told | {"an hour apart": _apart(listener)}


@feature(GROUP, "source info")
def source(team):
    """Who published and the number it gave: set by the application, on put and delete."""

    def say(app):
        publisher = app.publisher("say/source", label="publisher")
        publisher.publish("x", source=[publisher.name, 7])
        publisher.publish(source=[publisher.name, 8])
        publisher.publish("y")

    return heard_by_both(team, say, "source")


@feature(
    GROUP,
    "timestamps on the way",
    Limit(
        "Zenoh has no way to publish a sample together with the stamps that it came with, so they end at the daemon.",
        {"other robot": ([["SEND", "ROUTE", "ROUTE", "ROUTE", "ROUTE", "RECEIVE"]], [None])},
    ),
)
def instrumented(team):
    """Timestamp instrumentation: at which points a sample is stamped when it asks for it."""
    return heard_by_both(team, lambda app: app.put("say/stack", payload="x", instrumented=True), "stack")


@feature(GROUP, "small and large payloads")
def sizes(team):
    """Payloads of 0 B, 1 B, 100 kB and 1 MB arrive whole."""

    def say(app):
        for size in (0, 1, 100_000, 1_000_000):
            app.put("say/size", payload={"size": size}, congestion_control="BLOCK")

    return heard_by_both(team, say, "payload")


@feature(GROUP, "publisher")
def publisher(team):
    """A declared publisher: its encoding and quality go with each sample, and a sample's own encoding wins."""

    def say(app):
        options = {"encoding": "text/csv", "priority": "DATA_HIGH", "congestion_control": "BLOCK", "express": True}
        publisher = app.publisher("say/publisher", **options)
        publisher.publish("1")
        publisher.publish("2", encoding="text/json", attachment="a")
        publisher.publish()

    return heard_by_both(team, say, *_FIELDS)


@feature(GROUP, "declared key expressions")
def declared(team):
    """Puts and deletes on key expressions that the application has declared, one of them a prefix."""

    def say(app):
        for key in ("say/declared", "say/declared/deep"):
            app.put(key, payload="1", declared=True)
            app.delete(key, declared=True)
        app.put("say/declared/deep/er", payload="2")

    return heard_by_both(team, say, "key", "kind", "payload")


@feature(GROUP, "puts on wildcards")
def wildcards(team):
    """A put and a delete on `say/*` and on `say/**`: they reach whoever subscribes to a key of them, once."""
    listeners = {key: team.b.app.subscriber(key) for key in ("say/a", "say/*", "say/a/b", "say/**")}
    team.settle()
    for key in ("say/*", "say/**"):
        team.a.app.put(key, payload="x")
        team.a.app.delete(key)
    team.flush()
    return {key: listener.heard("key", "kind") for key, listener in listeners.items()}


@feature(GROUP, "order")
def order(team):
    """1,000 samples of one publisher, and 10 on each of 100 keys: all arrive, in order on each key."""
    first, second = [str(number) for number in range(1000)], [str(number) for number in range(10)]
    keys = [f"say/many/{number}" for number in range(100)]

    def say(app):
        app.put_many(keys=["say/one"], payloads=first)
        app.put_many(keys=keys, payloads=second)

    seen = heard_by_both(team, say, "key", "payload")
    return {where: _in_order(items, {"say/one": first} | dict.fromkeys(keys, second)) for where, items in seen.items()}


@feature(GROUP, "to whom")
def locality(team):
    """A put for the session's own subscribers only, for others only, for all."""

    def say(app):
        own = app.subscriber("say/*", label="own")
        for where in ("SESSION_LOCAL", "REMOTE", "ANY"):
            app.put(f"say/{where}", payload="x", allowed_destination=where)
        own_heard.extend(own.heard("key", count=2))

    own_heard = []
    return heard_by_both(team, say, "key") | {"own session": own_heard}


_FIELDS = ("key", "kind", "payload", "encoding", "attachment", "priority", "congestion", "express", "source")


def _apart(listener):
    """Whether the two samples heard are stamped an hour apart, to the second."""
    (first, _), (second, _) = listener.heard("stamp", raw=True)
    return abs(abs(first - second) - 3600) < 60


def _in_order(items, wanted):
    """Of each key whether everything came once and in order; only the number of keys that did."""
    by_key = {key: [] for key in wanted}
    for item in items:
        by_key[item["key"]].append(item["payload"])
    return f"{sum(by_key[key] == wanted[key] for key in wanted)} of {len(wanted)} keys complete and in order"
