"""One profile at a time, with what crossed meanwhile."""

import threading
from pathlib import Path
from queue import SimpleQueue

import pytest

from proxy.profiling import threads
from proxy.profiling.profile import Samples
from proxy.profiling.profiler import Profiler
from proxy.profiling.request import ProfileError, Request
from tests.waiting import wait_until


class Loop:
    """A loop that does what is posted, and counts each time that it is told to flush."""

    def __init__(self):
        self.jobs, self.flushed = SimpleQueue(), 0
        self.profiler = Profiler("r1", self.jobs.put, self._flush, lambda: Samples(self.flushed, 2, 3))
        self.told = []

    def _flush(self):
        self.jobs.put(self._counted)

    def _counted(self):
        self.flushed += 1

    def turn(self):
        """Do what is posted until the profile is there, on a thread that is not the first; return it."""

        def until_told():
            while not self.told:
                self.jobs.get()()

        thread = threading.Thread(target=until_told)
        thread.start()
        return thread

    def start(self, request):
        self.jobs.put(lambda: self.profiler.start(request, self.told.append))


def test_a_profile_tells_what_crossed_meanwhile():
    """All that had crossed is counted at its beginning and at its end."""
    loop = Loop()
    loop.start(Request(0.1))
    loop.turn().join()
    (profile,) = loop.told
    assert (profile.robot, profile.samples) == ("r1", Samples(1, 0, 0))
    assert profile.seconds >= 0.1
    assert loop.profiler.last is profile


def test_none_is_taken_beside_another_one():
    """Who asks is told when it ends; then there may be a next one."""
    loop, refused = Loop(), []

    def second():
        with pytest.raises(ProfileError, match=r"a profile is being taken; it ends in 0\.\d s") as caught:
            loop.profiler.start(Request(5.0), loop.told.append)
        refused.append(caught.value)

    loop.start(Request(0.5))
    loop.jobs.put(second)
    loop.turn().join()
    assert len(refused) == len(loop.told) == 1
    loop.told.clear()
    loop.start(Request(0.1))
    loop.turn().join()
    assert len(loop.told) == 1


def test_who_ends_it_gets_what_it_saw_and_so_does_who_asked_for_it():
    """Where none is being taken there is nothing to end."""
    loop = Loop()
    with pytest.raises(ProfileError, match="no profile is being taken"):
        loop.profiler.end(loop.told.append)
    loop.start(Request(60.0))
    loop.jobs.put(lambda: loop.profiler.end(loop.told.append))
    loop.turn().join()
    asked, ended = loop.told
    assert asked is ended
    assert asked.seconds < 30.0


def test_one_that_fails_is_told_to_who_asked_and_the_next_one_can_be_taken(monkeypatch):
    """As where there is no descriptor left with which to look for threads."""
    loop = Loop()
    monkeypatch.setattr(threads, "_TASKS", Path("/proc/self/missing"))
    loop.start(Request(60.0))
    loop.turn().join()
    (failed,) = loop.told
    assert isinstance(failed, ProfileError)
    assert str(failed) == "the profile failed: [Errno 2] No such file or directory: '/proc/self/missing'"
    monkeypatch.undo()
    loop.told.clear()
    loop.start(Request(0.1))
    loop.turn().join()
    assert loop.told == [loop.profiler.last]


def test_closing_ends_it():
    """The daemon need not wait for it."""
    loop = Loop()
    loop.start(Request(60.0))
    turning = loop.turn()
    wait_until(lambda: loop.profiler._thread is not None, what="its beginning")
    loop.profiler.close(30.0)
    turning.join()
    assert loop.told[0].seconds < 30.0


def test_closing_does_nothing_where_there_is_none():
    """As a rule."""
    Loop().profiler.close(1.0)
