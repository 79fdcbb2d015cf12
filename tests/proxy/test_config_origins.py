"""Where each value comes from."""

import pytest

from proxy.config import settings
from proxy.config_loading import load_layered
from proxy.config_origins import entries


@pytest.fixture
def origins(tmp_path):
    """Load a configuration; return value and origin by key."""

    def load(main="", further="", environ=None, flags=None):
        (tmp_path / "conf.d").mkdir(exist_ok=True)
        (tmp_path / "sendworthy.toml").write_text(main)
        (tmp_path / "conf.d" / "a.toml").write_text(further)
        layered = load_layered(tmp_path / "sendworthy.toml", environ or {}, flags or {})
        return {
            ".".join(entry.path): (entry.value, str(entry.origin).replace(f"{tmp_path}/", ""))
            for entry in entries(layered)
        }

    return load


def test_every_key_has_its_origin(origins):
    """In the order of the manual; what nobody set is a default."""
    found = origins('robot = "r1"')
    assert list(found) == [setting.key for setting in settings()]
    assert found.pop("robot") == ("r1", "sendworthy.toml:1")
    assert {origin for _, origin in found.values()} == {"default"}


def test_the_layer_that_wins_is_named(origins):
    """A flag before a variable before a file of conf.d before the main one."""
    main = "[planner]\niterations = 1\nhorizon = 1\nbacklog = 1\ndeadline = 1.0"
    environ = {"SENDWORTHY_PLANNER__ITERATIONS": "3", "SENDWORTHY_PLANNER__HORIZON": "3"}
    found = origins(main, "\n\n[planner]\nbacklog = 2\nhorizon = 2", environ, {"planner.iterations": "4"})
    assert found["planner.deadline"] == (1.0, "sendworthy.toml:5")
    assert found["planner.backlog"] == (2, "conf.d/a.toml:4")
    assert found["planner.horizon"] == (3, "SENDWORTHY_PLANNER__HORIZON")
    assert found["planner.iterations"] == (4, "--planner.iterations")


def test_keys_of_zenoh_have_origins_of_their_own(origins):
    """However deep they are, and whichever layer added them to which table."""
    found = origins(
        "[mesh.zenoh.transport.link.tx]\nlease = 5000\n[mesh.zenoh.transport.auth.usrpwd]\npassword = 'p'",
        "mesh.zenoh.transport.link.tx.batch_size = 9000",
        {"SENDWORTHY_MESH__ZENOH__TRANSPORT__UNICAST__MAX_LINKS": "2"},
        {"app.zenoh": "{ transport.unicast.max_sessions = 50 }"},
    )
    zenoh = {key: value for key, value in found.items() if ".zenoh" in key}
    assert zenoh == {
        "app.zenoh.transport.unicast.max_sessions": (50, "--app.zenoh"),
        "mesh.zenoh.transport.link.tx.lease": (5000, "sendworthy.toml:2"),
        "mesh.zenoh.transport.auth.usrpwd.password": ("(not shown)", "sendworthy.toml:4"),
        "mesh.zenoh.transport.link.tx.batch_size": (9000, "conf.d/a.toml:1"),
        "mesh.zenoh.transport.unicast.max_links": (
            2,
            "SENDWORTHY_MESH__ZENOH__TRANSPORT__UNICAST__MAX_LINKS",
        ),
    }
