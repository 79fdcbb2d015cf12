"""The daemon of one robot: the core, the bridge and their threads, started and stopped together."""

import logging
import os
import threading
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from functools import partial
from importlib import metadata
from pathlib import Path
from typing import Any

import zenoh

from planner import SearchSettings
from proxy import clock
from proxy.bridge.air import Broadcast
from proxy.bridge.bridge import Bridge
from proxy.bridge.control import Control
from proxy.bridge.fleet import Fleet
from proxy.bridge.hold_back import HoldBack
from proxy.bridge.lane import Lane
from proxy.bridge.lookout import SCOUTING_GROUP, Lookout, around
from proxy.bridge.neighbours import Neighbours
from proxy.bridge.presence import Presence, free_name
from proxy.bridge.radio import Scouted
from proxy.bridge.room import rooms
from proxy.bridge.rules import Rules
from proxy.bridge.sides import open_sides
from proxy.bridge.silence import longest_silence
from proxy.config import Config
from proxy.config_changes import Change
from proxy.core.core import Core
from proxy.core.interface.commands import (
    AskState,
    Command,
    Decide,
    Drop,
    Forget,
    Forward,
    Keep,
    NoteInterest,
    Notice,
    Reread,
    Retain,
    SendCopy,
    SendDigest,
    SendState,
    SetPace,
    TellBacklog,
)
from proxy.core.interface.events import ModeChanged, SampleRefused, SampleReread, SpecsChanged
from proxy.core.model import transport
from proxy.core.model.mode import Mode
from proxy.core.model.settings import CoreSettings
from proxy.core.view.plausible import is_old
from proxy.features import Extractor
from proxy.loop import Loop
from proxy.orders import orders
from proxy.planning import Planning
from proxy.reloading import Loaded, Reloading
from utility_specs import InformationType, Specs

log = logging.getLogger(__name__)

_PATIENCE = 0.15
"""How long a stop waits for each thread [s]."""


_FAREWELL = 0.15
"""How long the routers of the app side have to take note of each other's end [s]."""

STOP = 0.7
"""How long a stop may take [s]."""

ORDERS = 16
"""Orders that may wait, each of which may be of megabytes."""

AWAY = 600.0
"""A robot that has vanished for longer is gone: nothing is kept for it any more [s]."""

SWAP = 2.0
"""How long whoever reloads waits until it is done [s]."""


