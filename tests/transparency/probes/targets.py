"""Which queryables a query reaches, and which of their replies its asker gets."""

from tests.transparency.feature import feature

GROUP = "Targets and consolidation"
COMPLETE, INCOMPLETE = True, False
_ALL_ASKED = "A query is asked on for all queryables, complete or not, whatever its target was."
NAMES = {COMPLETE: "complete", INCOMPLETE: "incomplete", None: "none"}
PLACES = (
    # near, b, c
    (INCOMPLETE, INCOMPLETE, INCOMPLETE),
    (COMPLETE, INCOMPLETE, INCOMPLETE),
    (COMPLETE, COMPLETE, COMPLETE),
    (INCOMPLETE, COMPLETE, INCOMPLETE),
    (None, COMPLETE, INCOMPLETE),
    (None, INCOMPLETE, INCOMPLETE),
    (None, INCOMPLETE, None),
    (None, COMPLETE, COMPLETE),
    (COMPLETE, COMPLETE, None),
)


def answered(team, target, key="aim/*", selector="aim/it"):
    """Who answers a query from robot a, for every combination of queryables on the three robots."""
    seen = {}
    for kinds in PLACES:
        apps = {"near": team.a.other, "b": team.b.app, "c": team.c.app}
        declared = [
            app.queryable(key, answers=[{"reply": {"payload": where}}], complete=kind)
            for (where, app), kind in zip(apps.items(), kinds, strict=True)
            if kind is not None
        ]
        team.settle()
        replies = team.a.app.get(selector, target=target, consolidation="NONE", timeout=20.0)
        who = sorted(replies.heard("payload", over=True))
        words = zip(apps, kinds, strict=True)
        name = ", ".join(f"{where} {NAMES[kind]}" for where, kind in words if kind is not None)
        seen[name] = _either(who) if kinds[1] == kinds[2] else who
        for queryable in declared:
            queryable.undeclare()
    return seen


@feature(
    GROUP,
    "best matching",
)
def best_matching(team):
    """Who answers when the best matching queryable is asked: near, on b and on c, complete and incomplete."""
    return answered(team, "BEST_MATCHING")


@feature(GROUP, "all")
def everybody(team):
    """Who answers when all are asked."""
    return answered(team, "ALL")


@feature(
    GROUP,
    "all complete",
)
def all_complete(team):
    """Who answers when all complete ones are asked."""
    return answered(team, "ALL_COMPLETE")


@feature(
    GROUP,
    "overlapping queryables of a robot",
)
def overlapping(team):
    """Two applications of robot b with overlapping queryables: who answers a query with wildcards, by target."""
    team.b.app.queryable("aim/*", answers=[{"reply": {"payload": "first"}}], complete=True)
    team.b.other.queryable("aim/a", answers=[{"reply": {"key": "aim/a", "payload": "second"}}])
    team.b.other.queryable("aim/b", answers=[{"reply": {"key": "aim/b", "payload": "third"}}], complete=True)
    team.settle()
    seen = {}
    for target in ("BEST_MATCHING", "ALL", "ALL_COMPLETE"):
        for selector in ("aim/a", "aim/b", "aim/*"):
            replies = team.a.app.get(selector, target=target, consolidation="NONE", timeout=20.0)
            seen[f"{selector}, {target}"] = sorted(replies.heard("payload", over=True))
    return seen


@feature(GROUP, "to whom")
def locality(team):
    """A query for the session's own queryables only, for others only, for all."""
    team.a.app.queryable("aim/*", answers=[{"reply": {"payload": "own"}}])
    team.b.app.queryable("aim/*", answers=[{"reply": {"payload": "other"}}])
    team.settle()
    seen = {}
    for where in ("SESSION_LOCAL", "REMOTE", "ANY"):
        options = {"allowed_destination": where, "target": "ALL", "consolidation": "NONE", "timeout": 20.0}
        seen[where] = sorted(team.a.app.get("aim/it", **options).heard("payload", over=True))
    return seen


@feature(GROUP, "consolidation of one queryable's replies")
def consolidation(team):
    """Replies on one key, the newest not last, some without timestamp: what each mode lets through."""
    stamps = (-10, 0, -20)
    answers = [{"reply": {"payload": str(stamp), "timestamp": stamp}} for stamp in stamps]
    team.b.app.queryable("aim/stamped", answers=answers)
    team.b.app.queryable("aim/plain", answers=[{"reply": {"payload": str(number)}} for number in range(3)])
    team.settle()
    seen = {}
    for mode in ("NONE", "MONOTONIC", "LATEST", "AUTO"):
        for key in ("aim/stamped", "aim/plain", "aim/stamped?_time=[now(-1h)..]"):
            replies = team.a.app.get(key, consolidation=mode, timeout=20.0)
            seen[f"{key}, {mode}"] = replies.heard("payload", over=True)
    return seen


@feature(GROUP, "consolidation of replies from several robots")
def consolidation_of_robots(team):
    """Replies on one key from three robots with different timestamps: what each mode lets through."""
    for robot, stamp in ((team.a, -20), (team.b, 0), (team.c, -10)):
        robot.other.queryable("aim/*", answers=[{"reply": {"payload": robot.name, "timestamp": stamp}}])
    team.settle()
    seen = {}
    for mode in ("NONE", "LATEST", "AUTO"):
        replies = team.a.app.get("aim/it", target="ALL", consolidation=mode, timeout=20.0)
        seen[mode] = sorted(replies.heard("payload", over=True))
    return seen


def _either(who):
    """Of two that are alike Zenoh takes either."""
    return sorted("b or c" if one in ("b", "c") and not {"b", "c"} <= set(who) else one for one in who)
