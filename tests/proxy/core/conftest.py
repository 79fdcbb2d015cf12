"""Fixtures of the core's transcripts."""

import pytest

from proxy.core.core import Core
from proxy.core.interface.events import TimePassed
from proxy.core.model.settings import CoreSettings
from tests.proxy.core.talk import SPEC, Talk
from utility_specs import load_specs


@pytest.fixture
def make_specs(tmp_path):
    """Specs of one camera type under a throughput limit, or of the given text."""

    def make(limit="80 kbit/s", window=1.0, text=None):
        path = tmp_path / "spec.toml"
        path.write_text(SPEC.format(limit=limit, window=window) if text is None else text)
        return load_specs(path)

    return make


@pytest.fixture
def make_talk(make_specs):
    """A core of robot r1 to talk to; digests cost nothing unless a test says otherwise.

    It has been alone for ten seconds: where robots split a limit it has all of it.
    """

    def make(specs=None, **settings):
        settings = {"coordination": "announce", "allowance": 0.0} | settings
        talk = Talk(Core(CoreSettings("r1", "z-r1", **settings), specs or make_specs(), -10.0))
        for now in (-9.0, -5.0, 0.0) if settings["coordination"] == "split" else ():
            talk.core.handle(TimePassed(now))
        return talk

    return make
