"""The words that the status uses, and what they mean, for tables, `--explain` and docs/reference/status.md."""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Glossary:
    """Words of one kind: a `title`, and each with its meaning."""

    title: str
    words: Mapping[str, str]


REASONS = Glossary(
    "What became of a sample",
    {
        "forwarded": "it was decided on, and was worth sending",
        "passed:shadow": "mode shadow: it was sent although it would have been dropped",
        "passed:mode": "the mode or its type says that samples pass without a decision",
        "passed:no-spec": "no spec covers its key, so nothing is decided",
        "passed:unwanted": "no robot is known to want it, so it costs nothing",
        "passed:bypass": "the configuration or its type lets it bypass the planner",
        "passed:delete": "it is a deletion, which always passes",
        "passed:relayed": "it came from another robot and is passed on",
        "passed:fallback": "the planner failed or was late, and the limits had room",
        "dropped:planner": "others are worth more for what room there is",
        "dropped:constraint": "a limit has no room for it now",
        "dropped:once": "its type says 'once', and all who want it have one of this key ('sum' sends each)",
        "dropped:superseded": "a newer one of its stream came before its turn",
        "dropped:overflow": "too many waited to be decided",
        "dropped:full": "too many waited for the mesh",
        "dropped:too-large": "it is larger than a message may be on the mesh",
        "dropped:egress": "the mesh session did not take it",
        "dropped:denied": "the configuration keeps it on this robot",
        "dropped:heartbeat": "it only says that its publisher is alive, which the mesh knows anyway",
        "dropped:fallback": "the planner failed or was late, and there was no room",
        "dropped:no-spec": "a kept copy: no spec covers its key any more",
        "dropped:expired": "a kept copy: it became too old",
        "dropped:unwanted": "a kept copy: its robot does not want it any more",
        "dropped:gone": "a kept copy: its robot will not come back",
    },
)
MODES = Glossary(
    "Modes",
    {
        "enforce": "what is decided is done: samples that are not worth sending are dropped",
        "shadow": "it is decided and counted, and all samples are sent",
        "pass": "nothing is decided: a plain bridge",
    },
)
TEAM = Glossary(
    "The team",
    {
        "specs": "which utility specs are in force: a hash of what they say, the same on robots that agree",
        "coordination announce": "robots tell each other what they sent, and each plans for all",
        "coordination split": "each robot has a part of every limit",
        "transport unicast": "a sample goes to each robot that wants it, one after the other",
        "transport broadcast": "a sample goes to all robots at once",
        "takes no part": "a robot with other limits, or that this one does not understand: others plan without it",
    },
)
SAMPLES = Glossary(
    "Samples and decisions",
    {
        "in": "samples that this robot's applications published",
        "queued": "samples that wait to be decided or to be sent",
        "decided": "samples on which a search decided, and how many plans it tried for each",
        "time": "how long a decision takes",
        "proven optimal": "the search proved that no plan is better",
        "utility lost": "by how much the best plans may be better at most, in all",
        "scarce": "the limits that had no room for samples which were dropped",
        "last": "the last sample on which a search decided",
        "utility": "what a plan earns: what samples are worth, times how long they are the newest [utility·s]",
        "opposite": "the best plan that does not do with the sample what was done",
        "lead": "by how much sending the sample is better than not sending it; below 0 it is worse",
        "gap": "by how much some plan may still be better; 0: none is",
        "asks": "what a full limit asks for a sample like this one",
        "thinned": "windows with so many messages that some were left out, to decide in time",
        "late": "decisions that took too long: the sample went if it fitted",
        "kept": "copies that wait for robots that are away",
    },
)
RHYTHMS = Glossary(
    "Rhythms of streams",
    {
        "periodic ±4%": "samples come evenly, and vary by so much of the time between them",
        "bursts of 5": "so many samples come together, then none for a while",
        "over": "no more samples are expected",
    },
)
GLOSSARIES = (MODES, TEAM, SAMPLES, REASONS, RHYTHMS)


def reason(word: str) -> str:
    """Return what became of a sample, in words; nothing where the word is of another version."""
    return REASONS.words.get(word, "")
