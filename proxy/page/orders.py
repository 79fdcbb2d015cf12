"""What an operator changes with the page: modes, specs, and a demo's world. Also what is asked of single daemons."""

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from proxy.bridge.fleet import CROSSED, Outcome
from proxy.commands.client import Client, NoAnswerError, connected
from proxy.commands.why import told
from proxy.core.model.mode import Mode
from proxy.page import demo
from proxy.page.specs import Files, checked
from proxy.page.variants import DOWNSAMPLED, PAPER, PLAIN, variant
from proxy.pushed import pack
from proxy.why import Question

FILTERS: Mapping[str, tuple[Mode, str | None]] = {
    "on": (Mode.ENFORCE, PLAIN),
    "off": (Mode.PASS, None),
    "shadow": (Mode.SHADOW, None),
    "downsampling": (Mode.ENFORCE, DOWNSAMPLED),
    "paper": (Mode.ENFORCE, PAPER),
}
"""The buttons: the mode that each sets, and the variant of the specs, if any."""
WHY_WIDTH, WHY_LAST = 78, 3


class Orders:
    """Gives orders through the daemon at `endpoint`, one at a time; `robot` and `places` say who answers where.

    They are proved with the team's `token`, if there is one.
    """

    def __init__(
        self,
        endpoint: str,
        robot: Callable[[], str],
        places: Callable[[], Mapping[str, str]],
        token: str = "",
    ) -> None:
        self._token = token
        self._endpoint = endpoint
        self._robot = robot
        self._places = places
        self._lock = threading.Lock()

    def filter(self, name: str) -> list[Outcome]:
        """Do what a button says; return what became of it at each robot. Raises NoAnswerError and PushError."""
        mode, wanted = FILTERS[name]
        with self._lock, connected(self._endpoint) as client:
            robot = self._name(client)
            # What is in force now: what the page knows of it may be of a second ago.
            files = client.specs(robot)[1] if wanted is not None else {}
            new = files if wanted is None else variant(wanted, files)
            pushed = client.order(robot, "specs", _packed(new), self._token) if new != files else []
            if any(not each.obeyed for each in pushed):
                # Nobody is switched: the team would do something else than the button says.
                return pushed
            outcomes = client.order(robot, "mode", mode.encode(), self._token)
            return [*pushed, *(each if each.obeyed else self._switched(client, each, mode) for each in outcomes)]

    def specs(self, files: Files) -> tuple[dict[str, Any], list[Outcome]]:
        """Put specs in force where they are right; return what `checked` does, and what became of it at each robot.

        Raises NoAnswerError and PushError.
        """
        found = checked(files)
        if not found["fit"]:
            return found, []
        with self._lock, connected(self._endpoint) as client:
            return found, client.order(self._name(client), "specs", _packed(files), self._token)

    def channel(self, raw: bytes) -> str:
        """Set a demo's channel; return what it is then. Raises NoAnswerError and DemoOrderError."""
        return self._demo(demo.CHANNEL, demo.Channel.read(raw).write())

    def red(self, raw: bytes) -> str:
        """Put something red into a robot's path. Raises NoAnswerError and DemoOrderError."""
        return self._demo(demo.RED, demo.red_order(demo.read_red(raw)))

    def why(self, robot: str, key: str) -> str:
        """Return in plain words why the last samples of a stream were sent or dropped. Raises NoAnswerError.

        Raises QuestionError for no key.
        """
        question = Question(key, WHY_LAST)
        where = self._places().get(robot)
        if where is None:
            raise NoAnswerError(f"only the daemon of {robot} knows why: have the page ask it, too, with --connect")
        with connected(where) as client, client.understood():
            answer = client.why(robot, question)
            return "\n".join(told(answer, WHY_WIDTH)) or str(answer.get("problem"))

    def _demo(self, key: str, payload: bytes) -> str:
        with self._lock, connected(self._endpoint) as client:
            return client.ask(key, payload)

    def _name(self, client: Client) -> str:
        return self._robot() or client.only_robot()

    def _switched(self, client: Client, outcome: Outcome, mode: Mode) -> Outcome:
        """Switch who does not obey orders for all, but answers itself; not over the order of another operator there."""
        where = self._places().get(outcome.robot)
        if where is None or outcome.said == (CROSSED,):
            return outcome
        try:
            if where == self._endpoint:
                client.switch(outcome.robot, mode)
            else:
                with connected(where) as other:
                    other.switch(outcome.robot, mode)
        except NoAnswerError as error:
            return replace(outcome, said=(*outcome.said, str(error)))
        return Outcome(outcome.robot, obeyed=True, said=(f"mode {mode.value}",))


def _packed(files: Files) -> bytes:
    return pack({name: text.encode() for name, text in files.items()})


def written(outcomes: Sequence[Outcome]) -> list[dict[str, Any]]:
    """Return outcomes as plain JSON data."""
    return [{"robot": each.robot, "obeyed": each.obeyed, "said": list(each.said)} for each in outcomes]
