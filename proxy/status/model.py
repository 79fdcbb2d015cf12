"""The format of the status in JSON, as types: `sendworthy schema status` prints the schema that is made of them.

Its version rises when a field is renamed, goes, or means something else; fields may be added without. What the
parts of the daemon say is checked against it by tests.
"""

from typing import Any, Literal

from proxy.status.daemon import Daemon
from proxy.status.fields import COUNT, SECONDS, Part, field
from proxy.status.network import Digests, Limit, OnAir, Peer
from proxy.status.samples import Counts, Decisions, Feature, Kept, Mode, Stream

DIALECT = "https://json-schema.org/draft/2020-12/schema"


class Status(Part):
    """What a daemon says of itself. Times are ages or durations; of wants, counts and prices it says what it knows."""

    status_version: Literal[1] = field("the version of this format", "version")
    robot: str = field("the robot's name on the mesh")
    version: str = field("the Sendworthy that it runs")
    wire_version: int = field("the version of the protocol that daemons speak with each other", "version")
    zid: str = field("the id of its session on the mesh")
    mode: Mode = field("what it does with decisions")
    specs: str = field("the generation of its specs: a hash of what they say")
    coordination: Literal["announce", "split"] = field("how robots keep limits together now")
    transport: str = field("how samples travel on the mesh")
    wall_error: float | None = field("what its wall clock is wrong by at most; null if nobody knows", SECONDS)
    uptime: float = field("how long it runs", SECONDS)
    counts: Counts = field("what became of samples")
    kept: Kept = field("copies for robots that are away")
    decisions: Decisions = field("how it was decided")
    budget: list[Limit] = field("the limits in force")
    on_air: OnAir = field("what this robot put on the air")
    digests: Digests = field("what robots tell each other about streams and channel")
    streams: list[Stream] = field("the streams that it knows, its own and others'")
    features: list[Feature] = field("what is computed from samples")
    peers: list[Peer] = field("the other robots")
    warnings: list[str] = field("what needs attention, in words")
    malformed: int = field("messages on Sendworthy's keys that could not be read or believed", COUNT)
    other_version: int = field("messages of versions of Sendworthy that were not understood", COUNT)
    other_version_age: float | None = field("how long ago the last of them came", SECONDS, default=None)
    refused: dict[str, int] = field("messages on Sendworthy's keys that changed nothing, by kind", COUNT)
    evicted: int = field("streams and robots that were forgotten, as there are too many", COUNT)
    untold: int = field("streams, subscriptions and origins that are too many to tell the others", COUNT)
    asked: int = field("states of other robots that were asked for", COUNT)
    daemon: Daemon = field("the process")


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of the status. A field that a later Sendworthy adds is no reason to refuse it."""
    from proxy.core.status import STATUS_VERSION  # noqa: PLC0415 - the core, which whoever asks a daemon does without

    schema = Status.model_json_schema()
    for table in (schema, *schema["$defs"].values()):
        table.pop("additionalProperties", None)
        for each in table.get("properties", {}).values():
            each.pop("title", None)
    return {"$schema": DIALECT} | schema | {"title": f"Sendworthy status, version {STATUS_VERSION}"}
