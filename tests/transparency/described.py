"""What Zenoh hands to an application, as plain data: everything about it that an application can see."""

import hashlib

SHOWN = 64
"""Longer payloads are shown by their size and hash [B]."""


def sample(heard):
    """A sample, with every attribute."""
    return {
        "key": str(heard.key_expr),
        "kind": name(heard.kind),
        "payload": content(heard.payload),
        "encoding": str(heard.encoding),
        "attachment": content(heard.attachment),
        "priority": name(heard.priority),
        "congestion": name(heard.congestion_control),
        "express": heard.express,
        "stamp": stamp(heard.timestamp),
        "source": source(heard.source_info),
        "stack": stack(heard.timestamp_stack),
        "shared": heard.payload.as_shm() is not None,
    }


def query(asked):
    """A query as its queryable sees it."""
    return {
        "key": str(asked.key_expr),
        "parameters": str(asked.parameters),
        "payload": content(asked.payload),
        "encoding": None if asked.encoding is None else str(asked.encoding),
        "attachment": content(asked.attachment),
        "accepts": name(asked.accepts_replies()),
        "source": source(asked.source_info),
        "stack": stack(asked.timestamp_stack),
    }


def reply(given):
    """A reply or an error as the asker sees it."""
    replier = {"replier": None if given.replier_id is None else entity(given.replier_id)}
    if given.ok is not None:
        return sample(given.ok) | replier
    return {"kind": "ERROR", "payload": content(given.err.payload), "encoding": str(given.err.encoding)} | replier


def token(heard):
    """A liveliness token that came (PUT) or went (DELETE)."""
    return {"key": str(heard.key_expr), "kind": name(heard.kind)}


def miss(found):
    """Samples that an advanced subscriber missed."""
    return {"source": entity(found.source), "missed": found.nb}


def matching(status):
    """Whether anybody matches; the binding returns an object where its stubs promise a bool."""
    return bool(getattr(status, "matching", status))


def matching_event(status):
    """A change of it."""
    return {"matching": matching(status)}


def hello(found):
    """A node found by scouting."""
    return {"zid": str(found.zid), "what": str(found.whatami), "locators": sorted(found.locators)}


def content(payload):
    """A payload or an attachment."""
    if payload is None:
        return None
    data = bytes(payload)
    if len(data) > SHOWN:
        return f"{len(data)} B, {hashlib.sha256(data).hexdigest()[:12]}"
    return data.decode("latin-1")


def stamp(given):
    """A timestamp: its number and who stamped."""
    if given is None:
        return None
    return [given.get_time_as_ntp64().as_secs_f64(), str(given.get_id())]


def stack(given):
    """Where on its way a message was stamped when asked for."""
    if given is None:
        return None
    return [name(record.point) for record in given.records]


def source(given):
    """Who published, and the number the publisher gave."""
    return None if given is None else [*entity(given.source_id), given.source_sn]


def entity(identity):
    """The id of a publisher, queryable, …: that of its session, and its number there."""
    return [str(identity.zid), identity.eid]


def name(enumerated):
    """The name of a value of Zenoh's enumerations."""
    return str(enumerated).rpartition(".")[2]
