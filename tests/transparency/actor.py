"""All applications of one host in one program: it does what lines of JSON on its standard input say.

    {"do": "subscriber", "app": "a.app", "name": "s1", "key": "k/**"}  →  {"id": ["…zid…", 1]}

Each application is a Zenoh session of its own. What it declares has a name; what arrives there is kept in order, as
plain data, until `heard` asks for it. A line is answered before the next one is read, with `{"error": …}` when it
fails.
"""

import json
import sys
import threading
import time
from datetime import timedelta

import zenoh
from zenoh import ext, shm

from tests.transparency import described

SHARED = 1 << 20
"""Size of an application's pool of shared memory [B]."""


class Heard:
    """What arrived at one place, in order."""

    def __init__(self):
        self._changed = threading.Condition()
        self._items = []
        self._over = False

    def add(self, item):
        with self._changed:
            self._items.append(item)
            self._changed.notify_all()

    def end(self):
        with self._changed:
            self._over = True
            self._changed.notify_all()

    def wait(self, *, count=0, last=None, over=False, timeout):
        """Wait for `count` items, one that holds all of `last`, or the end; return all there is and whether it came."""

        def there():
            found = last is None or any(last.items() <= item.items() for item in self._items)
            return len(self._items) >= count and found and (self._over or not over)

        with self._changed:
            came = self._changed.wait_for(there, timeout)
            return {"items": list(self._items), "came": came}


