"""A booted systemd on a host of the channel, with the service as it is shipped.

Everything is private to it: processes, mounts, users, control groups. Nothing of the machine is started again or
changed, for systemd knows no other units than those that are put there.
"""

import shutil
import sys
import sysconfig
from pathlib import Path

from tests.system.systemd import Systemd

ROOT = Path(__file__).parents[2]
SHIPPED = ROOT / "deploy" / "systemd" / "sendworthy.service"
UNITS = "/etc/systemd/system"
PACKAGES = ("planner", "proxy", "studies", "utility_specs")
TARGETS = ("sysinit.target", "basic.target", "network.target", "shutdown.target", "umount.target", "boot.target")
"""All that there is beside the service; without more in them, systemd touches nothing else."""

BOOT = """
set -e
mount --make-rprivate /
cp -a /etc "$PLACE"/etc
for folder in /run /opt /var/lib /etc; do mount -t tmpfs -o mode=755 tmpfs $folder; done
cp -a "$PLACE"/etc/. /etc/
rm -rf /etc/systemd/system
mount -t cgroup2 cgroup2 /sys/fs/cgroup
mkdir -p /run/shared /etc/systemd/system/boot.target.wants /opt/sendworthy/python /opt/sendworthy/dependencies
cp -a "$PLACE"/put/. /
mount --bind "$PLACE"/shared /run/shared
mount --bind "$BASE" /opt/sendworthy/python
mount --bind "$DEPENDENCIES" /opt/sendworthy/dependencies
if [ "$STARTED" ]; then
    ln -s ../sendworthy.service /etc/systemd/system/boot.target.wants/
    useradd --system --no-create-home sendworthy
    chgrp -R sendworthy /etc/sendworthy
fi
mount -t tmpfs tmpfs /tmp
exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin container=other SYSTEMD_UNIT_PATH=/etc/systemd/system \
    /lib/systemd/systemd --system --unit=boot.target --log-target=console --show-status=no
"""
COMMAND = """#!/bin/sh
PYTHONPATH=/opt/sendworthy/lib:/opt/sendworthy/dependencies exec /opt/sendworthy/python/bin/python3 -m proxy.cli "$@"
"""


class Booted(Systemd):
    """A host that has booted with the service; `files` are further files by their absolute paths.

    If it is not `started`, the service is still to be set up.
    """

    def __init__(self, host, place, files, *, started=True):
        self._place = place
        self.shared = place / "shared"
        """A folder that both sides see, there as `/run/shared`."""
        self.shared.mkdir(parents=True)
        put = {f"{UNITS}/{name}": "[Unit]\nDefaultDependencies=no\n" for name in TARGETS}
        if started:
            put[f"{UNITS}/{SHIPPED.name}"] = SHIPPED.read_text()
        # There is no journal: what the service says goes where a test can read it.
        put[f"{UNITS}/{SHIPPED.name}.d/here.conf"] = "[Service]\nStandardError=file:/run/said\n"
        put["/opt/sendworthy/bin/sendworthy"] = COMMAND
        for path, text in (put | files).items():
            self._put(path, text)
        (place / "put/opt/sendworthy/bin/sendworthy").chmod(0o755)
        self._put_packages()
        dependencies, began = sysconfig.get_path("purelib"), "yes" if started else ""
        super().__init__(host, place, BOOT, BASE=sys.base_prefix, DEPENDENCIES=dependencies, STARTED=began)

    def sendworthy(self, *words):
        """Run the command `sendworthy` there."""
        return self.run("/opt/sendworthy/bin/sendworthy", *words)

    def said(self):
        """What the service and systemd have said."""
        path = self.path("/run/said")
        return (path.read_text() if path.exists() else "") + self.log()

    def _put(self, path, text):
        file = self._place / "put" / path.lstrip("/")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def _put_packages(self):
        lib = self._place / "put/opt/sendworthy/lib"
        installed = Path(sysconfig.get_path("purelib"))
        for package in PACKAGES:
            shutil.copytree(ROOT / package, lib / package)
            for built in installed.glob(f"{package}/**/*.so"):
                shutil.copy(built, lib / built.relative_to(installed))
