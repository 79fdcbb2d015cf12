"""The benchmark of what it costs to watch a daemon."""

import math
import threading
from http.server import BaseHTTPRequestHandler, HTTPServer

import pytest

from proxy.commands.client import connected
from studies.benchmarks.watchers import RECORD, SCRAPER, TOP, WHY, Watched, Watchers, scrape
from studies.benchmarks.watching import ALL, CASES, QUICK, WATCHES, Flown, Round, more, tables
from tests.daemons import Running
from tests.ports import free_port
from tests.waiting import wait_until


def test_what_a_watched_daemon_takes_is_told_beside_one_that_is_not(measured):
    """Some part more or less of the processor, within some bounds, and a few MB."""
    time, memory = measured("watching")
    assert time.columns[1:] == memory.columns[1:] == tuple(case.title for case in QUICK)
    (name, *cells), (logs, *_) = time.rows
    assert (name, logs) == (ALL.name, "logs as JSON")
    for cell in cells:
        mean, half = (float(part.strip(" %")) for part in cell.split("±"))
        assert -50.0 < mean < 50.0
        assert half > 0.0
    for _, *cells in memory.rows[:2]:
        assert all(0.0 < float(cell) < 100.0 for cell in cells)


def test_what_a_team_takes_more_than_the_other_does_not_count():
    """Nor what all take more in one of the turns."""
    flown = Round((1.1 * 3.0, 2.0), (6.0, 1.1 * 4.0))
    assert math.exp(flown.more) == pytest.approx(1.1)
    assert flown.alone == 4.0


def test_rounds_of_all_watches_tell_how_uncertain_each_mean_is():
    """By as many as there are of its own."""
    top, *_, everything = WATCHES

    def watched(*parts):
        return [Round((1.0 + part, 1.0), (1.0, 1.0 + part)) for part in parts]

    found = more({top: watched(0.0), everything: watched(0.04, 0.06, 0.05)})
    assert found[everything][0] == pytest.approx(0.05, abs=1e-4)
    assert found[everything][1] == pytest.approx(4.3 * 0.0095 / 3**0.5, rel=0.01)
    assert found[top] == (0.0, pytest.approx(4.3 * 0.0095, rel=0.01))


def test_a_row_for_each_who_watches_the_whole_last():
    """And a column for each traffic."""
    rounds = {watch: [Round((1.1, 1.0), (1.0, 1.1)), Round((1.1, 1.0), (1.0, 1.1))] for watch in (ALL, *WATCHES)}
    time, memory = tables({case: Flown(2, rounds, 2e6, 3e6, 0.5) for case in CASES}, 10e-6)
    assert [row[0] for row in time.rows] == [*(watch.name for watch in WATCHES), "logs as JSON"]
    assert time.rows[0][1] == "+10.0% ± 0.0%"
    assert time.rows[-1][1] == f"{0.5 * 10e-6 / (1.0 / 2):+.3%}"
    assert [row[1] for row in memory.rows] == ["+2.0", "+3.0", "50.0%"]


@pytest.mark.full
def test_who_watches_is_switched(tmp_path, stack):
    """A daemon records while it should, is scraped, and asked."""
    address = f"127.0.0.1:{free_port()}"
    options = ("--robot", "r1", "--metrics.listen", address, "--record.folder", str(tmp_path))
    daemon = Running(*options)
    stack.callback(daemon.end)
    daemon.status()
    watchers = Watchers([Watched(daemon.endpoint, "a", address)])
    stack.callback(watchers.close)
    client = stack.enter_context(connected(daemon.endpoint))
    for names in ((RECORD, TOP, SCRAPER), (), (RECORD,)):
        watchers.switch(names)
        wait_until(lambda on=RECORD in names: client.record("r1", {})["on"] is on, what="the switch")
    assert set(ALL.watchers) == {RECORD, TOP, SCRAPER, WHY}


def test_metrics_are_scraped_until_told_to_stop():
    """At each address."""
    stop, asked = threading.Event(), []

    class Served(BaseHTTPRequestHandler):
        def do_GET(self):
            asked.append(self.path)
            self.send_response(200)
            self.end_headers()
            if len(asked) == 2:
                stop.set()

        def log_request(self, *_):
            """Keep the output of tests quiet."""

    with HTTPServer(("127.0.0.1", 0), Served) as server:
        serving = threading.Thread(target=server.serve_forever)
        serving.start()
        scrape([f"127.0.0.1:{server.server_port}"] * 2, 60.0, stop)
        server.shutdown()
        serving.join()
    assert asked == ["/metrics"] * 2