class Daemon:
    """Start it, stop it. `start` raises `ProxyError` when a session cannot be opened.

    `read` reads the configuration anew, for `reloading`; `file` is what it is read from, if from any.
    """

    def __init__(
        self, config: Config, specs: Specs, file: Path | None = None, read: Callable[[], Config] | None = None
    ) -> None:
        self._config = config
        self._specs = specs
        self.reloading = Reloading(Loaded(config, specs), file, read or (lambda: config), self._apply)
        """Puts other files in force while the daemon runs."""
        self.robot = config.robot
        """Our name on the mesh; another one than configured when that was taken."""
        self._stopped = threading.Event()
        self._closing = ExitStack()

    def start(self) -> None:
        """Open both sessions and let things cross. After an error nothing is left open."""
        with ExitStack() as opening:
            self._open(opening)
            self._closing = opening.pop_all()

    def stop(self) -> bool:
        """Stop in order: what comes in first, the sessions last. Does nothing the second time.

        Takes no longer than `STOP` even when the mesh stands still: Zenoh would wait 10 s for it. Returns whether all
        is closed; if not, a thread goes on closing, and an interpreter that ends meanwhile aborts the process.
        """
        stopping = threading.Thread(target=self._close, name="stop", daemon=True)
        stopping.start()
        stopping.join(STOP)
        closed = not stopping.is_alive()
        if not closed:
            log.warning("the mesh stands still and takes no farewell; leaving without")
        self._stopped.set()
        return closed

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until somebody stops the daemon, at most `timeout` [s]; whether it is stopped."""
        return self._stopped.wait(timeout)

    def swap_specs(self, specs: Specs) -> None:
        """Put another generation of specs in force; returns when it is. Raises TimeoutError."""
        self._loop.ask(partial(self._swap, specs), SWAP)

    def watch(self, alive: Callable[[], None], every: float) -> None:
        """Call `alive` every so often [s], as long as the loop runs and decisions come to an end."""

        def report() -> None:
            self.watch(alive, every)
            if not self._planning.stuck(clock.monotonic()):
                alive()

        self._loop.post_at(clock.monotonic() + every, report)

    def _apply(self, loaded: Loaded, changed: Iterable[Change]) -> None:
        """Put changes in force between two events, and wait for it. Raises TimeoutError."""

        def apply() -> None:
            if loaded.specs.generation != self._specs.generation:
                self._swap(loaded.specs)
            for change in changed:
                match change.path:
                    case ("mode",):
                        self._switch(loaded.config.mode)
                    case ("log", "level"):
                        logging.getLogger().setLevel(loaded.config.log.level.upper())

        self._loop.ask(apply, SWAP)

    def _swap(self, specs: Specs) -> None:
        """Put specs in force, on the loop's thread."""
        self._specs = specs
        self._bridge.swap(specs)
        self._loop.handle(SpecsChanged(clock.monotonic(), specs))

    def _close(self) -> None:
        closing, self._closing = self._closing, ExitStack()
        try:
            closing.close()
        except (zenoh.ZError, RuntimeError) as error:
            log.warning("stopping: %s", error)

    def _open(self, opening: ExitStack) -> None:
        """Build everything between the sessions, and start it from the core outwards."""
        config = self._config
        self._scouted = Scouted(config.mesh.interface) if config.mesh.scouts else None
        sides = open_sides(config.app, config.mesh, opening, _FAREWELL)
        self._air = sides.air
        self._zids = {"app": str(sides.app.zid()), "mesh": str(sides.mesh.zid())}
        robot = self.robot = free_name(sides.mesh, config.robot)
        core = Core(_core_settings(config, robot, self._zids["mesh"]), self._specs, clock.monotonic())
        loop = self._loop = Loop(core, self._execute, config.clock.error)
        planner = config.planner
        # The paper's search comes with the paper's reduction; `best` has its own and ignores this.
        search = SearchSettings(search=planner.search, engine=planner.engine, reduction="paper")
        self._planning = Planning(search, planner.deadline, loop)
        self._extractor = Extractor(loop.post_at, self._match)
        self._neighbours = Neighbours(sides.app, robot, self._zids["mesh"], sides.wake.set)
        opening.callback(self._neighbours.close)
        hold_back = HoldBack(core.view.tag_of)
        self._bridge = Bridge(
            app=sides.app,
            mesh=sides.mesh,
            air=sides.air,
            apps=sides.apps,
            others=sides.others,
            neighbours=self._neighbours,
            wake=sides.wake,
            specs=self._specs,
            mode=config.mode,
            connect=config.mesh.connect,
            rules=Rules(config.bridge),
            app_connect=config.app.connect,
            relayed=config.mesh.relayed,
            recall=sides.recall,
            rooms=rooms(config.queue.samples, config.queue.bytes),
            hold_back=hold_back,
            silent=longest_silence(config.mesh.zenoh),
            submit=self._extractor.submit,
            post=loop.post,
            offer=loop.offer,
        )
        self._presence = Presence(
            sides.mesh,
            robot,
            self._bridge.lanes[0],
            loop.post,
            loop.offer,
            later=loop.post_at,
            old=lambda now, name, sent: is_old(now, core.view.peers.get(name), sent),
            hold_back=hold_back,
            air=sides.air if isinstance(sides.air, Broadcast) and core.settings.digests_on_air else None,
        )
        for part in (self._planning, self._extractor, loop):
            part.start()
            opening.callback(part.close, _PATIENCE)
        opening.callback(self._bridge.close)
        self._bridge.open()
        opening.callback(self._presence.close)
        self._presence.open()
        self._sides = sides
        self._lookout = Lookout(config.mesh.interface, self._zids.values(), _scouting_group(config))
        opening.callback(self._lookout.close, _PATIENCE)
        self._lookout.start()
        for warning in self._scouted.warnings() if self._scouted else ():
            log.warning("%s", warning)
        lane = Lane("control")  # of its own: what waits for the mesh must not keep the operator waiting
        opening.callback(lane.close, _PATIENCE)
        control = Control(
            app=sides.app,
            robot=robot,
            lane=lane,
            on_loop=loop.post,
            status=self._status,
            switch=self._ordered,
        )
        opening.callback(control.close)
        fleet_lane = Lane("fleet", ORDERS)
        opening.callback(fleet_lane.close, _PATIENCE)
        fleet = Fleet(
            app=sides.app,
            mesh=sides.mesh,
            robot=robot,
            lane=fleet_lane,
            obeyed=orders(
                config.fleet, robot, lambda mode: loop.ask(partial(self._ordered, mode), SWAP), self.reloading
            ),
            members=lambda: loop.ask(lambda: [peer.robot for peer in core.view.peers.values()], SWAP),
        )
        opening.callback(fleet.close)

    def _execute(self, command: Command) -> None:
        match command:
            case Decide():
                self._planning.decide(command)
            case Forward(sample):
                self._bridge.forward(sample)
            case Drop(sample):
                self._bridge.drop(sample)
            case Keep() | Forget() | SendCopy() | TellBacklog() | Retain():
                self._keep(command)
            case Reread(sample, key):
                self._reread(sample, key)
            case NoteInterest(zid, subscriptions):
                self._bridge.demand.told(zid, subscriptions)
            case SetPace(rate):
                self._bridge.set_pace(rate)
            case Notice(level, text):
                log.log(_LEVELS[level], "%s", text)
            case SendDigest() | SendState() | AskState():
                self._speak(command)

    def _keep(self, command: Keep | Forget | SendCopy | TellBacklog | Retain) -> None:
        match command:
            case Keep(sample):
                self._bridge.keep(sample)
            case Forget(sample):
                self._bridge.forget(sample)
            case SendCopy(sample, to):
                self._bridge.send_copy(sample, to)
            case TellBacklog(to, number, keys, grows):
                self._presence.tell_backlog(to, number, keys, grows=grows)
            case Retain(expressions):
                self._bridge.retain(expressions)

    def _speak(self, command: SendDigest | SendState | AskState) -> None:
        match command:
            case SendDigest(digest):
                self._presence.send_digest(digest)
            case SendState(state, update):
                self._presence.send_state(state, update)
            case AskState(name, tag):
                self._presence.ask_state(name, tag)

    def _match(self, key: str) -> InformationType | None:
        return self._specs.match(key)

    def _reread(self, sample: int, key: str) -> None:
        held = self._bridge.held(sample)
        if held is None:
            self._loop.post(SampleRefused(clock.monotonic(), sample))
            return
        event = SampleReread(clock.monotonic(), sample, {})
        self._extractor.reread(event, key, held.sample.payload, held.sample.attachment)

    def _switch(self, mode: Mode) -> None:
        self._bridge.switch(mode)
        self._loop.handle(ModeChanged(clock.monotonic(), mode))

    def _ordered(self, mode: Mode) -> None:
        """Somebody has us switch; a mode that changes with the configuration is logged with all that changes there."""
        self._switch(mode)
        log.info("mode %s", mode.value)

    def _warnings(self) -> list[str]:
        sides, peers = self._sides, self._loop.core.view.peers.values()
        others = {origin: peer.robot for peer in peers for origin in peer.origins if origin != peer.zid}
        return [
            *self._neighbours.warnings(),
            *around(sides.app, sides.mesh, others),
            *self._lookout.warnings(),
            *(self._scouted.warnings() if self._scouted else ()),
            *self.reloading.warnings(),
            *self._bridge.warnings(),
            *self._presence.floods.warnings(clock.monotonic()),
        ]

    def _status(self) -> dict[str, Any]:
        self._bridge.flush()
        self._presence.floods.flush(clock.monotonic())
        status = self._loop.core.status(clock.monotonic())
        return status | {
            "warnings": [*status.get("warnings", ()), *self._warnings()],
            "daemon": {
                "sessions": self._zids,
                "app": list(self._config.app.listen),
                "mesh": list(self._config.mesh.listens),
                "waiting": self._loop.waiting,
                "faults": self._loop.faults,
                "refused": self._loop.refused,
                "floods": self._presence.floods.describe(clock.monotonic()),
                "looks": self._lookout.looks,
                "features": {"superseded": self._extractor.superseded},
                "reloads": self.reloading.describe(),
                "specs": os.path.realpath(self.reloading.loaded.config.specs.path),
                **self._bridge.describe(),
                **({"broadcast": self._air.describe()} if isinstance(self._air, Broadcast) else {}),
            },
        }


def _scouting_group(config: Config) -> str:
    """Where applications of this robot scout."""
    scouting = config.app.zenoh.get("scouting", {})
    return str(scouting.get("multicast", {}).get("address", SCOUTING_GROUP))


def _core_settings(config: Config, robot: str, zid: str) -> CoreSettings:
    planner, mesh = config.planner, config.mesh
    return CoreSettings(
        robot=robot,
        zid=zid,
        mode=config.mode,
        horizon=planner.horizon,
        iterations=planner.iterations,
        deadline=planner.deadline,
        inbox=config.queue.samples // 2,
        inbox_bytes=config.queue.bytes // 2,
        backlog=planner.backlog,
        coordination=planner.coordination,
        transport=transport.broadcast(mesh.group) if mesh.transport == "broadcast" else transport.UNICAST,
        allowance=mesh.allowance,
        relayed=mesh.relayed,
        # Where TLS says who speaks on the mesh, what anybody can broadcast is not believed.
        digests_on_air=mesh.transport == "broadcast" and not mesh.secured,
        wall_offset=clock.wall_offset(),
        version=metadata.version("sendworthy"),
        away=AWAY,
    )


_LEVELS = {"info": logging.INFO, "warning": logging.WARNING, "error": logging.ERROR}