class Actor:
    """The applications of one host, and everything they have declared. Each public method is something to `do`."""

    def __init__(self):
        self._sessions = {}
        self._declared = {}
        self._heard = {}
        self._held = {}
        self._pools = []

    # Sessions

    def open(self, *, app, config):
        session = self._sessions[app] = zenoh.open(zenoh.Config.from_json5(json.dumps(config)))
        return {"zid": str(session.zid())}

    def close(self, *, app):
        self._sessions.pop(app).close()

    def info(self, *, app):
        info = self._sessions[app].info
        return {
            "zid": str(info.zid()),
            "routers": sorted(map(str, info.routers_zid())),
            "peers": sorted(map(str, info.peers_zid())),
            "links": sorted(link.dst.partition("/")[0] for link in info.links()),
        }

    def scout(self, *, name, kinds, timeout):
        heard = Heard()
        found = zenoh.scout(direct(lambda hello: heard.add(described.hello(hello))), what=kinds)
        heard.wait(over=True, timeout=timeout)
        found.stop()
        self._heard[name] = heard

    # Publishing

    def put(self, *, app, key, payload, declared=False, **attributes):
        key = self._sessions[app].declare_keyexpr(key) if declared else key
        self._sessions[app].put(key, self._bytes(payload), **self._arguments(app, attributes))

    def delete(self, *, app, key, declared=False, **attributes):
        key = self._sessions[app].declare_keyexpr(key) if declared else key
        self._sessions[app].delete(key, **self._arguments(app, attributes))

    def put_many(self, *, app, keys, payloads):
        for key in keys:
            for payload in payloads:
                self._sessions[app].put(key, payload, congestion_control=zenoh.CongestionControl.BLOCK)

    def publisher(self, *, app, name, key, **options):
        options = self._arguments(app, options)
        return self._declare(name, self._sessions[app].declare_publisher(key, **options))

    def publish(self, *, app, name, payload=None, **attributes):
        publisher, attributes = self._declared[name], self._arguments(app, attributes)
        if payload is None:
            publisher.delete(**attributes)
        else:
            publisher.put(self._bytes(payload), **attributes)

    def matching(self, *, name):
        return {"matching": described.matching(self._declared[name].matching_status)}

    def matching_listener(self, *, name, of):
        take = self._taker(name, described.matching_event)
        self._declare(name, self._declared[of].declare_matching_listener(take))

    # Receiving

    def subscriber(self, *, app, name, key):
        take = self._taker(name, described.sample)
        return self._declare(name, self._sessions[app].declare_subscriber(key, take))

    def heard(self, *, name, timeout, count=0, last=None, over=False):
        return self._heard[name].wait(count=count, last=last, over=over, timeout=timeout)

    # Queries

    def queryable(self, *, app, name, key, answers, complete=False):
        """Answer every query with `answers`: "reply", "delete", "error", or "hold", which keeps it open.

        An answer that Zenoh refuses is heard too.
        """

        def answer(query):
            self._heard[name].add(described.query(query))
            for step in answers:
                if "hold" in step:
                    self._held.setdefault(name, []).append(query)
                    return
                try:
                    self._answer(app, query, step)
                except zenoh.ZError:
                    self._heard[name].add({"refused": step})
            query.drop()

        self._heard[name] = Heard()
        return self._declare(name, self._sessions[app].declare_queryable(key, direct(answer), complete=complete))

    def finish(self, *, app, name, answers=()):
        """Answer and end the queries that were held."""
        for query in self._held.pop(name, []):
            for step in answers:
                self._answer(app, query, step)
            query.drop()

    def get(self, *, app, name, selector, **options):
        replies, options = self._replies(name), self._arguments(app, options)
        options["payload"] = self._bytes(options["payload"]) if "payload" in options else None
        self._sessions[app].get(zenoh.Selector(selector), replies, **options)

    def querier(self, *, app, name, key, **options):
        return self._declare(name, self._sessions[app].declare_querier(key, **self._arguments(app, options)))

    def ask(self, *, app, name, of, **options):
        replies, options = self._replies(name), self._arguments(app, options)
        self._declared[of].get(replies, **options)

    def cancel(self, *, name):
        self._declared[name].cancel()

    # Liveliness

    def token(self, *, app, name, key):
        self._declare(name, self._sessions[app].liveliness().declare_token(key))

    def liveliness_subscriber(self, *, app, name, key, history=False):
        take = self._taker(name, described.token)
        self._declare(name, self._sessions[app].liveliness().declare_subscriber(key, take, history=history))

    def liveliness_get(self, *, app, name, key):
        self._sessions[app].liveliness().get(key, self._replies(name), timeout=5.0)

    # Advanced publishers and subscribers

    def advanced_publisher(self, *, app, name, key, cache=None, miss=None, detection=False, **options):
        options = self._arguments(app, options)
        if cache is not None:
            options["cache"] = ext.CacheConfig(cache)
        if miss is not None:
            options["sample_miss_detection"] = ext.MissDetectionConfig(
                **({"heartbeat": None, "sporadic_heartbeat": None} | miss)
            )
        session = self._sessions[app]
        publisher = ext.declare_advanced_publisher(session, key, publisher_detection=detection, **options)
        return self._declare(name, publisher)

    def advanced_subscriber(self, *, app, name, key, history=None, recovery=None, detection=False):
        options = {"subscriber_detection": detection}
        if history is not None:
            options["history"] = ext.HistoryConfig(**history)
        if recovery is not None:
            period = recovery.get("periodic_queries")
            options["recovery"] = ext.RecoveryConfig(
                heartbeat=recovery.get("heartbeat"),
                # The stubs promise seconds; the binding wants this.
                periodic_queries=None if period is None else timedelta(seconds=period),
            )
        take = self._taker(name, described.sample)
        return self._declare(name, ext.declare_advanced_subscriber(self._sessions[app], key, take, **options))

    def miss_listener(self, *, name, of):
        listener = self._declared[of].sample_miss_listener(self._taker(name, described.miss))
        self._declare(name, listener)

    def detect_publishers(self, *, name, of):
        take = self._taker(name, described.token)
        self._declare(name, self._declared[of].detect_publishers(take, history=True))

    # Everything

    def undeclare(self, *, name):
        self._declared.pop(name).undeclare()

    def reset(self):
        """Take back all that was declared and forget what arrived."""
        for name in reversed(list(self._declared)):
            declared = self._declared.pop(name)
            if hasattr(declared, "undeclare"):
                declared.undeclare()
        self._heard.clear()
        self._held.clear()
        self._pools.clear()

    def _declare(self, name, declared):
        self._declared[name] = declared
        identity = getattr(declared, "id", None)
        return None if identity is None else {"id": described.entity(identity)}

    def _taker(self, name, describe):
        heard = self._heard[name] = Heard()
        return direct(lambda item: heard.add(describe(item)))

    def _replies(self, name):
        heard = self._heard[name] = Heard()
        asked = time.monotonic()

        def take(reply):
            heard.add(described.reply(reply) | {"after": time.monotonic() - asked})

        return zenoh.handlers.Callback(take, heard.end, indirect=False)

    def _answer(self, app, query, step):
        (kind, said), *_ = step.items()
        said = {"key": str(query.key_expr)} | said
        key = said.pop("key")
        if kind == "reply":
            query.reply(key, said.pop("payload"), **self._arguments(app, said))
        elif kind == "delete":
            query.reply_del(key, **self._arguments(app, said))
        else:
            query.reply_err(said.pop("payload"), **self._arguments(app, said))

    def _bytes(self, payload):
        """A payload: text, `{"size": n}` for many bytes, or `{"shared": text}` for one in shared memory."""
        if isinstance(payload, str):
            return payload
        if "size" in payload:
            return (bytes(range(251)) * (payload["size"] // 251 + 1))[: payload["size"]]
        pool = shm.ShmProvider.default_backend(SHARED)
        self._pools.append(pool)
        text = payload["shared"].encode()
        buffer = pool.alloc(len(text))
        buffer[0 : len(text)] = text
        return zenoh.ZBytes(buffer)

    def _arguments(self, app, plain):
        """Zenoh's arguments from their names: enumerations by name, and what only a session or entity can make."""
        made = {}
        for name, value in plain.items():
            if name in _NAMED:
                made[name] = getattr(_NAMED[name], value)
            elif name == "encoding":
                made[name] = zenoh.Encoding(value)
            elif name == "timestamp":
                made[name] = self._stamp(app, ahead=value)
            elif name == "source":
                made["source_info"] = zenoh.SourceInfo(self._declared[value[0]].id, value[1])
            elif name == "instrumented":
                builder = zenoh.TimestampInstrumentationBuilder()
                made["timestamp_instrumentation"] = builder.set_send(True).set_route(True).set_receive(True).build()
            elif name == "cancellation":
                made["cancellation_token"] = self._declared[value] = zenoh.CancellationToken()
            else:
                made[name] = value
        return made

    def _stamp(self, app, *, ahead):
        """The session's timestamp of now, `ahead` seconds later."""
        now = self._sessions[app].new_timestamp()
        time_then = now.get_time_as_ntp64()
        then = zenoh.NTP64(time_then.as_secs() + ahead, time_then.subsec_nanos())
        return zenoh.Timestamp(then, now.get_id())


def direct(take):
    """A callback on Zenoh's own thread."""
    return zenoh.handlers.Callback(take, indirect=False)


_NAMED = {
    "priority": zenoh.Priority,
    "congestion_control": zenoh.CongestionControl,
    "reliability": zenoh.Reliability,
    "target": zenoh.QueryTarget,
    "consolidation": zenoh.ConsolidationMode,
    "accept_replies": zenoh.ReplyKeyExpr,
    "allowed_destination": zenoh.Locality,
}


def main():
    """Do what the lines say until they end."""
    actor = Actor()
    for line in sys.stdin:
        asked = json.loads(line)
        try:
            answer = getattr(actor, asked.pop("do"))(**asked)
        except Exception as error:  # noqa: BLE001 - whoever asked shall know
            answer = {"error": f"{type(error).__name__}: {error}"}
        sys.stdout.write(json.dumps(answer) + "\n")
        sys.stdout.flush()
    actor.reset()


if __name__ == "__main__":
    main()
