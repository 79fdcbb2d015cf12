"""Whether Wi-Fi sleeps between messages, which delays what arrives."""

import re
from collections.abc import Iterator
from pathlib import Path

from proxy.doctor.finding import Finding, finding, fine, unknown
from proxy.doctor.programs import asked

SYS = Path("/sys")


def power_save(interface: str, sys: Path = SYS) -> Iterator[Finding]:
    """Look at an interface, if it is one of Wi-Fi; the kernel shows that in `sys`."""
    place = sys / "class" / "net" / interface
    if not (place / "wireless").exists() and not (place / "phy80211").exists():
        return
    answer = asked("iw", "dev", interface, "get", "power_save")
    shown = re.search(r"Power save: (on|off)", answer or "")
    if answer is None:
        yield unknown("power save", f"{interface}: only `iw` tells whether it saves power: sudo apt install iw")
    elif shown is None:
        yield unknown("power save", f"{interface}: `iw` does not tell ({answer.strip()}): run it with sudo")
    elif shown[1] == "on":
        cure = f"sudo iw dev {interface} set power_save off"
        yield finding("power save", f"{interface} saves power, which delays what arrives: {cure}")
    else:
        yield fine("power save", f"{interface}: off")
