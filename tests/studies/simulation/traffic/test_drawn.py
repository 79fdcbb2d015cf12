"""Workloads that are drawn: what is flown, and what is written of it."""

from datetime import date

import pytest

from studies.simulation.traffic import audiences, drawn, unequal_teams


def reached(seed, part, over=0.0, sustained=0.9):
    """What may have come of what a seed draws."""
    return drawn.Reached(drawn.drawn_by(seed), part, over, 1.1, sustained, (0.5, 0.9), (3.0, 2.0))


def test_a_seed_draws_the_same_workload_again():
    """Another one draws another."""
    assert drawn.drawn_by(3) == drawn.drawn_by(3)
    assert drawn.drawn_by(3).label != drawn.drawn_by(4).label


def test_each_day_has_its_own_seeds():
    """However many are drawn."""
    today, next_day = (drawn.first_seed(date(2026, 12, day)) for day in (30, 31))
    assert next_day >= today + 1000
    assert drawn.drawn_by(today).label != drawn.drawn_by(next_day).label


def test_an_unequal_team_differs_from_the_equal_one_of_its_seed_in_its_robots():
    """Limit, number of robots and kinds are the same, with one kind more; lines and pages tell of it."""
    for seed in range(20):
        equal, unequal = drawn.drawn_by(seed), drawn.drawn_by(seed, unequal=True)
        assert drawn.drawn_by(seed, unequal=True) == unequal
        assert (unequal.workload.rate, unequal.workload.window) == (equal.workload.rate, equal.workload.window)
        assert len(unequal.workload.robots) == len(equal.workload.robots)
        names = {kind.name for kind in equal.workload.kinds}
        assert {kind.name for kind in unequal.workload.kinds} <= names | {f"kind-{len(names)}"}
        assert f"{len(equal.workload.robots)} unequal robots" in unequal.label
        assert "unequal" not in equal.label


def test_equal_teams_are_those_that_were_always_drawn():
    """Else the figures of two versions tell nothing of them."""
    assert drawn.drawn_by(1).label == (
        "1: 4 robots, unicast, 20 ms, 0 s before, 3 Mbit/s, 1 s: Step 12.5 Hz 0.02 limits, Linear 0.4 Hz 0.09 limits,"
        " Video 1.2 Hz 0.22 limits"
    )
    assert drawn.drawn_by(20261129140).label == (
        "20261129140: 4 robots, unicast, 2 ms, 5 s before, 0.3 Mbit/s, 1 s: Linear 4.0 Hz 0.02 limits at rand"
        "om, Linear 1.5 Hz 0.20 limits, Linear 1.0 Hz 0.05 limits"
    )


def test_some_unequal_teams_lose_samples_or_are_slow():
    """And their labels say so."""
    teams = [drawn.drawn_by(seed, unequal=True) for seed in range(40)]
    assert {team.how.loss for team in teams} == set(unequal_teams.LOSSES)
    assert {team.how.latency for team in teams} == set(unequal_teams.LATENCIES)
    assert all(("1% lost" in team.label) == (team.how.loss > 0.0) for team in teams)


def test_what_offers_less_than_the_limit_is_not_flown():
    """Nor what offers so much that no robot has anything."""
    loads = {seed: drawn.drawn_by(seed).load for seed in range(60)}
    least, most = drawn.LOADS
    assert min(loads.values()) < least
    assert all(drawn.reach(seed, 8.0) is None for seed, load in loads.items() if not least < load < most)


@pytest.mark.full
def test_the_page_shows_the_worst_first(tmp_path, capsys):
    """All are printed; the page has as many rows as were flown."""
    page = tmp_path / "drawn.md"
    flown = [seed for seed in range(30) if drawn.LOADS[0] < drawn.drawn_by(seed).load < 4.0]
    first = next(seed for seed in flown if len(drawn.drawn_by(seed).workload.robots) <= 4)
    arguments = ["--first", str(first), "--seeds", "1", "--seconds", "10", "--jobs", "1", "--output", str(page)]
    assert drawn.main(arguments) == 0
    printed, last = capsys.readouterr().out.splitlines()
    assert drawn.drawn_by(first).label in printed
    assert last.startswith("1 flights, ")
    assert drawn.drawn_by(first).label in page.read_text()
    assert f"--first {first} --seeds 1 --seconds 10" in page.read_text()


