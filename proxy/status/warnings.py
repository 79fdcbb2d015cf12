"""What in a daemon's status needs attention, in words."""

from proxy.quantities import Status

RECENT = 60.0
"""So long robots of another version are silent that have been upgraded, and nobody has to do anything [s]."""
_NOT_MALFORMED = (":other version", ":flood", ":unknown", ":unproved")


def warnings(status: Status) -> list[str]:
    """Return what is wrong: what the daemon says itself, then what its counts show."""
    found = [str(warning) for warning in status.get("warnings", ())]
    if not all(status.get(ledger, {}).get("conserved", True) for ledger in ("counts", "kept")):
        found.append("the counts do not add up: please report this")
    return [*found, *_failures(status), *_messages(status)]


def _failures(status: Status) -> list[str]:
    """Return what the daemon could not do as it should."""
    found = list[str]()
    if status.get("daemon", {}).get("faults"):
        found.append(f"internal errors: {status['daemon']['faults']}, see the log")
    reasons, late = status.get("counts", {}).get("by_reason", {}), status.get("decisions", {}).get("late", 0)
    if (failed := sum(reasons.get(each, 0) for each in ("passed:fallback", "dropped:fallback")) - late) > 0:
        found.append(f"{failed} samples were decided without a plan, as the planner failed: see the log")
    return found


def _messages(status: Status) -> list[str]:
    """Return what could not be read, told or remembered."""
    found = list[str]()
    if status.get("malformed"):
        refused = status.get("refused", {}).items()
        kinds = ", ".join(f"{count} {kind}" for kind, count in refused if not kind.endswith(_NOT_MALFORMED))
        found.append(
            f"{status['malformed']} malformed messages on Sendworthy's keys were ignored" + f" ({kinds})" * bool(kinds)
        )
    if status.get("other_version") and (status.get("other_version_age") or 0.0) < RECENT:
        found.append(f"{status['other_version']} messages of another version of Sendworthy were not understood")
    if unproved := status.get("refused", {}).get("order:unproved"):
        found.append(f"{unproved} orders were refused: who gave them did not prove to know fleet.token")
    if status.get("evicted"):
        found.append(f"{status['evicted']} streams or robots were forgotten: there are too many")
    if status.get("untold"):
        found.append(f"{status['untold']} streams, subscriptions or origins are too many to tell the others")
    if status.get("daemon", {}).get("refused"):
        found.append(f"{status['daemon']['refused']} messages of other robots came faster than they could be taken in")
    return found
