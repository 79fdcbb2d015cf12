"""The daemon of one robot: the core, the bridge and their threads, started and stopped together."""

import logging
import threading
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any

import zenoh

from planner import SearchSettings
from proxy import clock, why
from proxy.bridge.bridge import Bridge, CoreLink
from proxy.bridge.broadcast import Broadcast
from proxy.bridge.control import Control
from proxy.bridge.fleet import Fleet
from proxy.bridge.hold_back import HoldBack
from proxy.bridge.identities import certified_names
from proxy.bridge.lookout import SCOUTING_GROUP, Lookout
from proxy.bridge.neighbours import Neighbours
from proxy.bridge.presence import Presence
from proxy.bridge.radio import Scouted
from proxy.bridge.serial_executor import SerialExecutor
from proxy.bridge.sides import Sides
from proxy.config import Config
from proxy.config_changes import Change
from proxy.core.core import Core
from proxy.core.interface.events import ModeChanged, SpecsChanged
from proxy.core.model.mode import Mode
from proxy.core.view.plausible import is_old
from proxy.core_settings import core_settings
from proxy.daemon_status import DaemonStatus
from proxy.errors import ConfigError
from proxy.execution import Execution
from proxy.features import Extractor
from proxy.fleet_token import OrderGuard
from proxy.loop import Loop
from proxy.opening import Opening
from proxy.orders import orders
from proxy.planning import Planning
from proxy.profiling.profile import Samples
from proxy.profiling.profiler import Profiler
from proxy.recording.errors import RecordingError
from proxy.recording.recording import Recording
from proxy.recording.recording_control import RecordingControl
from proxy.reloading import Loaded, Reloading
from proxy.runtime import LiveRuntime, Runtime
from proxy.tuning import TUNING
from proxy.watching import Signature
from utility_specs import Specs

log = logging.getLogger(__name__)


