"""The Zenoh configuration for applications on the robot."""

import json
import threading
from pathlib import Path

import pytest
import zenoh

from tests.ports import free_port
from tests.waiting import wait_until

SNIPPET = Path(__file__).parent.parent.parent / "deploy" / "apps" / "client.json5"


@pytest.fixture
def endpoint():
    """Where the daemon is, or will be."""
    return f"tcp/127.0.0.1:{free_port()}"


def application(endpoint):
    config = zenoh.Config.from_file(str(SNIPPET))
    assert config.get_json("connect/endpoints") == '["tcp/127.0.0.1:7447"]'
    config.insert_json5("connect/endpoints", json.dumps([endpoint]))
    return zenoh.open(config)


def router(endpoint):
    config = zenoh.Config()
    config.insert_json5("mode", '"router"')
    config.insert_json5("listen/endpoints", json.dumps([endpoint]))
    config.insert_json5("scouting/multicast/enabled", "false")
    return zenoh.open(config)


def test_an_application_may_start_before_the_daemon(endpoint):
    """The session comes up as soon as the daemon does."""
    opened = []
    early = threading.Thread(target=lambda: opened.append(application(endpoint)))
    early.start()
    early.join(0.3)
    assert early.is_alive()
    with router(endpoint):
        early.join(10.0)
        (session,) = opened
        wait_until(session.info.routers_zid, what="the link to the daemon")
        session.close()


def test_an_application_outlives_a_restart_of_the_daemon(endpoint):
    """The same session publishes to the new daemon."""
    first = router(endpoint)
    with application(endpoint) as session:
        first.close()
        with router(endpoint) as second:
            got = []
            second.declare_subscriber("a", zenoh.handlers.Callback(got.append, indirect=False))

            def arrives():
                session.put("a", b"1")
                return got

            wait_until(arrives, what="a sample after the restart")


def test_an_application_looks_for_nobody_else():
    """It cannot go around the daemon."""
    config = zenoh.Config.from_file(str(SNIPPET))
    assert config.get_json("mode") == '"client"'
    assert config.get_json("scouting/multicast/enabled") == "false"
    assert config.get_json("scouting/gossip/enabled") == "false"
