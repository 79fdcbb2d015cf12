"""All streams in the view, by robot and key: which there are, whose (plain nodes are one owner), and which leave."""

from collections.abc import Iterator

from proxy.core.model.settings import CoreSettings
from proxy.core.view.stream import Place, Stream
from proxy.core.view.tuning import TUNING
from utility_specs import Specs

PLAIN = "?"
"""Plain nodes are named by this and their origin."""


class Streams:
    """The streams that specs plan for, bounded: `evicted` counts what had to be forgotten."""

    def __init__(self, settings: CoreSettings, specs: Specs) -> None:
        self.specs = specs
        self.revision = 0
        """How often anything changed that concerns more than one stream: which there are, and who wants them."""
        self.revisions = 0
        """How many of these concerned streams that were there before and still are: who wants them."""
        self.evicted = 0
        self._own = settings.robot
        self._most = settings.streams
        self._all: dict[Place, Stream] = {}
        self._owned: dict[str, dict[Place, Stream]] = {}
        """The streams of each owner, the one not heard of for longest first."""
        self._matching: dict[str, None] = {}
        self._ids = 0
        self._swept = 0.0

    def __iter__(self) -> Iterator[Stream]:
        return iter(self._all.values())

    def __len__(self) -> int:
        return len(self._all)

    def own(self) -> Iterator[Stream]:
        """The streams of this robot."""
        return iter(self._owned.get(self._own, {}).values())

    def of(self, robot: str) -> list[Stream]:
        """Return the streams of another robot."""
        return [stream for stream in self._owned.get(owner_of(robot), {}).values() if stream.robot == robot]

    def plain(self) -> list[Stream]:
        """Return the streams of all plain nodes."""
        return list(self._owned.get(PLAIN, {}).values())

    def known(self, robot: str, key: str) -> Stream | None:
        """The stream of a robot and key, if there is one."""
        return self._all.get((robot, key))

    def touch(self, until: float, robot: str, key: str, number: int = 0) -> Stream | None:
        """It is heard what the stream of a robot and key generated `until` then [s].

        Return it, made when new; None: no spec plans for it.
        """
        place = robot, key
        found = self._all.get(place)
        if found is None:
            information_type = self.specs.planned(key)
            if information_type is None:
                return None
            if robot == self._own:
                self._ids += 1
                number = self._ids
            matching = robot == self._own and key in self._matching
            found = Stream(number, robot, key, information_type, matching=matching)
            found.cover(information_type)
            self.admit(found)
        found.touch(until, number)
        owned = self._owned[owner_of(robot)]
        del owned[place]
        owned[place] = found
        return found

    def match(self, key: str, *, matching: bool) -> None:
        """Whether anybody on the mesh wants one of our keys; that is known before there is a stream, and after it."""
        self._matching.pop(key, None)
        if matching:
            self._matching[key] = None
            if len(self._matching) > TUNING.matching_keys:
                del self._matching[next(iter(self._matching))]
                self.evicted += 1
        stream = self._all.get((self._own, key))
        if stream is not None:
            stream.match(matching=matching)

    def set_specs(self, specs: Specs) -> None:
        """Swap the specs whole: streams keep what was observed and get the type that covers them now."""
        self.specs = specs
        for stream in list(self._all.values()):
            information_type = specs.planned(stream.key)
            if information_type is None:
                self.forget(stream)
            else:
                stream.cover(information_type)
                if stream.robot == self._own:  # others tell theirs
                    stream.revalue()

    def sweep(self, now: float) -> None:
        """Forget the streams of plain nodes that fell silent; cheap to call at every event."""
        if now < self._swept + TUNING.plain_check:
            return
        self._swept = now
        for stream in self.plain():
            if now - stream.known_until > max(
                TUNING.plain_silent, TUNING.plain_silent_periods * stream.schedule.period
            ):
                self.forget(stream)

    def revise(self) -> None:
        """Something changed that concerns more than one stream."""
        self.revision += 1
        self.revisions += 1

    def admit(self, stream: Stream) -> None:
        """Take in a stream; if there are too many, the owner of most loses the one not heard of for longest."""
        self.revision += 1
        self._all[stream.place] = stream
        self._owned.setdefault(owner_of(stream.robot), {})[stream.place] = stream
        if len(self._all) > self._most:
            new = owner_of(stream.robot)
            owners = [owner for owner, owned in self._owned.items() if owner != new or len(owned) > 1]
            most = max(owners, key=lambda owner: (len(self._owned[owner]), owner == new, owner != self._own))
            self.forget(next(s for s in self._owned[most].values() if s is not stream))
            self.evicted += 1

    def forget(self, stream: Stream) -> None:
        """The stream is no more."""
        self.revision += 1
        owner = owner_of(stream.robot)
        del self._all[stream.place]
        del self._owned[owner][stream.place]
        if not self._owned[owner]:
            del self._owned[owner]

    def rename(self, robot: str, name: str) -> None:
        """A robot has another name from now on."""
        streams = self.of(robot)
        for stream in streams:
            self.forget(stream)
        for stream in streams:
            stream.rename(name)
            self.admit(stream)

    def hand_over(self, stream: Stream, robot: str) -> None:
        """A plain node's stream turns out to be a robot's: what was overheard is kept, the robot's own counts hold."""
        self.forget(stream)
        if (robot, stream.key) in self._all:
            return
        heir = Stream(
            stream.id,
            robot,
            stream.key,
            stream.information_type,
            last=stream.last,
            sent=stream.sent,
            recent=stream.recent,
            known_until=stream.known_until,
            reached=stream.reached,
        )
        heir.cover(stream.information_type)
        heir.schedule.assume(stream.schedule.period)
        if stream.last is not None:
            heir.schedule.observe(1, stream.last.t_gen)
        self.admit(heir)


def owner_of(robot: str) -> str:
    """Whose streams are counted together, so that nobody pushes out another one's."""
    return PLAIN if robot.startswith(PLAIN) else robot
