"""What becomes of the samples of each key, as long as mode and specs stay as they are."""

from typing import NamedTuple

from proxy.bridge.bounds import BOUNDS
from proxy.bridge.passed import BYPASS, DENIED, HEARTBEAT, MODE, NO_SPEC
from proxy.bridge.rules import ADVANCED, Rules, Verdict
from proxy.core.model.mode import Mode
from proxy.runtime import LiveRuntime, Runtime
from utility_specs import InformationType, Specs


class Course(NamedTuple):
    """What becomes of the samples of a key."""

    dropped: str | None
    """Why they do not cross."""
    passes: str | None
    """Why they need no decision."""
    covering: InformationType | None
    behind: InformationType | None
    """By what type samples of the key may wait that came before: as specs change they may be covered no more."""
    numbered: bool
    """Whether they keep the numbers of their publishers."""
    each: bool
    """Whether the core must be told of each, for all of them go."""


class Courses:
    """Works courses out once for each runtime. Without `sourced` no sample keeps the number of its publisher."""

    def __init__(self, live: LiveRuntime, rules: Rules, *, sourced: bool) -> None:
        self._live = live
        self._rules = rules
        self._sourced = sourced
        self._known: tuple[Runtime, Specs, dict[str, Course]] = live.runtime, Specs.empty(), {}
        """Those of one runtime, after that with these specs.

        Callbacks that still fill the courses of another one cannot spoil them.
        """
        self._left_out: set[str] = set()
        """Keys, up to a bound, of which samples crossed without their numbers: who heard numbers before, and hears them
        again, takes those between for lost, and fetches them.
        """

    def of(self, key: str) -> Course:
        """Return the course of a key. Called for every sample."""
        runtime = self._live.runtime
        of, before, courses = self._known
        if of is not runtime:
            before, courses = (before if of.specs is runtime.specs else of.specs), {}
            self._known = runtime, before, courses
        return courses.get(key) or self._work_out(key, runtime, before, courses)

    def numbered(self, key: str) -> bool:
        """Whether samples of `key` keep the numbers of their publishers.

        Not where some may be dropped on purpose, or might have been before: subscribers would fetch those.
        """
        return self._numbered(key, self._live.runtime)

    def _numbered(self, key: str, runtime: Runtime) -> bool:
        if self._rules.outward(key) is not Verdict.ORDINARY:
            return self._sourced
        return self._sourced and key not in self._left_out and not runtime.drops(runtime.specs.match(key))

    def _work_out(self, key: str, runtime: Runtime, before: Specs, courses: dict[str, Course]) -> Course:
        if len(courses) >= BOUNDS.keys:
            courses.clear()
        course = courses[key] = self._course(key, runtime, before)
        if self._sourced and not course.numbered and len(self._left_out) < BOUNDS.keys:
            self._left_out.add(key)
        return course

    def _course(self, key: str, runtime: Runtime, before: Specs) -> Course:
        verdict = self._rules.outward(key)
        dropped = DENIED if verdict is Verdict.DENIED else None
        if verdict is Verdict.COMPANION and not self._numbered(key.partition(ADVANCED)[0], runtime):
            dropped = HEARTBEAT
        covering = runtime.specs.match(key) if verdict is Verdict.ORDINARY else None
        behind = before.match(key) if verdict is Verdict.ORDINARY else None
        behind = None if behind is not None and behind.bypass else behind
        if covering is not None and covering.bypass:
            covering, verdict = None, Verdict.BYPASS
        numbered = self._numbered(key, runtime)
        if covering is None:
            reason = BYPASS if verdict is Verdict.BYPASS else NO_SPEC
            return Course(dropped, reason, None, behind, numbered, each=behind is not None)
        mode = runtime.mode_of(covering)
        passes = MODE if mode is Mode.PASS else None
        return Course(dropped, passes, covering, covering, numbered, each=mode is Mode.SHADOW)
