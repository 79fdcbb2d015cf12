"""Whether a daemon records, and what becomes of that. The library that writes is loaded when it does."""

import gc
from dataclasses import replace
from functools import partial
from typing import Any

from planner import SearchSettings
from proxy import clock
from proxy.bridge.payloads import Payloads
from proxy.config import Config
from proxy.extras import needs
from proxy.loop import Loop
from proxy.recording.entries import Start
from proxy.recording.errors import RecordingError
from proxy.recording.folder import RecordingFolder
from proxy.recording.tuning import TUNING
from proxy.runtime import LiveRuntime


class Recording:
    """Records what a loop hands to its core while it should. On the loop's thread, or before that runs."""

    def __init__(
        self, config: Config, loop: Loop, live: LiveRuntime, search: SearchSettings, payloads: Payloads
    ) -> None:
        self._config = config.record
        self._loop = loop
        self._live = live
        self._payloads = payloads
        self._start = Start(
            kind="robot",
            robot=loop.core.settings.robot,
            zid=loop.core.settings.zid,
            version=loop.core.settings.version,
            now=loop.core.started,
            settings=loop.core.settings,
            search=search,
            deadline=config.planner.deadline,
        )
        self._recorder: Any = None
        self._on = False
        self._thresholds = gc.get_threshold()
        """When Python looks for garbage while nothing is recorded."""

    @property
    def on(self) -> bool:
        """Whether it records."""
        return self._on

    @property
    def told(self) -> bool:
        """Whether it records, or did."""
        return self._recorder is not None

    def start(self, *, payloads: bool, whole: bool = False) -> None:
        """Record from now on; `whole`: the core has seen nothing yet. Raises RecordingError where that cannot be."""
        if self._on:
            where = self.describe()["file"]
            raise RecordingError(f"it records already, to {where}" if where else "it records already")
        try:
            from proxy.recording.output import Output  # noqa: PLC0415 - an extra
            from proxy.recording.recorder import Recorder  # noqa: PLC0415 - needs it, too
            from proxy.recording.snapshots import taken  # noqa: PLC0415 - what does not record does without
        except ImportError:
            raise RecordingError(f"recording {needs('record')}") from None
        now, runtime = clock.monotonic(), self._live.runtime
        start = replace(
            self._start,
            whole=whole,
            now=self._start.now if whole else now,
            wall_offset=clock.wall_offset(),
            generation=runtime.specs.generation,
            settings=replace(self._loop.core.settings, mode=runtime.mode),
            payloads=payloads,
        )
        folder = RecordingFolder(self._config.folder, start.robot, self._config.disk_bytes, now + start.wall_offset)
        output = Output(start, runtime.specs, folder, self._config.file_bytes)
        contents = self._payloads.content if payloads else None
        core = self._loop.core
        self._recorder = recorder = Recorder(core, output, partial(taken, core), payload=contents)
        recorder.start()
        self._loop.feed.record(recorder)
        self._thresholds = gc.get_threshold()
        gc.set_threshold(TUNING.young, *self._thresholds[1:])
        self._on = True

    def stop(self) -> None:
        """Record no longer: what was seen is still written, soon. Raises RecordingError when it does not record."""
        if not self._on:
            raise RecordingError("it does not record")
        self._loop.feed.record(None)
        self._recorder.stop()
        gc.set_threshold(*self._thresholds)
        self._on = False

    def begun(self, timeout: float) -> bool:
        """Wait at most `timeout` [s] after `start` until it is known where it records; whether it is."""
        return self._recorder is None or bool(self._recorder.begun(timeout))

    def done(self, timeout: float) -> bool:
        """Wait at most `timeout` [s] until all is written after `stop`; whether it is. From any thread."""
        return self._recorder is None or bool(self._recorder.wait(timeout))

    def close(self, timeout: float) -> None:
        """Stop with the daemon: there are no events any more."""
        if self._on:
            self.stop()
        self.done(timeout)

    def describe(self) -> dict[str, Any]:
        """Return what the status says of it."""
        return {"on": self._on, **(self._recorder.describe() if self._recorder else {})}

    def warnings(self) -> list[str]:
        """Say when something is missing."""
        if not self._on:
            return []
        told = self._recorder.describe()
        if told["problem"] and told["problem"] != self._recorder.unsaved:
            return [f"nothing is recorded: {told['problem']}; {told['missing']} events are missing so far"]
        found = [f"{told['missing']} events are missing in the recording"] if told["missing"] else []
        return [*found, *([f"what is recorded: {told['problem']}"] if told["problem"] else [])]
