"""The traffic in a recording, whichever kind it is."""

from collections.abc import Iterable, Iterator

from proxy.core.interface.events import SamplePublished
from proxy.recording.entries import Entry, Happened, Start, Traffic


def traffic(start: Start, entries: Iterable[Entry]) -> Iterator[Traffic]:
    """Yield what apps published, in the order of the file; generation times are wall times [s].

    Of a robot these are the samples that its core decided on, and that gave way to no newer one before.
    """
    for entry in entries:
        match entry:
            case Traffic(robot, key, t_gen, size, features):
                yield Traffic(robot, key, t_gen + start.wall_offset, size, features)
            case Happened(event=SamplePublished() as event) if not event.delete:
                at = event.t_gen + start.wall_offset
                yield Traffic(start.robot, event.key, at, event.size, event.features)
            case _:
                pass
