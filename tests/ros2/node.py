"""A node of ROS 2 as `rmw_zenoh` puts it on the network, without ROS 2: its session, keys, tokens and attachments.

What rmw_zenoh_cpp does since ROS 2 Jazzy: topics are advanced publishers and subscribers, services are complete
queryables, the graph is made of liveliness tokens, and every message carries an attachment of 33 bytes.
"""

import hashlib
import itertools
import json
import threading
import time
from contextlib import ExitStack

import zenoh
import zenoh.ext

ROUTER = "tcp/localhost:7447"
TYPE, HASH = "std_msgs::msg::dds_::String_", "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
HEARTBEAT = 0.5
VOLATILE, LATCHED = "::,10:,:,:,,", ":1:,1:,:,:,,"
"""Quality of service as tokens tell it; the second is transient local, of depth 1."""


def session_config(router=ROUTER):
    """What differs from Zenoh's defaults in rmw_zenoh's DEFAULT_RMW_ZENOH_SESSION_CONFIG.json5."""
    return {
        "mode": "peer",
        "connect": {"endpoints": [router], "timeout_ms": {"router": -1, "peer": -1, "client": 0}},
        "listen": {"endpoints": ["tcp/localhost:0"]},
        "scouting": {
            "multicast": {"enabled": False},
            "gossip": {
                "enabled": True,
                "target": {"router": ["router", "peer"], "peer": ["router"]},
                "autoconnect": {"router": [], "peer": ["router", "peer"]},
                "autoconnect_strategy": {"peer": {"to_router": "always", "to_peer": "greater-zid"}},
            },
        },
        "timestamping": {"enabled": {"router": True, "peer": True, "client": True}},
        "queries_default_timeout": 600000,
        "transport": {
            "unicast": {"open_timeout": 60000, "accept_timeout": 60000, "max_sessions": 10000},
            "link": {"tx": {"lease": 60000, "keep_alive": 2}},
            "shared_memory": {"enabled": False},
        },
        "adminspace": {"enabled": True},
    }


def key_of(topic, domain=0):
    """The key of a topic or service."""
    return f"{domain}/{topic.strip('/')}/{TYPE}/{HASH}"


