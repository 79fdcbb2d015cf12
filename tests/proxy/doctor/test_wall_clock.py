"""Whether the clock is right."""

import math

import pytest

from proxy.config import ClockConfig, Config, MeshConfig
from proxy.doctor.finding import State
from proxy.doctor.wall_clock import wall_clock

PLAIN = Config(robot="r1")
PROMISED = Config(robot="r1", clock=ClockConfig(error=0.005))
SECURED = Config(robot="r1", mesh=MeshConfig(listen=("tls/0.0.0.0:7500",)))
BY_CHRONY, LOST = "Leap status     : Normal", "Leap status     : Not synchronised"


@pytest.mark.parametrize(
    ("config", "kernel", "chrony", "told"),
    [
        (PROMISED, 0.0042, LOST, (State.FINE, "wrong by 4.2 ms at most")),
        (PLAIN, math.inf, BY_CHRONY, (State.FINE, "synchronised by chrony")),
        (PROMISED, math.inf, BY_CHRONY, (State.FINDING, "give it `rtcsync`")),
        (PROMISED, math.inf, LOST, (State.FINDING, "clock.error counts only while it is: sudo timedatectl")),
        (SECURED, math.inf, LOST, (State.FINDING, "certificates hold only at the right date: sudo timedatectl")),
        (PLAIN, math.inf, LOST, (State.FINDING, "not to be compared: sudo timedatectl set-ntp true")),
    ],
)
def test_the_kernel_and_chrony_are_asked(program, config, kernel, chrony, told):
    """What it matters for depends on the configuration."""
    program("chronyc", f'echo "{chrony}"')
    (found,) = wall_clock(config, lambda: kernel)
    state, text = told
    assert (found.check, found.state) == ("clock", state)
    assert text in found.text


def test_this_kernel_answers():
    """Whatever it says."""
    assert len(list(wall_clock(PLAIN))) == 1
