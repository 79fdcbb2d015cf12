"""Whether Wi-Fi saves power, as `iw` would say."""

import pytest

from proxy.doctor.finding import State
from proxy.doctor.power_save import power_save


@pytest.fixture
def sys(tmp_path):
    """What the kernel shows of an interface of Wi-Fi."""
    (tmp_path / "class" / "net" / "wlan0" / "phy80211").mkdir(parents=True)
    return tmp_path


@pytest.mark.parametrize(
    ("script", "state", "text"),
    [
        ('echo "Power save: on"', State.FINDING, "sudo iw dev wlan0 set power_save off"),
        ('echo "Power save: off"', State.FINE, "wlan0: off"),
        ("echo no such device >&2; exit 237", State.UNKNOWN, "`iw` does not tell (no such device)"),
    ],
)
def test_it_is_asked_for(sys, program, script, state, text):
    """With the interface."""
    program("iw", f'[ "$*" = "dev wlan0 get power_save" ] || exit 1\n{script}')
    (found,) = power_save("wlan0", sys)
    assert found.state == state
    assert text in found.text


def test_without_the_tool_nobody_knows(sys, monkeypatch):
    """And it is said how to get it."""
    monkeypatch.setattr("proxy.doctor.programs._PLACES", "")
    monkeypatch.setenv("PATH", "")
    (found,) = power_save("wlan0", sys)
    assert (found.state, "sudo apt install iw" in found.text) == (State.UNKNOWN, True)


def test_what_is_no_wifi_has_none(sys):
    """A cable never sleeps."""
    assert not list(power_save("eth0", sys))
    assert not list(power_save("lo"))
