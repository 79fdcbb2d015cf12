"""The constants of this package, each with why it is what it is."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class WindowTuning:
    """Constants of the problem of one decision, and of what guarantees demand."""

    forecasts_of_a_stream: int = 512
    """Messages forecast of one stream at most."""
    contested_at_least: float = 0.1
    """This part of a limit is left at least to what is contested."""
    shortest_life: float = 1e-3
    """The last message of a window lives at least this long [s]."""
    facts_of_a_stream: int = 16
    """Of the messages last sent of a stream this many are facts where more than one counts."""
    forecasts_of_best: int = 24
    """Forecasts of a stream planned for where the best message counts: time grows with their square."""
    messages_of_a_model: int = 3
    """Waiting samples, and forecasts, of the operator's aggregation, which may have a state for each set of them."""
    offered: float = 1.5
    """Where streams offer more than this times what the limits carry, plans expect the smallest samples to be sent:
    two, four and eight robots with frames of 26 kB send 6, 9 and 3 % more bytes so."""
    rival_worth: float = 0.5
    """Of what is offered only that counts which is worth at least this part as much a byte (1 % more)."""
    sent_at_least: float = 0.05
    """No smaller part of the samples is expected to be sent."""
    bulky: float = 0.25
    """That is so of messages that take more than this part of a limit..."""
    varied: float = 0.05
    """... whose sizes deviate by more than this part, and which come by a rhythm (else twice as many windows over)."""
    overheard_within: float = 0.02
    """We overhear a sample this much later at most, besides latency, digests' delay and jitter [s]: with 0.05 twelve
    robots with samples at random reached 72 % of a central decider instead of 75..."""
    agreed_within: float = 0.01
    """... and where all plans agree this much: ten robots reached 1 to 4 % less with five times as much."""
    early: float = 0.1
    """The next sample of a guaranteed stream may come earlier than expected by this part of the period."""
    overhead: float = 0.5
    """All of a decision but the search should take no more than this part of the deadline."""
    seconds_per_message: float = 50e-6
    """What a message of a mixed window takes on one x86 core [s], until the first decisions were made."""
    fewest_messages: int = 12
    """A window may always hold this many messages besides the current one: then they take less than 1 ms."""
    overruns: int = 3
    """This many decisions in a row must take too long before messages are left out..."""
    shrinking: float = 0.5
    """... and then this part of the messages stays at least, for there may be other reasons..."""
    growing: float = 1.1
    """... and one in time allows this many times as many."""


TUNING = WindowTuning()
