"""Proof that an order is of somebody who knows the token of the team, without telling the token.

Each robot gives out challenges, and an order answers those of all robots: HMAC-SHA256 of the order, the robot and its
challenge, keyed with the token. So whoever listens learns nothing that would make another order, or give the same one
once more, and no clock need be right.
"""

import hashlib
import hmac
import secrets
from collections.abc import Callable, Mapping
from pathlib import Path

import msgpack

SHORTEST, LONGEST = 16, 4096
"""Letters of a token. Whoever hears an order on a plain link can try tokens at leisure: a short one is found."""
LASTS = 30.0
"""A challenge may be answered for so long [s]: twice what an order waits for its answers, and for a slow robot."""
MISSING = "it takes the token of the team (fleet.token) with each order: --token-file names the file that has it"

_READ = 4 * LONGEST
"""So much is read of a file [letters]: of a device there is no end."""
_TIME, _RANDOM, _SEAL = 8, 16, 16
_TICKS = 1000.0
_VERSION = 1


def token_of(text: str) -> str:
    """Return a token as it was written, without blanks around it. Raises ValueError."""
    token = text.strip()
    if not SHORTEST <= len(token) <= LONGEST or not token.isprintable():
        raise ValueError(
            f"a token has {SHORTEST} to {LONGEST} printable letters; `openssl rand -hex 32` prints a good one"
        )
    return token


def read_token(file: Path) -> str:
    """Return the token in a file. Raises ValueError, which names the file."""
    try:
        with file.open() as opened:
            return token_of(opened.read(_READ))
    except OSError as error:
        raise ValueError(f"{file}: cannot be read: {error.strerror}") from None
    except ValueError as error:  # also what is no text
        said = "holds no text" if isinstance(error, UnicodeError) else error
        raise ValueError(f"{file}: {said}") from None


class OrderGuard:
    """Lets the orders of those pass who know the token. Not thread-safe: one thread asks it all.

    `token` returns it, or raises ValueError; it is asked for each order, as the file may have been replaced.

    It keeps nothing of a challenge until that is answered rightly, so nobody uses up its memory or pushes others'
    challenges out. Times are those of a monotonic clock [s].
    """

    def __init__(self, robot: str, token: Callable[[], str]) -> None:
        self._robot = robot
        self._token = token
        self._own = secrets.token_bytes(32)
        self._used: dict[bytes, float] = {}

    def challenge(self, now: float) -> bytes:
        """Return what the next order has to answer."""
        head = round(now * _TICKS).to_bytes(_TIME) + secrets.token_bytes(_RANDOM)
        return head + self._seal(head)

    def objection(self, now: float, order: str, payload: bytes, proofs: bytes | None) -> str:
        """Return why an order is not obeyed, or nothing; what was proved once proves nothing any more."""
        if proofs is None:
            return MISSING
        challenge, proof = _proof_for(self._robot, proofs)
        if not self._fresh(now, challenge):
            return "the order answers no challenge of this robot, or too late: give it again"
        try:
            token = self._token()
        except ValueError as error:
            return f"its own token cannot be read: {error}"
        if not hmac.compare_digest(proof, prove(token, order, self._robot, challenge, payload)):
            return "the order was given with another token"
        if challenge in self._used:
            return "the order was given before"
        self._used = {each: until for each, until in self._used.items() if until >= now} | {challenge: now + LASTS}
        return ""

    def _fresh(self, now: float, challenge: bytes) -> bool:
        head, seal = challenge[: _TIME + _RANDOM], challenge[_TIME + _RANDOM :]
        if not hmac.compare_digest(seal, self._seal(head)):
            return False
        return now - int.from_bytes(head[:_TIME]) / _TICKS <= LASTS

    def _seal(self, head: bytes) -> bytes:
        return hmac.digest(self._own, head, "sha256")[:_SEAL]


def prove(token: str, order: str, robot: str, challenge: bytes, payload: bytes) -> bytes:
    """Return the proof that who knows `token` gives `robot` this order."""
    said: bytes = msgpack.packb([_VERSION, order, robot, challenge, hashlib.sha256(payload).digest()])
    return hmac.digest(token.encode(), said, "sha256")


def proofs(token: str, order: str, payload: bytes, challenges: Mapping[str, bytes]) -> bytes:
    """Return the proofs for all robots by their challenges, as they travel beside the order."""
    answered = {
        robot: [challenge, prove(token, order, robot, challenge, payload)] for robot, challenge in challenges.items()
    }
    packed: bytes = msgpack.packb(answered)
    return packed


def _proof_for(robot: str, raw: bytes) -> tuple[bytes, bytes]:
    """Return the challenge and the proof that are meant for a robot; nothing where there are none."""
    try:
        challenge, proof = msgpack.unpackb(raw)[robot]
    except (ValueError, TypeError, KeyError, RecursionError, msgpack.UnpackException):
        return b"", b""
    return (challenge, proof) if isinstance(challenge, bytes) and isinstance(proof, bytes) else (b"", b"")
