"""Whether the wall clock of this robot is synchronised."""

import math
import re
from collections.abc import Callable, Iterator

from proxy.clock import kernel_error
from proxy.config import Config
from proxy.doctor.finding import Finding, finding, fine
from proxy.doctor.programs import asked

_CURE = "sudo timedatectl set-ntp true, or sudo apt install chrony"


def wall_clock(config: Config, kernel: Callable[[], float] = kernel_error) -> Iterator[Finding]:
    """Ask the kernel, then chrony, which may not have told the kernel."""
    error, promised = kernel(), config.clock.error
    if math.isfinite(error):
        yield fine("clock", f"synchronised, wrong by {error * 1e3:.3g} ms at most, as the kernel knows")
    elif re.search(r"Leap status\s*: Normal", asked("chronyc", "-n", "tracking") or ""):
        if promised:
            yield finding("clock", "chrony does not tell the kernel, so clock.error does not count: give it `rtcsync`")
        else:
            yield fine("clock", "synchronised by chrony")
    elif promised or config.mesh.secured:
        needs = "clock.error counts only while it is" if promised else "certificates hold only at the right date"
        yield finding("clock", f"not synchronised, and {needs}: {_CURE}")
    else:
        yield finding("clock", f"not synchronised, so times in logs and recordings are not to be compared: {_CURE}")
