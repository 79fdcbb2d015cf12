"""The part of the status that tells of the process: its sessions, its queues, its bridge."""

from proxy.status.fields import BYTES, COUNT, SECONDS, Part, field
from proxy.status.network import Sized


class Sessions(Part):
    """The ids of the daemon's Zenoh sessions."""

    app: str = field("on the side of the applications")
    mesh: str = field("on the mesh")


class Flood(Part):
    """Messages of one kind that were too many."""

    messages: int = field("how many were too many so far", COUNT)
    age: float = field("how long ago the last one came", SECONDS)


class Extraction(Part):
    """The computing of features."""

    superseded: int = field("samples whose features were not computed, as a newer one came", COUNT)


class Reloads(Part):
    """Changed files that were read."""

    done: int = field("how often changed files were put in force", COUNT)
    refused: int = field("how often they were not, as there were mistakes", COUNT)
    problems: list[str] = field("the mistakes that keep changed files from being in force now")


class Denied(Part):
    """What rules of the bridge kept from crossing in one direction."""

    samples: int = field("samples so far", COUNT)
    queries: int = field("queries so far", COUNT)
    replies: int = field("replies so far", COUNT)
    subscribers: int = field("subscribers now", COUNT)
    queryables: int = field("queryables now", COUNT)
    tokens: int = field("liveliness tokens now", COUNT)


class BothDenied(Part):
    """What rules of the bridge kept from crossing."""

    out: Denied = field("from this robot's applications to the mesh")
    into: Denied = field("from the mesh to this robot's applications", alias="in")


class Surplus(Part):
    """Declarations that are too many to be mirrored in one direction."""

    subscribers: int = field("subscribers", COUNT)
    queryables: int = field("queryables", COUNT)
    tokens: int = field("liveliness tokens", COUNT)


class BothSurplus(Part):
    """Declarations that are too many to be mirrored."""

    out: Surplus = field("from this robot's applications to the mesh")
    into: Surplus = field("from the mesh to this robot's applications", alias="in")


class Link(Part):
    """A link of Zenoh's on the mesh."""

    zid: str = field("the session at its other end")
    source: str = field("our end")
    destination: str = field("its other end")


class Egress(Part):
    """What waits to be published on the mesh."""

    decided: int = field("decided samples", COUNT)
    passing: int = field("samples that pass without a decision", COUNT)
    risked: int = field("samples that may have been lost on a link that takes much less than the others", COUNT)


class Queue(Part):
    """Samples between their receipt and their being handed over."""

    covered: Sized = field("those that are decided")
    passing: Sized = field("those that only pass")
    most: Sized = field("how many of each kind may wait")


class Crossed(Part):
    """What crossed the bridge."""

    outward: int = field("from this robot's applications to the mesh", COUNT)
    inward: int = field("from the mesh to this robot's applications", COUNT)


class Expressions(Part):
    """Key expressions that are declared for others."""

    outward: list[str] = field("on the mesh, for this robot's applications")
    inward: list[str] = field("on this robot, for the mesh")


class ProfiledSamples(Part):
    """What crossed during a profile."""

    decided: int = field("samples that were decided", COUNT)
    passed: int = field("samples that passed without a decision", COUNT)
    delivered: int = field("samples of other robots that were delivered here", COUNT)


class Profile(Part):
    """The last profile that was taken with `sendworthy profile`."""

    robot: str = field("the robot")
    seconds: float = field("how long it took", SECONDS)
    looks: int = field("how often threads were looked at", COUNT)
    own: float = field("what the looking took", SECONDS)
    samples: ProfiledSamples = field("what crossed meanwhile")
    stages: dict[str, float] = field("processor time of each stage of the work", SECONDS)


class Recorded(Part):
    """What is written down with `sendworthy record`, or was last."""

    on: bool = field("whether the daemon records now")
    file: str = field("the file that is written now, or was last; empty while there is none yet")
    files: int = field("files written so far", COUNT)
    bytes: int = field("what was written so far", BYTES)
    events: int = field("events that the core saw meanwhile", COUNT)
    missing: int = field("those of them that are not in the recording", COUNT)
    problem: str = field(
        "why nothing can be written now, or why it cannot be replayed exactly; empty where all is well"
    )


class Broadcasting(Part):
    """The multicast session of a robot that broadcasts."""

    group: str = field("its group and port")
    interface: str = field("its network interface")
    heard: int = field("robots that are heard there", COUNT)
    reopened: int = field("how often it had to be opened anew", COUNT)


class Daemon(Part):
    """The process."""

    sessions: Sessions = field("its Zenoh sessions")
    app: list[str] = field("where it listens for applications")
    mesh: list[str] = field("where it listens for other robots")
    waiting: int = field("events that wait for the core", COUNT)
    faults: int = field("internal errors; the log has them", COUNT)
    refused: int = field("messages of other robots that came faster than they could be taken in", COUNT)
    floods: dict[str, Flood] = field("messages on Sendworthy's own keys that were too many, by kind")
    looks: int = field("how often it looked for applications that can be reached around it", COUNT)
    features: Extraction = field("the computing of features")
    reloads: Reloads = field("changed files that were read")
    specs: str = field("the folder or file of the specs")
    denied: BothDenied = field("what rules of the bridge kept from crossing")
    surplus: BothSurplus = field("declarations that are too many to be mirrored")
    links: list[Link] = field("its links on the mesh")
    held: int = field("payloads that are held", COUNT)
    returned: int = field("samples of other robots that came back to us, and were ignored", COUNT)
    egress: Egress = field("what waits to be published on the mesh")
    queue: Queue = field("samples between their receipt and their being handed over")
    delivered: int = field("samples of other robots that were delivered to applications here", COUNT)
    repeated: int = field("samples that came more than once, and were delivered once", COUNT)
    held_back: int = field("samples that wait for older ones of their stream", COUNT)
    subscriptions: list[str] = field("key expressions that applications here subscribe to")
    observed: list[str] = field("key expressions that are taken from applications here, as others want them")
    wanted: int = field("keys of applications here that somebody on another robot wants", COUNT)
    queries: Crossed = field("queries that crossed")
    queryables: Expressions = field("key expressions of queryables that are declared for others")
    profile: Profile | None = field("the last profile; only when one was taken", default=None)
    record: Recorded | None = field("the recording; only when there is one, or was", default=None)
    broadcast: Broadcasting | None = field("the multicast session; only where the robot broadcasts", default=None)
