"""Whether replies get source info is tried on real sessions."""

from dataclasses import replace

import pytest

from proxy.bridge.declarations import trial
from proxy.bridge.declarations.source_info import new_mark
from proxy.bridge.declarations.trial import gives_source
from proxy.bridge.sides import open_sides
from proxy.config import AppConfig, MeshConfig
from tests.proxy.nodes import closing, free_endpoint, plain_session


@pytest.mark.parametrize(("pieces", "expected"), [(65535, True), (1400, True), (1000, False), (300, False)])
def test_it_is_told_whether_the_first_fragment_has_room_for_the_source(stack, pieces, expected):
    """With fragments smaller than what may stand before it no reply is given any, large ones or small ones."""
    small = {"transport": {"link": {"tx": {"batch_size": pieces}}}}
    app, mesh = AppConfig(listen=(free_endpoint(),), zenoh=small), MeshConfig(listen=(free_endpoint(),), scouting=False)
    opened = open_sides(app, mesh, stack)
    assert (opened.apps.keeps_source, opened.others.keeps_source) == (expected, True)


def test_without_a_tap_there_is_no_source(stack):
    """What a session answers to another one directly keeps the mark in its attachment, and so fails."""
    endpoint = free_endpoint()
    main = closing(stack, plain_session("router", listen=(endpoint,)))
    assert not gives_source(main, closing(stack, plain_session("client", connect=(endpoint,))), new_mark())


def test_a_session_that_is_not_asked_fails_after_a_while(stack, monkeypatch):
    """Sessions without a link do not hear each other."""
    monkeypatch.setattr(trial, "TUNING", replace(trial.TUNING, trial_timeout=0.01))
    assert not gives_source(*(closing(stack, plain_session("peer")) for _ in range(2)), new_mark())
