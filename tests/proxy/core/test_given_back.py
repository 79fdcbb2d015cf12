"""What is told of what was lent and is given back."""

from proxy.core.given_back import LONGEST, MOST_RETURNED, TOLD, GivenBack, last_digits
from proxy.core.wire import BEGINS, Returned


def test_each_is_told_as_often_as_digests_may_be_lost():
    """With when it was used, or that it was not."""
    back = GivenBack()
    back.add((12.5, (1,)), 13.0, 12.75)
    back.add((70.0, (1,)), 71.0, None)
    for _ in range(TOLD):
        assert back.untold() == (Returned(12_500, 12.75), Returned(last_digits(70.0), 0.0))
        back.told()
    assert back.untold() == ()


def test_a_digest_tells_of_some_and_the_others_follow():
    """None is told twice before all were told once."""
    back = GivenBack()
    for n in range(MOST_RETURNED + 1):
        back.add((float(n), (1,)), n + 1.0, None)
    first = back.untold()
    assert len(first) == MOST_RETURNED
    back.told()
    assert back.untold()[0] not in first


def test_it_is_remembered_while_grants_may_be_on_their_way():
    """And by the amounts, too: another grant may begin at the same time."""
    back = GivenBack()
    back.add((12.5, (1,)), 13.0, None)
    assert (12.5, (1,)) in back
    assert (12.5, (2,)) not in back
    back.forget(13.0 + LONGEST - 0.1)
    assert (12.5, (1,)) in back
    back.forget(13.0 + LONGEST)
    assert (12.5, (1,)) not in back


def test_names_repeat_after_a_while():
    """A minute or so, in which what was lent is long over."""
    assert last_digits(1.0) == 1000
    assert last_digits(1.0 + BEGINS * 1e-3) == 1000
