"""How much the bridge remembers, and how much it takes in of others, each with why: nobody may use up this robot."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType


def _crossing() -> Mapping[str, int]:
    return MappingProxyType({"subscribers": 2048, "queryables": 2048, "tokens": 16384})


@dataclass(frozen=True, slots=True)
class BridgeBounds:
    """Where a rate is bounded, so is what may come at once."""

    # Keys and declarations
    keys: int = 8192
    """Keys of which something is remembered, in each place that is asked for every sample."""
    expressions: int = 65536
    """Declared key expressions of which it is remembered whether they cross, for each direction."""
    crossing: Mapping[str, int] = field(default_factory=_crossing)
    """Declarations of a kind that cross at a time. While one peer declared thousands, samples waited at most 0.3 s with
    this bound, 0.8 s with twice of it and 9.5 s without any."""
    declarations: int = 16384
    """Declarations of one kind in one direction; more are refused and said."""
    demanded_keys: int = 1024
    """Keys whose demand is followed; of more, one node is assumed to want them."""
    markers: int = 16
    """Markers under way between a main session and its mirror session: few are, for of each direction one is."""
    queries: int = 1024
    """Queries under way in one direction; more are answered with an error."""
    queries_of_one: int = 768
    """Those of them for one queryable: a service that answered none kept all others from being asked for as long as
    queries last."""
    jobs: int = 8192
    """Jobs that may wait for a serial executor."""
    waiting_for_jobs: int = 3
    """So many threads may wait for room in one. They are Zenoh's, which receives with twelve."""

    # Samples from the mesh
    received_keys: int = 1024
    """Keys of which it is remembered what came; that of which nothing came for longest is forgotten."""
    received_samples: int = 512
    """Samples remembered of each of these keys: twice as many as a robot may keep for another one."""
    stamped_samples: int = 4096
    """Of so many samples, and of up to as many before them, it is remembered that they left with our stamp. What comes
    around the daemons does so in milliseconds."""
    held_samples: int = 4096
    """Samples held back; where there are more, streams are not in order."""
    held_bytes: int = 16 * 1024 * 1024
    """Their bytes [B]."""
    held_robots: int = 64
    """Robots that are waited for, or will be when they return."""
    held_origins: int = 1024
    """Origins of samples that it is remembered of which robot they are."""
    returns: float = 0.2
    """Robots that are waited for in a second: tokens that come and go hold up nobody."""
    returns_at_once: float = 16.0
    """Robots that are waited for at once."""

    # What daemons tell each other
    echoed_digests: int = 64
    """Of so many of our digests an echo is understood."""
    digests: float = 200.0
    """Digests that one robot may say in a second."""
    all_digests: float = 1000.0
    """Digests that all robots together may say in a second."""
    digest_bytes: float = 500.0
    """A digest that is longer than this counts as so many more of them [B]."""
    states: float = 10.0
    """States that one robot may say in a second. What is told of robots that nobody knows is not read."""
    all_states: float = 40.0
    """States that all robots together may say in a second."""
    backlogs: float = 100.0
    """Words on backlogs that one robot may say in a second."""
    all_backlogs: float = 400.0
    """Words on backlogs that all robots together may say in a second."""
    answers: int = 50
    """Questions for our state that are answered in a second."""
    states_to_all: float = 2.0
    """Where there are more all are told it, so far apart [s]: who asks without end kept newcomers from it for good."""
    order_bytes: int = 2 * 1024 * 1024
    """An order is no longer than this [B]."""
    proof_bytes: int = 256 * 1024
    """Nor the proofs beside it, for all robots together: some 90 B for each [B]."""
    answer_bytes: int = 1024 * 1024
    """Nor what one robot answers to it; to read that takes up to 26 times as much memory [B]."""
    answers_bytes: int = 16 * 1024 * 1024
    """Answers to one order are no longer than this, all together [B]."""

    # What this robot's applications ask the daemon
    question_bytes: int = 16 * 1024
    """A question is no longer than this, of which a key takes most. One of 26 MB held up all decisions for 3 s [B]."""

    # Presence tokens
    tokens: int = 1024
    """Tokens known at once; more are not believed. Half of them may be of sessions to which there is no link."""
    token_changes: float = 1.0
    """Changes of one robot that are told in a second: each has all robots share the channel anew."""
    token_changes_at_once: float = 6.0
    """Changes of one robot that are told at once."""
    all_token_changes: float = 50.0
    """Changes of all robots that are told in a second."""
    all_token_changes_at_once: float = 300.0
    """Changes of all robots that are told at once."""
    token_retry: float = 0.1
    """What is too much is looked at again after this time [s]."""
    links_listed: float = 0.2
    """Links are listed anew this often at most where none is known to have come or gone [s]."""
    unlinked_retry: float = 1.0
    """A token of whom there is no link to is looked at again after this time [s]."""
    name_length: int = 128
    """Letters in the name of a robot."""

    # What is said of it
    flood: float = 10.0
    """More messages of a kind that are not taken in than this in a second are a flood."""
    flood_at_once: float = 100.0
    """As are more than this at once."""
    warnings_apart: float = 60.0
    """The log repeats this often that there is a flood, that more is declared than crosses, or that samples may have
    been lost on a slow link [s]."""


BOUNDS = BridgeBounds()
