"""What is asked of teams, and whether it is met."""

from dataclasses import replace

from studies.simulation.traffic.comparison import PLAN, Cell, Result, Task
from studies.simulation.traffic.targets import target_table
from tests.studies.simulation.traffic.flown import SCORE

CELL = Cell("random", 5, 0.02, 0.01, 0, 30.0)


def flown(name, utility, sent=9e5, score=SCORE, **where):
    return Result(Task(replace(CELL, **where), name), utility, sent, 1, 0.0, score)


def rows(*results):
    return {what: (asked, measured, met) for what, asked, measured, met in target_table(results).rows}


def test_the_worst_of_all_conditions_counts():
    """Of a team, and of the central decider itself."""
    found = rows(
        flown("bound", 100.0, score=None),
        flown("central", 95.0),
        flown("greedy", 96.0, score=replace(SCORE, over=0.0)),
        flown("x/unicast", 93.0),
        flown("central", 95.0, latency=0.05),
        flown("x/unicast", 76.0, latency=0.05),
    )
    assert found["central: of the bound"] == ("≥ 90 %", "95.0 % (random:5 20 ms 1 %)", "yes")
    assert found["central: beside greedy"][1:] == ("99.0 % (random:5 20 ms 1 %)", "no")
    assert found["x/unicast: contested, to 100 ms: of central"][1:] == ("80.0 % (random:5 50 ms 1 %)", "no")
    assert found["x/unicast: beside policies that keep the limit"][2] == "no"
    assert found["x/unicast: windows over"][2] == "yes"
    assert found["x/unicast: told, of what may be"][1].startswith("12.0 %")
    assert not any("uniform" in what or "300 ms" in what for what in found)


def test_policies_that_break_the_limit_are_no_rivals():
    """Nobody is asked to be worth what they are."""
    found = rows(flown("central", 90.0), flown("static", 99.0), flown("x/unicast", 89.0))
    assert "x/unicast: beside policies that keep the limit" not in found


def test_a_window_may_exceed_by_a_tenth_or_a_message():
    """By whichever is more."""
    name = "x/unicast: fullest window, beside 1.1 limits or a message more than one"
    assert rows(flown("x/unicast", 1.0))[name][2] == "yes"
    small = replace(SCORE, largest=0.01)
    assert rows(flown("x/unicast", 1.0, score=small))[name][1:] == ("109.1 % (random:5 20 ms 1 %)", "no")


def test_uniform_is_even_over_latencies():
    """Beside the next latency, and at the worst."""
    shares = {0.02: 98.0, 0.1: 97.0, 1.0: 93.0}
    results = [
        flown(name, u, workload="uniform-few", latency=t)
        for t, share in shares.items()
        for name, u in (("central", 100.0), ("x/unicast", share))
    ]
    found = rows(*results)
    assert found["x/unicast: uniform, to 100 ms: of central"][1:] == ("97.0 % (uniform-few:5 100 ms 1 %)", "yes")
    assert found["x/unicast: uniform, every latency: of central"][2] == "yes"
    assert found["x/unicast: uniform, beside the next latency"][1:] == ("4.0 points (uniform-few 1000 ms)", "no")


def test_mixed_goes_by_bytes_small_samples_and_alarms():
    """Beside the best plan of the same mission."""
    plan = flown(PLAN, 100.0, sent=1e6, score=None, workload="mixed")
    found = rows(plan, flown("x/broadcast", 90.0, workload="mixed"))
    assert found["x/broadcast: mixed: bytes of the best plan"][1:] == ("90.0 % (mixed:5 20 ms 1 %)", "no")
    assert found["x/broadcast: mixed: small samples sent"][2] == "yes"
    assert found["x/broadcast: mixed: alarms sent"][1:] == ("85.7 % (mixed:5 20 ms 1 %)", "no")


def test_loss_is_judged_where_all_hear_all():
    """At the usual latency."""
    found = rows(
        flown("central", 100.0, loss=0.1), flown("x/broadcast", 96.0, loss=0.1), flown("x/unicast", 50.0, loss=0.1)
    )
    assert found["x/broadcast: loss of 10 %: of central"][2] == "yes"
    assert "x/unicast: loss of 10 %: of central" not in found
