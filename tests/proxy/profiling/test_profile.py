"""Profiles: what belongs together is one, what is too much is the rest."""

import pytest

from proxy import loop
from proxy.profiling import profile as profiles
from proxy.profiling.functions import Function
from proxy.profiling.profile import Branch, branches, read
from proxy.profiling.sampler import Spent
from tests.proxy.profiling.profiles import profile


def test_stages_are_summed_up_in_their_order():
    """Those that took nothing, too."""
    stages = profile().stages
    assert list(stages)[:3] == ["ingress", "features", "core"]
    assert {stage: spent for stage, spent in stages.items() if spent} == {"search": 0.5, "core": 0.25, "zenoh": 0.25}


def test_what_is_written_is_read():
    """As it was."""
    assert read(profile().write()) == profile()
    with pytest.raises(KeyError):
        read(profile().brief())


def test_functions_are_named_by_their_modules():
    """The outermost first, behind the thread; what all threads begin with is left out."""
    stack = (Function(loop.__file__, "Loop._run"), Function(__import__("threading").__file__, "Thread.run"))
    (branch,) = branches([Spent("loop", stack, 0.5)], whole=0.5)
    assert branch == Branch("core", ("loop", "Loop._run (proxy.loop)"), 0.5)


def test_threads_of_zenoh_are_told_apart_by_what_they_do():
    """Not by their numbers; outside of Python their time is Zenoh's, that of others is not."""
    spent = [Spent("rx-0", (), 0.1), Spent("rx-61", (), 0.2), Spent("sendworthy", (), 0.4)]
    zenoh, other = sorted(branches(spent, whole=0.7), key=lambda each: each.seconds)
    assert zenoh == Branch("zenoh", ("zenoh rx",), pytest.approx(0.3))
    assert other == Branch("other", ("sendworthy",), 0.4)


def test_what_threads_took_that_were_never_seen_is_not_forgotten():
    """They came and went between two looks."""
    *_, unseen = branches([Spent("rx-0", (), 0.5)], whole=0.6)
    assert unseen == Branch("other", ("threads that came and went",), pytest.approx(0.1))


def test_only_so_many_stacks_are_told_apart(monkeypatch):
    """Of all others the stage is told."""
    monkeypatch.setattr(profiles, "MOST", 2)
    spent = [Spent(f"thread {number}", (Function(loop.__file__, "f"),), 0.1 * number) for number in range(1, 6)]
    found = branches(spent, whole=1.5)
    assert found[2:] == (Branch("core", ("(the rest)",), pytest.approx(0.6)),)
    assert sum(branch.seconds for branch in found) == pytest.approx(1.5)
