"""What the person at the terminal wants to see, and how keys change it."""

from dataclasses import dataclass
from typing import Any

from proxy.top.tables import SORTS

KEYS = {
    "q": "quit",
    "f": "the fleet, or one robot",
    "n": "the next robot",
    "enter": "the robot that is marked, in the fleet",
    "a": "the streams of all robots, or of this one alone",
    "s": "sort by the next thing: " + ", ".join(SORTS),
    "r": "sort the other way round",
    "/": "show only rows that contain what you type; enter: done, esc: all rows again",
    "up down": "scroll, or mark another robot (also j, k, page up, page down, home, end)",
    "?": "this help; any other key leaves it",
}
PAGE = 10
STEPS = {"up": -1, "k": -1, "down": 1, "j": 1, "pageup": -PAGE, "pagedown": PAGE, "home": -(10**6), "end": 10**6}


@dataclass(slots=True)
class View:
    """The state of the screen. `robot` is the one that is shown; None: whichever answers first."""

    robot: str | None = None
    fleet: bool = False
    all_streams: bool = False
    sort: str = "not sent"
    reverse: bool = False
    filter: str = ""
    typing: bool = False
    """Whether keys are part of the filter."""
    help: bool = False
    at: int = 0
    """The first row that is shown, or the one that is marked."""
    done: bool = False
    names: tuple[str, ...] = ()
    """The robots that there are."""
    found: bool = False
    """Whether anything is known of what is to be shown."""
    marked: str | None = None
    """The robot that is marked in the fleet; None: the one in row `at`."""

    def press(self, key: str) -> None:
        """Do what a key says."""
        if self.help and key not in STEPS:
            self.help, self.at = False, 0
        elif self.typing and not self.help:
            self._type(key)
        elif key in STEPS:
            self.at, self.marked = max(0, self.at + STEPS[key]), None
        elif key == "enter":
            self._open()
        elif key in self._plain():
            self._plain()[key]()

    def mark(self, names: list[str]) -> None:
        """These are the robots of the fleet, in order: the mark stays on its robot."""
        if self.marked in names:
            self.at = names.index(self.marked)
        self.at = min(self.at, max(0, len(names) - 1))
        self.marked = names[self.at] if names else None

    def settle(self, rows: int, room: int) -> None:
        """There are so many rows, and room for so many: show as many as there are."""
        self.at = min(self.at, max(0, rows - room))

    def chosen(self, rows: list[dict[str, Any]], name: str) -> list[dict[str, Any]]:
        """Return the rows that are wanted, in the order that is; `name` is the field with the name."""
        text = self.filter.casefold()
        kept = [
            row for row in rows if text in " ".join(str(row.get(f) or "") for f in (name, "robot", "type")).casefold()
        ]
        field = SORTS[self.sort]
        if not field:
            return sorted(kept, key=lambda row: str(row.get(name)), reverse=self.reverse)
        kept.sort(key=lambda row: str(row.get(name)))
        return sorted(kept, key=lambda row: _most(row.get(field)), reverse=not self.reverse)

    def _plain(self) -> dict[str, Any]:
        return {
            "q": self._quit,
            "ctrl-c": self._quit,
            "?": self._help,
            "f": self._switch,
            "n": self._next,
            "tab": self._next,
            "a": self._all,
            "s": self._sort,
            "r": self._reverse,
            "/": self._filter,
            "esc": self._clear,
        }

    def _quit(self) -> None:
        self.done = True

    def _help(self) -> None:
        self.help, self.at = True, 0

    def _switch(self) -> None:
        self.fleet, self.at = not self.fleet, 0

    def _next(self) -> None:
        if self.names:
            now = self.names.index(self.robot) if self.robot in self.names else -1
            self.robot, self.at, self.fleet = self.names[(now + 1) % len(self.names)], 0, False

    def _open(self) -> None:
        if self.fleet and self.marked:
            self.robot, self.at, self.fleet = self.marked, 0, False

    def _all(self) -> None:
        self.all_streams, self.at = not self.all_streams, 0

    def _sort(self) -> None:
        names = list(SORTS)
        self.sort, self.at = names[(names.index(self.sort) + 1) % len(names)], 0

    def _reverse(self) -> None:
        self.reverse = not self.reverse

    def _filter(self) -> None:
        self.typing = True

    def _clear(self) -> None:
        self.filter, self.typing, self.at = "", False, 0

    def _type(self, key: str) -> None:
        if key == "ctrl-c":
            self.done = True
        elif key == "esc":
            self._clear()
        elif key == "enter":
            self.typing = False
        elif key == "backspace":
            self.filter = self.filter[:-1]
        elif len(key) == 1:
            self.filter, self.at = self.filter + key, 0


def _most(value: float | None) -> float:
    """What is not known comes after all else."""
    return -1.0 if value is None else float(value)