@pytest.mark.full
def test_unequal_teams_are_flown_where_they_are_asked_for(tmp_path, capsys):
    """The page says how they differ, and how to fly them again; 10 s that hold more than they may are a failure."""
    page = tmp_path / "drawn.md"
    first = next(s for s in range(60) if (d := drawn.drawn_by(s, unequal=True)).disputed and len(d.workload.robots) < 4)
    arguments = ["--first", str(first), "--seeds", "1", "--seconds", "10", "--jobs", "1", "--output", str(page)]
    assert drawn.main([*arguments, "--unequal", "--at-most", "0.01"]) == 1
    assert drawn.drawn_by(first, unequal=True).label in capsys.readouterr().out
    assert f"--first {first} --seeds 1 --seconds 10 --unequal" in page.read_text()
    assert unequal_teams.TOLD in page.read_text()


def test_audiences_are_drawn_beside_the_team_of_a_seed():
    """It is the same one, in unicast; its label tells who wants what."""
    for seed in range(20):
        plain = drawn.drawn_by(seed, unequal=True)
        shared = drawn.drawn_by(seed, unequal=True, shared=True)
        assert shared == drawn.drawn_by(seed, unequal=True, shared=True)
        assert shared.workload == plain.workload
        assert not shared.how.broadcasts
        assert all(f" {audience.label}" in shared.label for audience in shared.wanted.values())
        assert shared.interests(30.0) == shared.interests(30.0)


@pytest.mark.full
def test_teams_fly_with_audiences_of_their_own(tmp_path, capsys):
    """What all get counts: one decider sends the same copies, and the operator's looks are the same."""
    page, found = tmp_path / "drawn.md", None
    for seed in range(200):
        found = drawn.drawn_by(seed, shared=True)
        several = any(each.viewed for each in found.wanted.values()) and len(found.wanted) > 1
        if found.disputed and several and found.load < 6.0 and len(found.workload.robots) <= 4:
            break
    else:
        pytest.fail("no seed draws a small team with audiences")
    arguments = ["--first", str(found.seed), "--seeds", "1", "--seconds", "15", "--jobs", "1", "--output", str(page)]
    assert drawn.main([*arguments, "--audiences"]) == 0
    printed = capsys.readouterr().out
    assert found.label in printed
    assert 80.0 < float(printed.partition("%")[0]) < 120.0
    assert audiences.TOLD in page.read_text()
    assert "--seconds 15 --audiences" in page.read_text()


@pytest.mark.full
def test_where_nothing_is_disputed_nothing_is_flown(capsys):
    """And the command says so."""
    with pytest.raises(SystemExit):
        drawn.main(["--first", "0", "--seeds", "1", "--jobs", "1"])
    assert "something to dispute" in capsys.readouterr().err


def test_the_last_line_has_the_worst_of_all():
    """Of one flight that was good and one that was not."""
    found = [reached(1, 0.9, 0.0, 0.8), reached(2, 0.7, 0.02, 1.4)]
    assert (
        drawn.last_line(found)
        == "2 flights, 80.0% of central (70.0% at least), 1.0% of windows over, fullest 10 s 1.40"
    )


def test_the_worst_are_shown_first():
    """However many were flown."""
    found = [reached(seed, seed / 100) for seed in range(60, 10, -1)]
    summary, worst = drawn.tables(found, 30.0)[0].rows, drawn.tables(found, 30.0)[1].rows
    assert [row[0] for row in summary] == ["broadcast", "unicast"]
    assert sum(int(row[1]) for row in summary) == len(found)
    assert min(row[3] for row in summary) == "11.0%"
    assert [row[1] for row in worst] == [f"{seed}.0%" for seed in range(11, 11 + drawn.SHOWN)]


def test_those_that_exceeded_the_limit_most_often_are_shown_too():
    """The most first, and none that never did."""
    found = [reached(seed, 0.9, seed / 100) for seed in (0, 10, 30, 20)]
    assert [row[2] for row in drawn.tables(found, 30.0)[2].rows] == ["30.0%", "20.0%", "10.0%"]
