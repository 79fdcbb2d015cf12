"""The three arrangements, side by side, for all features."""

from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack

import pytest

from tests.system.network import Network
from tests.transparency.arrangements import ARRANGEMENTS


@pytest.fixture(scope="session")
def place(tmp_path_factory):
    """An empty folder."""
    return tmp_path_factory.mktemp("mount")


@pytest.fixture(scope="session")
def teams(place, tmp_path_factory):
    """A team in every arrangement, by its name."""
    with ExitStack() as closing:
        made = {}
        for name, arrange in ARRANGEMENTS.items():
            network = Network(place, name)
            closing.callback(network.close)
            folder = tmp_path_factory.mktemp("teams") / name
            folder.mkdir()
            made[name] = arrange(network, folder)
            closing.callback(made[name].close)
        with ThreadPoolExecutor() as pool:
            list(pool.map(lambda team: team.begin(), made.values()))
        yield made


@pytest.fixture(scope="session")
def seen(teams):
    """What applications see of a feature in every arrangement; each is looked at once."""
    known = {}

    def look(feature):
        if feature not in known:
            with ThreadPoolExecutor() as pool:
                found = pool.map(lambda team: _look(feature, team), teams.values())
                known[feature] = dict(zip(teams, found, strict=True))
        return known[feature]

    return look


def _look(feature, team):
    try:
        return feature.look(team)
    finally:
        team.reset()