class Daemon:
    """Start it, stop it. `start` raises `ProxyError` when a session cannot be opened.

    `read` reads the configuration anew, for `reloading`; `file` is what it is read from, if from any. `opening` has the
    sessions if they are open already: they are closed with the daemon. Files were as `known` says before they were
    read.
    """

    def __init__(
        self,
        config: Config,
        specs: Specs,
        file: Path | None = None,
        read: Callable[[], Config] | None = None,
        opening: Opening | None = None,
        *,
        known: Signature | None = None,
    ) -> None:
        self._config = config
        self._live = LiveRuntime(Runtime(config.mode, specs))
        self.reloading = Reloading(Loaded(config, specs), file, read or (lambda: config), self._apply, known)
        """Puts other files in force while the daemon runs."""
        self.robot = config.robot
        """Our name on the mesh; another one than configured when that was taken."""
        self._opening = opening
        self._stopped = threading.Event()
        self._closing = ExitStack()

    def start(self) -> None:
        """Open both sessions and let things cross. After an error nothing is left open."""
        with ExitStack() as opening:
            self._open(opening)
            self._closing = opening.pop_all()

    def stop(self) -> bool:
        """Stop in order: what comes in first, the sessions last. Does nothing the second time.

        Takes no longer than `stop_time` even when the mesh stands still: Zenoh would wait 10 s for it. Returns whether
        all is closed; if not, a thread goes on closing, and an interpreter that ends meanwhile aborts the process.
        """
        stopping = threading.Thread(target=self._close, name="stop", daemon=True)
        stopping.start()
        stopping.join(TUNING.stop_time)
        closed = not stopping.is_alive()
        if not closed:
            log.warning("the mesh stands still and takes no farewell; leaving without")
        self._stopped.set()
        return closed

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until somebody stops the daemon, at most `timeout` [s]; whether it is stopped."""
        return self._stopped.wait(timeout)

    @property
    def mode(self) -> Mode:
        """The mode in force; another one than configured when somebody had us switch."""
        return self._live.runtime.mode

    def swap_specs(self, specs: Specs) -> None:
        """Put another generation of specs in force; returns when it is. Raises TimeoutError."""
        self._loop.ask(partial(self._swap, specs), TUNING.core_wait)

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
            if loaded.specs.generation != self._live.runtime.specs.generation:
                self._swap(loaded.specs)
            for change in changed:
                match change.path:
                    case ("mode",):
                        self._switch(loaded.config.mode)
                    case ("log", "level"):
                        logging.getLogger().setLevel(loaded.config.log.level.upper())

        self._loop.ask(apply, TUNING.core_wait)

    def _swap(self, specs: Specs) -> None:
        """Put specs in force, on the loop's thread."""
        self._live.swap(specs)
        self._bridge.renew()
        self._loop.feed.handle(SpecsChanged(clock.monotonic(), specs))

    def _switch(self, mode: Mode) -> None:
        """Put a mode in force, on the loop's thread."""
        self._live.switch(mode)
        self._bridge.renew()
        self._loop.feed.handle(ModeChanged(clock.monotonic(), mode))

    def _ordered(self, mode: Mode) -> None:
        """Somebody has us switch; a mode that changes with the configuration is logged with all that changes there."""
        self._switch(mode)
        log.info("mode %s", mode.value)

    def _close(self) -> None:
        closing, self._closing = self._closing, ExitStack()
        try:
            closing.close()
        except (zenoh.ZError, RuntimeError) as error:
            log.warning("stopping: %s", error)

    def _open(self, opening: ExitStack) -> None:
        """Build everything between the sessions, and start it from the core outwards."""
        config = self._config
        opened = self._opening or Opening(config)
        opening.push(opened.closing)
        sides, scouted = opened.sides, opened.scouted
        self.robot = opened.naming.name()
        self._loop = self._make_loop(sides)
        self._planning = self._make_planning()
        loop, all_go = self._loop, self._loop.core.parts.gate.appraisal.all_go
        extractor = Extractor(loop.post_at, self._live.match, loop.lead, loop.bring, all_go)
        self._neighbours = neighbours = Neighbours(sides.app, self.robot, str(sides.mesh.zid()), sides.wake.set)
        opening.callback(neighbours.close)
        hold_back = HoldBack(self._loop.core.view.origins.tag_of)
        wanted, live = loop.feed.preparation.wanted, self._live
        link = CoreLink(extractor.submit, loop.post, loop.note, lambda keys: wanted(keys, live.runtime.specs))
        self._bridge = bridge = Bridge(config, sides, self._live, neighbours=neighbours, hold_back=hold_back, core=link)
        presence = self._make_presence(sides, hold_back)
        self._execution = Execution(bridge, presence, self._planning, extractor, self._loop)
        self.recording = Recording(config, self._loop, self._live, self._planning.settings, bridge.payloads)
        opening.callback(self.recording.close, TUNING.stop_wait)  # after the loop
        if config.record.on:
            _record(self.recording, payloads=config.record.payloads)
        self._loop.start()
        for close in (self._planning.close, extractor.close, self._loop.close):
            opening.callback(close, TUNING.stop_wait)
        for part in (bridge, presence):
            opening.callback(part.close)
            part.open()
        self._lookout = self._look_out(sides, scouted, opening)
        profiler = Profiler(self.robot, self._loop.post, bridge.flush, self._samples)
        opening.callback(profiler.close, TUNING.stop_wait)
        parts = (sides, self._loop, bridge, presence, extractor, neighbours, self._lookout, scouted, self.reloading)
        status = DaemonStatus(config, *parts, profiler, self.recording, self._planning)
        self._serve_operator(sides, status, profiler, opening)
        self._serve_fleet(sides, presence, opening)

    def _make_loop(self, sides: Sides) -> Loop:
        settings = core_settings(self._config, self.robot, str(sides.mesh.zid()))
        core = Core(settings, self._live.runtime.specs, clock.monotonic())
        return Loop(core, lambda each: self._execution(each), self._config.clock.error)  # noqa: PLW0108 - made later

    def _make_planning(self) -> Planning:
        planner = self._config.planner
        # The paper's search comes with the paper's reduction; `best` has its own and ignores this.
        search = SearchSettings(search=planner.search, engine=planner.engine, reduction="paper")
        return Planning(search, planner.deadline, self._loop)

    def _make_presence(self, sides: Sides, hold_back: HoldBack) -> Presence:
        core, loop = self._loop.core, self._loop
        peers = core.view.peers
        return Presence(
            sides.mesh,
            self.robot,
            self._bridge.executors[0],
            loop.post,
            loop.offer,
            note=loop.note,
            later=loop.post_at,
            old=lambda now, name, sent: is_old(now, peers.get(name), sent),
            hold_back=hold_back,
            broadcast=sides.data if isinstance(sides.data, Broadcast) and core.settings.digests_on_air else None,
            certified=certified_names(self._config.mesh.zenoh),
        )

    def _look_out(self, sides: Sides, scouted: Scouted | None, opening: ExitStack) -> Lookout:
        """Look for what goes around the daemon, and say where no robots are looked for."""
        ours = str(sides.app.zid()), str(sides.mesh.zid())
        lookout = Lookout(self._config.mesh.interface, ours, _scouting_group(self._config))
        opening.callback(lookout.close, TUNING.stop_wait)
        lookout.start()
        for warning in scouted.warnings() if scouted else ():
            log.warning("%s", warning)
        return lookout

    def _samples(self) -> Samples:
        """What crossed up to now."""
        counts = self._loop.core.counts
        passed = sum(count for reason, count in counts.by_reason.items() if reason.startswith("passed:"))
        decided = counts.by_reason.total() - passed
        return Samples(decided, passed, self._bridge.describe()["delivered"])

    def _serve_operator(self, sides: Sides, status: DaemonStatus, profiler: Profiler, opening: ExitStack) -> None:
        """Answer whoever operates this robot, and whoever watches it."""
        if listen := self._config.metrics.listen:
            from proxy.metrics.server import MetricsServer  # noqa: PLC0415 - few need it

            read = partial(self._loop.ask, status.totals, TUNING.core_wait)
            opening.callback(MetricsServer(listen, read).close, TUNING.stop_wait)
        executor = SerialExecutor("control")  # of its own: what waits for the mesh must not keep the operator waiting
        opening.callback(executor.close, TUNING.stop_wait)
        control = Control(
            app=sides.app,
            robot=self.robot,
            executor=executor,
            on_loop=self._loop.order,
            status=status.read,
            live=status.live,
            why=lambda raw: why.answer(self._loop.core, clock.monotonic(), why.read(raw)),
            switch=self._ordered,
            profile=profiler.start,
            end_profile=profiler.end,
            specs=lambda: _described(self._live.runtime.specs, self.reloading.loaded.specs),
        )
        opening.callback(control.close)
        recording = RecordingControl(sides.app, self.robot, executor, self._loop.order, self.recording)
        opening.callback(recording.close)

    def _serve_fleet(self, sides: Sides, presence: Presence, opening: ExitStack) -> None:
        """Pass on and obey orders for all robots."""
        loop, core = self._loop, self._loop.core
        sworn = bool(_secret(self._config))
        executor, passing = (SerialExecutor(name, TUNING.orders) for name in ("fleet", "fleet out"))
        for each in (executor, passing):
            opening.callback(each.close, TUNING.stop_wait)
        fleet = Fleet(
            app=sides.app,
            mesh=sides.mesh,
            robot=self.robot,
            executor=executor,
            passing=passing,
            obeyed=orders(
                self._config.fleet,
                self.robot,
                lambda mode: loop.ask(partial(self._ordered, mode), TUNING.core_wait),
                self.reloading,
                guarded=sworn or bool(self._config.mesh.zenoh.get("access_control", {}).get("enabled")),
            ),
            members=lambda: loop.ask(lambda: [peer.name for peer in core.view.peers.values()], TUNING.core_wait),
            guard=OrderGuard(self.robot, lambda: self._config.fleet.secret) if sworn else None,
            refuse=presence.floods.refuse,
        )
        opening.callback(fleet.close)


def _described(specs: Specs, read: Specs) -> dict[str, Any]:
    """Return specs with the text of their files by name, as they were `read` last: comments alone make no others."""
    texts = read.texts if read.generation == specs.generation else specs.texts
    return {"generation": specs.generation, "files": dict(texts)}


def _secret(config: Config) -> str:
    """Return the token with which orders are to be proved, if any. Raises ConfigError."""
    try:
        return config.fleet.secret
    except ValueError as error:  # its file has changed since the configuration was read
        raise ConfigError((f"fleet.token_file: {error}",)) from None


def _scouting_group(config: Config) -> str:
    """Where applications of this robot scout."""
    scouting = config.app.zenoh.get("scouting", {})
    return str(scouting.get("multicast", {}).get("address", SCOUTING_GROUP))


def _record(recording: Recording, *, payloads: bool) -> None:
    """Record from the start on. Raises ConfigError where what that needs is not installed."""
    try:
        recording.start(payloads=payloads, whole=True)
    except RecordingError as error:
        raise ConfigError((f"record.on: {error}",)) from None
