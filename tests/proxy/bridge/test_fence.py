"""Nobody passes before what was declared earlier is mirrored."""

from proxy.bridge.fence import Fence


def test_a_look_that_began_before_does_not_count():
    """What was declared between its beginning and the wish to pass it may have missed."""
    woken, passed = [], []
    fence = Fence(lambda: woken.append(1))
    fence.begin()
    fence.then(lambda: passed.append(1))
    fence.end()
    assert (woken, passed) == ([1], [])
    assert fence.begin()
    assert not passed
    fence.end()
    assert passed == [1]


def test_all_who_wait_pass_in_order_and_once():
    """One look is enough for all who came before it."""
    passed = []
    fence = Fence(lambda: None)
    for number in range(3):
        fence.then(lambda number=number: passed.append(number))
    for _ in range(2):
        fence.begin()
        fence.end()
    assert passed == [0, 1, 2]
    assert not fence.begin()


def test_one_that_fails_keeps_nobody_else(caplog):
    """As where the session is closed on which it would be said: who mirrors goes on, too."""
    passed = []
    fence = Fence(lambda: None)
    for job in (lambda: 1 / 0, lambda: 1 / 0, lambda: passed.append(1)):
        fence.then(job)
    fence.begin()
    fence.end()
    assert passed == [1]
    assert caplog.messages == ["what waited for declarations failed"] * 2
