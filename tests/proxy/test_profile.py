"""The ready-made rules that ship with the daemon."""

from typing import get_args

import pytest

from proxy.config import BridgeConfig
from proxy.profile import FOLDER, load_profile

NAMES = get_args(BridgeConfig.model_fields["profile"].annotation)


def test_every_profile_that_may_be_chosen_is_there():
    """The configuration knows the files, and the files are known to it."""
    assert {file.stem for file in FOLDER.glob("*.toml")} == set(NAMES) - {"none"}


@pytest.mark.parametrize("name", NAMES)
def test_profiles_load(name):
    """Each is well formed; "none" says nothing, the others do."""
    profile = load_profile(name)
    assert (profile == load_profile("none")) is (name == "none")
