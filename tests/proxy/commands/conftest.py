"""Real daemons, and stand-ins for one that answers strangely."""

import pytest
import zenoh

from tests.daemons import Running, specs_file
from tests.ports import free_port


@pytest.fixture
def start():
    """Start daemons; they are ended after the test."""
    running = []

    def start_one(*arguments, **options):
        running.append(Running(*arguments, **options))
        return running[-1]

    yield start_one
    for daemon in running:
        daemon.end()


@pytest.fixture(scope="module")
def daemon(tmp_path_factory):
    """A running daemon of robot r1 without specs."""
    running = Running("--robot", "r1", "--specs.path", str(specs_file(tmp_path_factory.mktemp("specs"))))
    running.wait_for("sendworthy ")
    yield running
    running.end()


@pytest.fixture
def stand_in():
    """A Zenoh router that answers queries on `key` with what `answer(query)` does; gives its endpoint."""
    sessions = []

    def open_router(answers):
        endpoint = f"tcp/127.0.0.1:{free_port()}"
        config = zenoh.Config()
        config.insert_json5("mode", '"router"')
        config.insert_json5("listen/endpoints", f'["{endpoint}"]')
        config.insert_json5("scouting/multicast/enabled", "false")
        session = zenoh.open(config)
        sessions.append(session)
        for key, answer in answers.items():
            session.declare_queryable(key, zenoh.handlers.Callback(answer, indirect=False))
        return endpoint

    yield open_router
    for session in sessions:
        session.close()
