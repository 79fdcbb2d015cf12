"""The constants of this package, each with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class DeclarationsTuning:
    """Bounds and times of following what others declare."""

    echo: float = 0.25
    """How long after its end a declaration of ours may still be told, and a token of ours be echoed [s]."""
    interests_timeout: float = 2.0
    """How long the interests of a mirror session may take to its main session [s]; they take a few milliseconds."""
    trial_timeout: float = 2.0
    """How long a query of a main session to its mirror session may take [s]; it takes some milliseconds."""
    trial_pause: float = 0.002
    """Time between two attempts of it [s]."""
    trial_payload: int = 65536
    """A payload that goes in fragments [B]."""
    queries_remembered: int = 1024
    """Queries whose options are remembered until somebody takes them; of more, the oldest are forgotten."""
    query_taken: float = 2.0
    """A query is taken this soon, or never [s]: of one whose queryable goes while it comes nobody is told. Without this
    bound each later query of its name had the options of the one before."""
    default_query_timeout: float = 60.0
    """For a query whose options are not known [s]."""
    key_and_encoding: int = 1024
    """Replies whose key and encoding take more go without source info [B], for the mark must stand in the first
    fragment."""
    before_mark: int = 64
    """What stands before the mark beside those is never longer [B]."""
    witness_depth: int = 24
    """So many chunks stand for `**` in the deeper of its two witnesses."""
    chunk: int = 65536
    """What is read from the tapped link at a time [B]."""


TUNING = DeclarationsTuning()