class Node:
    """A node in a context, that is a session, of its own. `heard` are the messages of each topic, in order."""

    def __init__(self, name, *, router=ROUTER, domain=0):
        self._name = name
        self._domain = domain
        self._ids = itertools.count()
        self._lock = threading.Lock()
        self._closing = ExitStack()
        self._kept = []
        self._publishers = {}
        self._graph = {}
        self.heard = {}
        self.session = zenoh.open(zenoh.Config.from_json5(json.dumps(session_config(router))))
        self._closing.callback(self.session.close)
        list(self.session.liveliness().get(f"@ros2_lv/{domain}/**", timeout=10.0))
        subscriber = self.session.liveliness().declare_subscriber(
            f"@ros2_lv/{domain}/**", zenoh.handlers.Callback(self._follow, indirect=False), history=True
        )
        self._closing.callback(subscriber.undeclare)
        self._declare("NN")

    def close(self):
        """End the node as a shutdown does."""
        self._closing.close()

    def graph(self):
        """The entities of all other nodes: (kind, node, topic)."""
        with self._lock:
            tokens = [token.split("/") for token, alive in self._graph.items() if alive]
        mine = str(self.session.zid())
        return {(t[5], t[8], t[9].replace("%", "/") if len(t) > 9 else "") for t in tokens if t[2] != mine}

    def advertise(self, topic, *, latched=False):
        """Create a publisher; a latched one is reliable and transient local."""
        options = {}
        if latched:
            options = {
                "publisher_detection": True,
                "cache": zenoh.ext.CacheConfig(max_samples=1),
                "sample_miss_detection": zenoh.ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=HEARTBEAT),
            }
        publisher = zenoh.ext.declare_advanced_publisher(
            self.session,
            key_of(topic, self._domain),
            congestion_control=zenoh.CongestionControl.DROP,
            reliability=zenoh.Reliability.RELIABLE,
            **options,
        )
        self._closing.callback(publisher.undeclare)
        gid = self._declare("MP", topic, LATCHED if latched else VOLATILE)
        self._publishers[topic] = publisher, gid, itertools.count(1)

    def publish(self, topic, payload):
        """Publish; return the attachment."""
        publisher, gid, numbers = self._publishers[topic]
        attachment = attachment_of(next(numbers), gid)
        publisher.put(payload, attachment=attachment)
        return attachment

    def subscribe(self, topic, *, latched=False):
        """Create a subscription: what it takes is in `heard[topic]` as (payload, attachment)."""
        heard = self.heard[topic] = []

        def take(sample):
            heard.append((bytes(sample.payload), bytes(sample.attachment)))

        options = {}
        if latched:
            options = {
                "subscriber_detection": True,
                "history": zenoh.ext.HistoryConfig(detect_late_publishers=True, max_samples=1),
                "recovery": zenoh.ext.RecoveryConfig(periodic_queries=None, heartbeat=True),
            }
        subscriber = zenoh.ext.declare_advanced_subscriber(
            self.session,
            key_of(topic, self._domain),
            zenoh.handlers.Callback(take, indirect=False),
            **options,
        )
        self._closing.callback(subscriber.undeclare)
        self._declare("MS", topic, LATCHED if latched else VOLATILE)

    def serve(self, service):
        """Answer calls with the request reversed, under the sequence number and gid of the request."""

        def answer(query):
            with query:
                number, gid = parts_of(bytes(query.attachment))
                query.reply(query.key_expr, bytes(query.payload)[::-1], attachment=attachment_of(number, gid))

        server = self.session.declare_queryable(
            key_of(service, self._domain), zenoh.handlers.Callback(answer, indirect=False), complete=True
        )
        self._closing.callback(server.undeclare)
        self._declare("SS", service, VOLATILE)

    def client(self, service):
        """Create a client; return a function that calls: payload in, answers out, and whether each is to this call."""
        querier = self.session.declare_querier(
            key_of(service, self._domain),
            target=zenoh.QueryTarget.ALL_COMPLETE,
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=20.0,
        )
        self._closing.callback(querier.undeclare)
        gid = self._declare("SC", service, VOLATILE)
        numbers = itertools.count(1)

        def call(payload):
            number = next(numbers)
            replies = list(querier.get(payload=payload, attachment=attachment_of(number, gid)))
            return [(bytes(r.ok.payload), parts_of(bytes(r.ok.attachment)) == (number, gid)) for r in replies]

        return call

    def _declare(self, kind, topic=None, qos=None):
        """Put a token of the graph on the network; return the gid of the entity, which is made of it."""
        domain, zid, number = self._domain, self.session.zid(), next(self._ids)
        token = f"@ros2_lv/{domain}/{zid}/0/{number}/{kind}/%/%/{self._name}"
        if topic is not None:
            token += f"/{topic.replace('/', '%')}/{TYPE}/{HASH}/{qos}"
        self._kept.append(self.session.liveliness().declare_token(token))
        return hashlib.md5(token.encode(), usedforsecurity=False).digest()

    def _follow(self, sample):
        with self._lock:
            self._graph[str(sample.key_expr)] = sample.kind == zenoh.SampleKind.PUT


def attachment_of(number, gid):
    """Sequence number, source timestamp [ns] and gid, as the serializer of zenoh-ext writes them."""
    ext = zenoh.ext
    return bytes(ext.z_serialize((ext.Int64(number), ext.Int64(time.time_ns()), gid)))


def parts_of(attachment):
    """Sequence number and gid of an attachment."""
    number, _, gid = zenoh.ext.z_deserialize(tuple[zenoh.ext.Int64, zenoh.ext.Int64, bytes], zenoh.ZBytes(attachment))
    return int(number), gid
