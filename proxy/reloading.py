"""Puts changed files in force while the daemon runs: all of them, or nothing.

What is wrong is told and changes nothing; the same files are tried again when they change.
"""

import logging
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from threading import Lock
from typing import Any

from proxy.config import Config
from proxy.config_changes import Change, changes
from proxy.config_files import ConfigFiles, watched
from proxy.errors import ConfigError
from proxy.pushed import Folder
from proxy.watching import FileWatch, Signature
from utility_specs import Specs, SpecsError, digests, load_specs
from utility_specs.errors import SpecProblem
from utility_specs.loader import holds_specs

log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Loaded:
    """What stands in files: the configuration, and the specs that it names."""

    config: Config
    specs: Specs


def read_specs(path: Path) -> Specs:
    """Read the utility specs; none when there is no such folder, or nothing in it. Raises SpecsError."""
    with suppress(OSError, RuntimeError):  # RuntimeError: links in a circle; what is wrong is said when it is read
        Folder(path).mend()
    return load_specs(path) if holds_specs(path) else Specs.empty()


def read_besides(config: Config) -> list[Path]:
    """Return the files and folders that a configuration names, and that are read with it."""
    return [config.specs.path, *([Path(config.fleet.token_file)] if config.fleet.token_file else [])]


def warn(loaded: Loaded) -> None:
    """Log which limits would hold little beside what daemons tell each other."""
    for limit in loaded.specs.constraints:
        if warning := digests.warning(limit.measure, digests.TEAM):
            log.warning('%s: constraint "%s": %s', loaded.config.specs.path, limit.name, warning)


class Reloading:
    """Reads configuration and specs anew when files change or somebody asks.

    `read` reads the configuration, which the file `file` may hold, with the folder `conf.d` beside it. `apply` puts in
    force what changed, and returns when it is, or raises TimeoutError when it will be later. Files were as `known` says
    before they were read: what changed since is put in force. From any thread.
    """

    def __init__(
        self,
        loaded: Loaded,
        file: Path | None,
        read: Callable[[], Config],
        apply: Callable[[Loaded, Iterable[Change]], None],
        known: Signature | None = None,
    ) -> None:
        self.loaded = loaded
        """What is in force."""
        self._file = file
        self._read = read
        self._apply = apply
        self._lock = Lock()
        self._tried = loaded.config.specs.path
        """Where specs were looked for last, also in vain."""
        self._watch = FileWatch(self.watched, known)
        self._problems: tuple[str, ...] = ()
        self._done = 0
        self._refused = 0

    def look(self) -> bool:
        """Reload if files changed and then stayed as they are; whether they are changing: then look again soon."""
        with self._lock:
            if self._watch.look():
                self._reload("files changed")
            return self._watch.changing

    def reload(self, why: str) -> tuple[str, ...]:
        """Reload now; return what is wrong, one line for each mistake."""
        with self._lock:
            self._watch.note()
            self._reload(why)
            return self._problems

    def describe(self) -> dict[str, Any]:
        """Return what the status says of it."""
        return {"done": self._done, "refused": self._refused, "problems": list(self._problems)}

    def warnings(self) -> list[str]:
        """Say when files are not in force, and what is wrong with them."""
        if not self._problems:
            return []
        more = len(self._problems) - 1
        others = f" (and {more} more mistake{'s' * (more > 1)})" if more else ""
        return [f"the files that changed are not in force: {self._problems[0]}{others}"]

    def watched(self) -> list[Path]:
        """Return what is watched: all that is read, and where specs are looked for, in force or not."""
        own = [] if self._file is None else watched(self._file)
        return list(dict.fromkeys([*own, *read_besides(self.loaded.config), self._tried]))

    def _reload(self, why: str) -> None:
        try:
            loaded, changed = self._next()
        except (ConfigError, SpecsError) as error:
            self._refuse(why, tuple(map(str, error.problems)))
            return
        except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever files say, a daemon goes on as before
            self._refuse(why, (unjudged(error),))
            return
        if changed or loaded.specs.generation != self.loaded.specs.generation:
            try:
                self._apply(loaded, changed)
            except TimeoutError:
                log.warning("the daemon is busy and will do it later")
            except Exception as error:  # noqa: BLE001 - of what is in force then nobody knows
                self._refuse(why, (unjudged(error),))
                return
        before, self.loaded, self._problems = self.loaded, loaded, ()
        self._done += 1  # the status says it before the log does: who reads that may ask at once
        specs = f"specs {loaded.specs.generation} in force" if loaded.specs.types else "no specs, everything passes"
        log.info("%s: %s%s", why, specs, "".join(map(_told, changed)))
        if loaded.specs.generation != before.specs.generation:
            warn(loaded)
        for outdated in loaded.config.outdated:
            if outdated not in before.config.outdated:
                log.warning("%s", outdated)

    def _refuse(self, why: str, problems: tuple[str, ...]) -> None:
        known, self._problems = self._problems, problems
        self._refused += 1
        if problems != known:
            log.error("%s, nothing is reloaded: %s", why, "; ".join(problems))

    def _next(self) -> tuple[Loaded, tuple[Change, ...]]:
        """Read everything; raises ConfigError or SpecsError, also for what cannot change now."""
        config = self._read()
        self._tried = config.specs.path
        changed = tuple(changes(self.loaded.config, config))
        refused = [self._at(change.path, change.refusal) for change in changed if not change.live]
        if refused:
            raise ConfigError(tuple(map(str, refused)))
        specs = read_specs(config.specs.path)
        if self.loaded.specs.types and not specs.types:
            problem = "there are no specs any more; the last ones stay in force"
            raise SpecsError([SpecProblem(config.specs.path, None, "", problem)])
        return Loaded(config, specs), changed

    def _at(self, path: tuple[str, ...], message: str) -> SpecProblem:
        """Return the problem at a key, which no file need hold: it may have been removed."""
        files = ConfigFiles.read(self._file)
        return files.problem(path, message, files.values)


def unjudged(error: BaseException) -> str:
    """Return what is told of files that make us fail, which is our mistake or that of an operator's own code."""
    return f"cannot be judged: {type(error).__name__}: {' '.join(str(error).split())}".removesuffix(": ")


def _told(change: Change) -> str:
    return f", {'.'.join(change.path)} {change.after}"
