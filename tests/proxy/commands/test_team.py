"""What daemons say of their team."""

from proxy.commands.team import notes_on, robots_of

NONE = "0" * 12
LIMIT = {"constraint": "throughput", "limit": 125_000.0, "unit": "B", "window": 0.5}


def status(robot, mode="enforce", specs=NONE, peers=(), budget=()):
    return {"robot": robot, "mode": mode, "specs": specs, "peers": list(peers), "budget": list(budget)}


def test_robots_are_those_that_anyone_knows():
    """Each once, by name."""
    assert robots_of([status("r2", peers=[status("r1")]), status("r1", peers=[status("r3")])]) == ["r1", "r2", "r3"]
    assert robots_of([]) == []


def test_who_drops_samples_is_named():
    """Whoever decides by specs; in other modes, and without specs, everything is heard."""
    peers = [status("r2", specs="ab"), status("r3", "shadow", "ab"), status("r4", "pass", "ab"), status("r5", specs="")]
    (note,) = notes_on([status("r1", specs="ab", peers=peers)])
    assert note.startswith("In mode enforce, with specs: r1, r2. What they dropped was not heard")
    assert notes_on([status("r1", peers=[status("r2")])]) == []


def test_limits_in_force_are_told():
    """As they were found."""
    assert notes_on([status("r1", budget=[LIMIT])]) == ["In force at r1 now: throughput: 125000 B in any 0.5 s."]
    (note,) = notes_on([status("r1", budget=[LIMIT | {"adaptive": {"in_force": 0.4}}])])
    assert note.endswith(": 125000 B in any 0.5 s, of which 40 %, as the channel is.")
