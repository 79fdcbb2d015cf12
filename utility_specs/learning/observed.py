"""A sample as an observer of the traffic sees it."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Observed:
    """What came on a key at a `time` [s, on any clock that goes on].

    `origin` is whatever tells who published it, such as the id in its timestamp; None where nothing does.
    """

    time: float
    key: str
    payload: bytes
    encoding: str = ""
    attachment: bytes | None = None
    origin: str | None = None

    @property
    def size(self) -> int:
        """What it takes of limits: payload and attachment [B]."""
        return len(self.payload) + len(self.attachment or b"")
