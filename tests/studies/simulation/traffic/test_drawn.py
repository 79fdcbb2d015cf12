"""Workloads that are drawn: what is flown, and what is written of it."""

from datetime import date

from studies.simulation.traffic import drawn


def test_a_seed_draws_the_same_workload_again():
    """Another one draws another."""
    assert drawn.drawn_by(3) == drawn.drawn_by(3)
    assert drawn.drawn_by(3).label != drawn.drawn_by(4).label


def test_each_day_has_its_own_seeds():
    """However many are drawn."""
    today, next_day = (drawn.first_seed(date(2026, 12, day)) for day in (30, 31))
    assert next_day >= today + 1000
    assert drawn.drawn_by(today).label != drawn.drawn_by(next_day).label


def test_what_offers_less_than_the_limit_is_not_flown():
    """Nor what offers so much that no robot has anything."""
    loads = {seed: drawn.drawn_by(seed).load for seed in range(60)}
    least, most = drawn.LOADS
    assert min(loads.values()) < least
    assert all(drawn.reach(seed, 8.0) is None for seed, load in loads.items() if not least < load < most)


def test_the_page_shows_the_worst_first(tmp_path, capsys):
    """All are printed; the page has as many rows as were flown."""
    page = tmp_path / "drawn.md"
    flown = [seed for seed in range(30) if drawn.LOADS[0] < drawn.drawn_by(seed).load < 4.0]
    first = next(seed for seed in flown if len(drawn.drawn_by(seed).workload.robots) <= 4)
    arguments = ["--first", str(first), "--seeds", "1", "--seconds", "10", "--jobs", "1", "--output", str(page)]
    assert drawn.main(arguments) == 0
    (printed,) = capsys.readouterr().out.splitlines()
    assert drawn.drawn_by(first).label in printed
    assert drawn.drawn_by(first).label in page.read_text()
    assert f"--first {first} --seeds 1" in page.read_text()


def test_the_worst_are_shown_first():
    """However many were flown."""
    found = [drawn.Reached(drawn.drawn_by(seed), seed / 100, 0.0, 1.0, (0.5, 0.9)) for seed in range(60, 10, -1)]
    summary, worst = drawn.tables(found, 30.0)[0].rows, drawn.tables(found, 30.0)[1].rows
    assert [row[0] for row in summary] == ["broadcast", "unicast"]
    assert sum(int(row[1]) for row in summary) == len(found)
    assert min(row[3] for row in summary) == "11.0%"
    assert [row[1] for row in worst] == [f"{seed}.0%" for seed in range(11, 11 + drawn.SHOWN)]


def test_those_that_exceeded_the_limit_most_often_are_shown_too():
    """The most first, and none that never did."""
    found = [drawn.Reached(drawn.drawn_by(seed), 0.9, seed / 100, 1.1, (0.5, 0.9)) for seed in (0, 10, 30, 20)]
    assert [row[2] for row in drawn.tables(found, 30.0)[2].rows] == ["30.0%", "20.0%", "10.0%"]
