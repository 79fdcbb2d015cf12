"""The benchmark of what it costs to watch a daemon."""

import threading
from http.server import BaseHTTPRequestHandler, HTTPServer

import pytest

from studies.benchmarks.watchers import scrape
from studies.benchmarks.watching import ALL, CASES, NOBODY, WATCHES, Pair, more, tables


def test_what_a_watched_daemon_takes_is_told_beside_one_that_is_not(measured):
    """In each case: some part more or less of the processor, within some bounds, and a few MB."""
    time, memory = measured("watching")
    assert time.columns == memory.columns == ("switched on", *(case.title for case in CASES))
    ((name, *cells),) = time.rows
    assert name == ALL.name
    for cell in cells:
        mean, half = (float(part.strip(" %")) for part in cell.split("±"))
        assert -50.0 < mean < 50.0
        assert half > 0.0
    ((_, *cells),) = memory.rows
    for cell in cells:
        private, resident = map(float, cell.split("/"))
        assert 0.0 < private < 100.0
        assert resident > 0.0


def test_the_mean_and_its_uncertainty_are_those_of_all_slices():
    """Of both teams in each round."""
    pairs = [Pair((1.1, 1.0), (1.0, 1.0), 0.0, 0.0), Pair((1.1, 1.0), (1.0, 1.0), 0.0, 0.0)]
    mean, half = more(pairs)
    assert mean == pytest.approx(0.05)
    assert half == pytest.approx(3.2 * 0.0577 / 2, rel=0.01)


def test_a_row_for_each_who_watches():
    """And a column for each traffic."""
    flown = {(case, watch): [Pair((1.0, 1.2), (1.0, 1.0), 2e6, 3e6)] for case in CASES for watch in WATCHES}
    time, memory = tables(flown)
    assert [row[0] for row in time.rows] == [row[0] for row in memory.rows] == [watch.name for watch in WATCHES]
    assert time.rows[0][1].startswith("+10.0%")
    assert memory.rows[0][1:] == ("+2.0 / +3.0",) * len(CASES)


def test_who_is_watched_by_nobody_has_nothing_switched_on():
    """All of it is a flag each."""
    assert NOBODY.flags("127.0.0.1:1") == []
    assert ALL.flags("127.0.0.1:1") == [
        *("--metrics.listen", "127.0.0.1:1"),
        *("--record.on", "true"),
        *("--log.format", "json"),
    ]


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
