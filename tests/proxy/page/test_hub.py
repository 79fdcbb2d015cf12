"""Who watches gets the newest of each kind, at its own pace."""

import asyncio

from proxy.page.hub import Hub
from proxy.page.tuning import TUNING


def test_a_slow_viewer_gets_the_newest_and_costs_no_more_memory():
    """Of a thousand images of two cameras it holds two; another one has had all."""

    async def watch():
        hub = Hub(lambda: {"history": b"past"})
        slow, quick = hub.join(), hub.join()
        taking = quick.messages()
        assert await anext(taking) == b"past"
        for number in range(500):
            for camera in ("a", "b"):
                hub.put(camera, f"{camera}{number}".encode())
                assert await anext(taking) == f"{camera}{number}".encode()
        assert (quick.dropped, slow.dropped) == (0, 998)
        late = slow.messages()
        assert [await anext(late) for _ in range(3)] == [b"past", b"a499", b"b499"]
        hub.put("a", b"a500")
        assert await anext(late) == b"a500"
        await taking.aclose()
        await late.aclose()

    asyncio.run(watch())


def test_who_left_is_told_nothing_more():
    """And its messages end; so do those of all when the page ends."""

    async def watch():
        hub = Hub(dict)
        first, second = hub.join(), hub.join()
        hub.put("a", b"x")
        hub.leave(first)
        hub.put("a", b"y")
        assert [each async for each in first.messages()] == []
        hub.close()
        hub.put("a", b"z")
        assert [each async for each in second.messages()] == []

    asyncio.run(watch())


def test_there_is_room_for_so_many():
    """One more is refused until somebody leaves."""

    async def join():
        hub = Hub(dict)
        viewers = [hub.join() for _ in range(TUNING.viewers)]
        assert hub.join() is None
        hub.leave(viewers[0])
        assert hub.join() is not None

    asyncio.run(join())
