"""What the daemons tell each other in digests, as each limit counts it: to the core and to `sendworthy check`."""

from planner.measures import Measure

LEAST_RATE = 100.0
"""What the digests of a team may use whatever the limit is, for each of its robots [B/s]."""
LEAST_LEFT = 0.1
"""Part of a limit that digests leave to samples in any case."""
SMALLEST = 64
"""A digest counts as at least this large [B], so that so many bytes are at most so many digests."""
TEAM = 4
"""So many robots are a team where nobody knows yet how many there will be."""
MUCH = 0.25
"""A limit of which more than this part is for digests is hardly meant."""


def use_per_byte(measure: Measure, robots: int) -> float:
    """What digests use per byte at most, all copies together: the smallest ones use most [`measure.unit`/B]."""
    copies = max(1, robots - 1)
    return measure.use(SMALLEST, copies, own=True) / (SMALLEST * copies)


def users(measure: Measure, robots: int) -> int:
    """How many robots' digests count."""
    return 1 if measure.private else robots


def least_use(measure: Measure, robots: int) -> float:
    """What digests may use of a window whatever the limit is [`measure.unit`]."""
    return LEAST_RATE * use_per_byte(measure, robots) * measure.window * users(measure, robots)


def left_by(digests: float, measure: Measure) -> float:
    """What a window holds for samples, beside so much for digests [`measure.unit`]."""
    return max(measure.limit - digests, LEAST_LEFT * measure.limit)


def least_limit(robots: int) -> float:
    """The rate of which `MUCH` is for digests [B/s]: a lower one leaves little to samples."""
    return LEAST_RATE * robots / MUCH


def warning(measure: Measure, robots: int) -> str:
    """Say that digests leave too little of a limit to samples; nothing where they do not, as nobody is told any."""
    if robots < 2:
        return ""
    left = left_by(least_use(measure, robots), measure)
    if left >= (1.0 - MUCH) * measure.limit:
        return ""
    share, holds = 1.0 - left / measure.limit, float(f"{left:.3g}")
    return (
        f"{100.0 * share:.0f} % of it is for what the daemons of {robots} robots tell each other, "
        f"{LEAST_RATE:g} B/s for each, which leaves {holds:g} {measure.unit} in {measure.window:g} s to samples: "
        "raise it, or set the same rate over a longer window, until each robot's part holds a sample"
    )
