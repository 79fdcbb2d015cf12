"""The page that says feature by feature whether applications see a difference."""

import json
from itertools import groupby
from pathlib import Path

from tests.transparency.feature import Bug, differences

PAGE = Path(__file__).parent.parent.parent / "deploy" / "TRANSPARENCY.md"
SHOWN = 160
"""Longer observations are cut [characters]."""

_HEAD = """# What applications see

Two robots behind Sendworthy, in mode `pass`, are to their applications like two robots behind Zenoh routers that are
linked. This page says feature by feature how far that is true. It is written by `make transparency`, which runs every
feature in three arrangements of real processes, each robot a host of its own, and compares what the applications saw:

- *one router*: the applications of all robots at one router;
- *two routers*: a Zenoh router on each robot, linked over the channel, everything by default. This is what the others
  are compared with;
- *two daemons*: `sendworthy run` on each robot, everything by default but its name, its mode and its radio.

A third robot of the same kind is always on the channel. `same` means: every observation is the same as with two
routers. Each `differs` is listed below its table with what was seen and why; the tests fail when any other difference
is found, and also when one of these is not. That daemons with TLS or with user and password on the mesh talk to their
like and to nobody else is tested beside it.
"""


def page(found):
    """The page; `found` has for each feature the transcripts by arrangement."""
    parts = [_HEAD, _summary(found)]
    for group, features in groupby(found, key=lambda feature: feature.group):
        rows = list(features)
        parts.append(f"## {group}\n")
        parts.append(_table({feature: found[feature] for feature in rows}))
        parts += [note for feature in rows for note in _notes(feature, found[feature])]
    return "\n".join(parts)


def _summary(found):
    same = sum(not differences(seen["routers"], seen["daemons"]) for seen in found.values())
    bugs = sum(any(isinstance(limit, Bug) for limit in feature.limits) for feature in found)
    known = f" {bugs} of the others are bugs that are known." if bugs else ""
    return f"Of {len(found)} features, {same} are the same with two daemons as with two routers.{known}\n"


def _table(found):
    lines = ["| feature | what is compared | one router | two daemons |", "|---|---|---|---|"]
    for feature, seen in found.items():
        cells = (feature.name, feature.compared, *(_verdict(seen, which) for which in ("direct", "daemons")))
        lines.append(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |")
    return "\n".join(lines) + "\n"


def _verdict(seen, which):
    return "differs" if differences(seen["routers"], seen[which]) else "same"


def _notes(feature, seen):
    """The differences of one feature: those of the daemons by reason, then Zenoh's own."""
    for limit in feature.limits:
        kind = "Two daemons, a known bug" if isinstance(limit, Bug) else "Two daemons"
        yield _note(feature, f"{kind}: {limit.reason}", "two daemons", limit.differs)
    own = differences(seen["routers"], seen["direct"])
    if own:
        yield _note(feature, "One router: so Zenoh itself.", "one router", own)


def _note(feature, why, which, differs):
    lines = [f"- *{feature.name}*. {why}"]
    for name, (routers, other) in differs.items():
        lines.append(f"  - `{name}`: two routers {_shown(routers)}, {which} {_shown(other)}")
    return "\n".join(lines) + "\n"


def _shown(value):
    text = json.dumps(value, ensure_ascii=False)
    return f"`{text if len(text) <= SHOWN else text[:SHOWN] + '…'}`"
