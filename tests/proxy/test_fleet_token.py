"""Proofs that an order is the team's own."""

from pathlib import Path

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.fleet_token import LASTS, MISSING, OrderGuard, proofs, read_token, token_of

KNOWN = "a token of this team"
OTHER = "a token of that team"
ANSWERS_NONE = "the order answers no challenge of this robot, or too late: give it again"


@pytest.fixture
def guard():
    return OrderGuard("r1", lambda: KNOWN)


def proved(guard, now=0.0, *, secret=KNOWN, order="mode", payload=b"shadow", robot="r1"):
    return proofs(secret, order, payload, {robot: guard.challenge(now)})


def test_who_knows_the_token_is_obeyed_once(guard):
    """The same order once more has to be proved anew."""
    order = proved(guard)
    assert guard.objection(1.0, "mode", b"shadow", order) == ""
    assert guard.objection(1.0, "mode", b"shadow", order) == "the order was given before"
    assert guard.objection(1.0, "mode", b"shadow", proved(guard)) == ""


def test_an_order_without_proof_is_refused(guard):
    """And it is said what it takes."""
    assert guard.objection(0.0, "mode", b"shadow", None) == MISSING


@pytest.mark.parametrize(
    ("order", "payload"), [("specs", b"shadow"), ("mode", b"pass")], ids=["another order", "another payload"]
)
def test_a_proof_holds_for_what_was_ordered_alone(guard, order, payload):
    """Who changes an order on its way has no proof for the new one."""
    assert guard.objection(0.0, order, payload, proved(guard)) == "the order was given with another token"


def test_another_token_is_refused(guard):
    """Even where all else is right."""
    order = proved(guard, secret=OTHER)
    assert guard.objection(0.0, "mode", b"shadow", order) == "the order was given with another token"


def test_a_token_that_is_replaced_holds_at_once(tmp_path):
    """The one before proves nothing any more; where none can be read nobody is obeyed."""
    file = tmp_path / "fleet.token"
    file.write_text(KNOWN)
    guard = OrderGuard("r1", lambda: read_token(file))
    assert guard.objection(0.0, "mode", b"shadow", proved(guard)) == ""
    file.write_text(OTHER)
    assert guard.objection(0.0, "mode", b"shadow", proved(guard)) == "the order was given with another token"
    assert guard.objection(0.0, "mode", b"shadow", proved(guard, secret=OTHER)) == ""
    file.unlink()
    said = f"its own token cannot be read: {file}: cannot be read: No such file or directory"
    assert guard.objection(0.0, "mode", b"shadow", proved(guard, secret=OTHER)) == said


def test_what_was_proved_to_another_robot_or_before_a_restart_proves_nothing(guard):
    """Challenges are those of this robot and of this run of it."""
    for other in (OrderGuard("r2", lambda: KNOWN), OrderGuard("r1", lambda: KNOWN)):
        assert guard.objection(0.0, "mode", b"shadow", proved(other)) == ANSWERS_NONE
    assert guard.objection(0.0, "mode", b"shadow", proved(guard, robot="r2")) == ANSWERS_NONE


def test_a_challenge_can_be_answered_for_a_while(guard):
    """Not later, so what was answered need not be remembered any longer."""
    first, second = proved(guard), proved(guard)
    assert guard.objection(LASTS - 1.0, "mode", b"shadow", first) == ""
    assert guard.objection(LASTS + 1.0, "mode", b"shadow", second) == ANSWERS_NONE
    for round_ in range(1, 5):
        now = round_ * 10.0 * LASTS
        assert guard.objection(now, "mode", b"shadow", proved(guard, now)) == ""
        assert len(guard._used) == 1


@given(st.binary(max_size=200) | st.dictionaries(st.just("r1"), st.lists(st.binary(max_size=50))).map(msgpack.packb))
def test_any_bytes_are_a_refusal(raw):
    """Nothing that is on the mesh can do more harm than that."""
    assert OrderGuard("r1", lambda: KNOWN).objection(0.0, "mode", b"shadow", raw) == ANSWERS_NONE


@pytest.mark.parametrize("text", ["", "too short", "x" * 5000, "with a\nline in it here"])
def test_what_is_no_token_is_refused(text):
    """It says how to make a good one."""
    with pytest.raises(ValueError, match="openssl rand -hex 32"):
        token_of(text)


def test_a_token_is_read_from_a_file(tmp_path):
    """Without the end of the line; mistakes name the file."""
    file = tmp_path / "token"
    with pytest.raises(ValueError, match=f"{file}: cannot be read: No such file"):
        read_token(file)
    file.write_text(f"{KNOWN}\n")
    assert read_token(file) == KNOWN
    file.write_bytes(b"\xff" * 20)
    with pytest.raises(ValueError, match=f"{file}: holds no text"):
        read_token(file)
    file.write_text("short")
    with pytest.raises(ValueError, match=f"{file}: a token has 16 to 4096"):
        read_token(file)
    with pytest.raises(ValueError, match="/dev/zero: a token has 16 to 4096"):
        read_token(Path("/dev/zero"))
