"""A systemd that boots on a host of the channel; processes, mounts, users and control groups are its own."""

import os
import subprocess
from pathlib import Path

from tests.waiting import wait_until

OUTER = """
mkdir -p "$PLACE"/groups
mount -t cgroup2 cgroup2 "$PLACE"/groups
mkdir -p "$PLACE/groups/$GROUP"
echo $$ > "$PLACE/groups/$GROUP/cgroup.procs"
exec unshare --mount --pid --fork --kill-child --cgroup --uts --ipc --mount-proc sh -c "$BOOT"
"""


class Systemd:
    """A host whose first process is systemd. Needs root. `close` ends all that runs there.

    `boot` is a script that ends in systemd; it finds the folder `place` and what else is given in its environment.
    Where the machine keeps control groups of the first version, what units say of memory, processor and disk has no
    effect.
    """

    def __init__(self, host, place, boot, **environ):
        self._host = host
        self._group = f"sendworthy-{os.getpid()}-{host.name}"
        self._log = place / "log"
        environ = os.environ | environ | {"PLACE": str(place), "GROUP": self._group, "BOOT": boot}
        with self._log.open("w") as log:
            self._process = host.start("sh", "-c", OUTER, stdout=log, stderr=log, env=environ)
        wait_until(self._found, what="systemd")

    def run(self, *command, timeout=30):
        """Run a command there as root; return it at its end."""
        enter = ("nsenter", "--target", str(self._first), "--all")
        return subprocess.run([*enter, *command], capture_output=True, text=True, check=False, timeout=timeout)

    def property(self, name, unit="sendworthy.service"):
        """What systemd says of a unit."""
        return self.run("systemctl", "show", "--value", f"--property={name}", unit).stdout.strip()

    def path(self, path):
        """Where a file of its is to be found from here."""
        return Path(f"/proc/{self._first}/root{path}")

    def log(self):
        """What systemd has said."""
        return self._log.read_text()

    def close(self):
        """End everything there, however it fares."""
        self._process.kill()
        self._process.wait()
        print(f"--- {self._host.name}\n{self.log()}")

    def _found(self):
        assert self._process.poll() is None, self.log()
        groups = Path("/proc").glob("[0-9]*/cgroup")
        here = [int(path.parent.name) for path in groups if self._is_first(path)]
        self._first = here[0] if here else None
        return self._first is not None and self.run("systemctl", "is-system-running").stdout.strip() != ""

    def _is_first(self, path):
        try:
            return f"{self._group}/init.scope" in path.read_text()
        except OSError:
            return False  # it has ended
