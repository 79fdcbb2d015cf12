"""A profile as text for people."""

import math

from proxy.profiling.profile import Profile
from proxy.quantities import UNKNOWN, columns


def table(profile: Profile) -> str:
    """Say what each stage took: for a sample, of a core, of the daemon; and what crossed meanwhile."""
    samples, stages = profile.samples, profile.stages
    whole = sum(stages.values())
    rows = [("STAGE", "MS/SAMPLE", "OF A CORE", "OF THE DAEMON", "±")]
    for stage, spent in [*stages.items(), ("all", whole)]:
        each = f"{1e3 * spent / samples.total:.3f}" if samples.total else UNKNOWN
        part = f"{spent / whole:.1%}" if whole else UNKNOWN
        doubt = f"{_doubt(spent / whole, profile.looks):.1%}" if whole and profile.looks else UNKNOWN
        rows.append((stage, each, f"{spent / profile.seconds:.2%}", part, doubt))
    crossed = f"{samples.decided} samples decided, {samples.passed} passed, {samples.delivered} delivered"
    head = f"robot {profile.robot}   {profile.seconds:.1f} s   {crossed}"
    looks = f"{profile.looks} looks, which took {profile.own / profile.seconds:.2%} of a core besides"
    return "\n".join([head, "", *columns(rows, "lrrrr"), "", looks])


def _doubt(part: float, looks: int) -> float:
    """How far off a part may well be that was found in so many looks: one standard deviation."""
    return math.sqrt(part * (1.0 - part) / looks)
