"""Which payloads the driver keeps."""

from hypothesis import given
from hypothesis import strategies as st

from proxy.core.interface.commands import Forget, Forward, Keep
from proxy.core.model.waiting import Waiting
from proxy.core.samples.held_payloads import HeldPayloads


def waiting(sample, size=100):
    return Waiting(sample, "alarm/a", size, 0.0, 1.0, 5, markovian=False)


def test_a_payload_is_kept_before_what_else_is_commanded_and_forgotten_after_it():
    """So it is there when it is to be sent."""
    payloads = HeldPayloads()
    payloads.hold(waiting(1))
    assert payloads.around([Forward(1)]) == [Keep(1), Forward(1)]
    payloads.hold(waiting(2))
    payloads.release(1)
    assert payloads.around([Forward(2)]) == [Keep(2), Forward(2), Forget(1)]
    assert payloads.around([]) == []


def test_what_is_needed_for_less_than_an_event_is_never_commanded():
    """The driver has nothing to do with it, nor with what is needed again at once."""
    payloads = HeldPayloads()
    payloads.hold(waiting(1))
    payloads.release(1)
    assert payloads.around([]) == []
    payloads.hold(waiting(2))
    payloads.around([])
    payloads.release(2)
    payloads.hold(waiting(2))
    assert payloads.around([]) == []


@given(st.lists(st.tuples(st.sampled_from(["hold", "release", "command"]), st.integers(0, 3)), max_size=60))
def test_the_driver_keeps_what_somebody_needs(steps):
    """As often as it is needed, and each is counted once in bytes."""
    payloads, needed, kept = HeldPayloads(), dict.fromkeys(range(4), 0), set()
    for step, sample in [*steps, ("command", 0)]:
        if step == "hold":
            payloads.hold(waiting(sample, size=10**sample))
            needed[sample] += 1
        elif step == "release" and needed[sample]:
            payloads.release(sample)
            needed[sample] -= 1
        elif step == "command":
            for command in payloads.around([]):
                (kept.add if isinstance(command, Keep) else kept.remove)(command.sample)
            assert kept == {sample for sample, times in needed.items() if times}
        assert payloads.bytes == sum(10**sample for sample, times in needed.items() if times)
