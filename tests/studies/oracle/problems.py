"""Small random problems, and their optimum by trying everything."""

from itertools import chain, combinations

from hypothesis import strategies as st

from planner import Constraint, Linear, Message, Problem, Stream, Traffic, Video
from planner.constraints import violations
from planner.definition import utility

TICK = 1 / 16
"""Times are multiples of this [s], so that messages lie exactly on the edges of windows."""

END = 4.0
SIZES = st.sampled_from([0.0, 1.0, 2.0, 3.0, 5.0])
LIMITS = st.sampled_from([1.0, 2.0, 3.0, 4.0])


@st.composite
def small_problems(draw: st.DrawFn) -> Problem:
    """At most nine messages of at most three streams; facts, traffic and oversized messages among them."""
    streams = draw(st.integers(1, 3))
    constraints = tuple(
        Constraint(f"c{k}", window=draw(st.sampled_from([0.25, 0.5, 1.0])), limit=draw(LIMITS))
        for k in range(draw(st.integers(1, 2)))
    )
    uses = st.tuples(*(SIZES for _ in constraints))
    latency = [draw(st.integers(0, 8)) * TICK for _ in range(streams)]
    times = sorted(draw(st.lists(st.integers(0, 48), min_size=1, max_size=9)))
    born = sorted((time * TICK, draw(st.integers(0, streams - 1))) for time in times)
    current = draw(st.integers(0, len(born) - 1))
    messages = tuple(
        Message(
            stream=stream,
            t_gen=t_gen,
            t_sent=t_gen,
            t_rcv=t_gen + latency[stream],
            utility=draw(st.sampled_from([Linear(1.0, 0.5), Linear(2.0, 4.0), Video(), Video(0.1, 0.9)])),
            scale=draw(st.sampled_from([0.0, 0.5, 1.0, 100.0])),
            use=draw(uses),
            sent=index != current and draw(st.sampled_from([False, False, False, True])),
        )
        for index, (t_gen, stream) in enumerate(born)
    )
    traffic = tuple(
        Traffic(draw(st.integers(-8, 48)) * TICK, draw(uses)) for _ in range(draw(st.sampled_from([0, 0, 1, 2])))
    )
    return Problem(tuple(map(Stream, range(streams))), messages, current, constraints, traffic, 0.0, END)


def best_by_trying(problem: Problem) -> float:
    """U of the best subset of the open messages that breaks no constraint."""
    opened = [index for index, message in enumerate(problem.messages) if not message.sent]
    subsets = chain.from_iterable(combinations(opened, count) for count in range(len(opened) + 1))
    return max(utility(problem, subset) for subset in subsets if not violations(problem, subset))


def one_stream(times: list[float], *, window: float, limit: float, sizes: list[float] | None = None) -> Problem:
    """Messages of one stream with a slowly fading utility, received at once."""
    uses = sizes or [1.0] * len(times)
    messages = tuple(
        Message(0, time, time, time, Linear(1.0, 0.125), 1.0, (use,)) for time, use in zip(times, uses, strict=True)
    )
    return Problem((Stream(0),), messages, 0, (Constraint("messages", window, limit),), (), 0.0, times[-1] + 1.0)
