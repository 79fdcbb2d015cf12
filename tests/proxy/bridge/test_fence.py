"""Nobody passes before what was declared earlier is mirrored."""

import threading

from proxy.bridge import fence as fence_module
from proxy.bridge.fence import Fence
from tests.waiting import wait_until


def test_a_look_that_began_before_the_mark_does_not_count(monkeypatch):
    """What was declared between its beginning and the mark it may have missed."""
    monkeypatch.setattr(fence_module, "PATIENCE", 0.01)
    woken = []
    fence = Fence(lambda: woken.append(1))
    fence.begin()
    mark = fence.mark()
    fence.end()
    assert not fence.wait(mark)
    assert woken
    fence.begin()
    fence.end()
    assert fence.wait(mark)
    assert len(woken) == 1


def test_whoever_waits_goes_on_when_all_is_mirrored(monkeypatch):
    """Waiting ends with the end of the next look."""
    monkeypatch.setattr(fence_module, "PATIENCE", 60.0)
    fence = Fence(lambda: None)
    passed = []
    mark = fence.mark()
    waiting = threading.Thread(target=lambda: passed.append(fence.wait(mark)))
    waiting.start()
    fence.begin()
    assert not passed
    fence.end()
    wait_until(lambda: passed == [True], what="the one who waits")
    waiting.join()
