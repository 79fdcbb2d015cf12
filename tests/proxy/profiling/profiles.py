"""A profile to look at, and its picture."""

from xml.etree import ElementTree as ET

from proxy.profiling.profile import Branch, Profile, Samples


def profile(*branches, seconds=2.0, samples=(30, 15, 5)):
    """Half a second in the search, a quarter in the core and in Zenoh each, unless other branches are given."""
    usual = (
        Branch("search", ("planner", "Worker._run (proxy.worker)", "decide <&> (proxy.worker)"), 0.5),
        Branch("core", ("loop", "Loop._run (proxy.loop)"), 0.25),
        Branch("zenoh", ("zenoh rx",), 0.25),
    )
    return Profile("r1", seconds, 100, 0.01, Samples(*samples), branches or usual)


def picture_of(text):
    """The elements of an SVG."""
    return ET.fromstring(text)  # noqa: S314 - it is ours
