"""A clean Debian in a folder of its own, booted on a host of the channel."""

import os
import shutil
import subprocess
from pathlib import Path

from tests.system.systemd import Systemd
from tests.waiting import wait_until

ROOT = Path(__file__).parents[2]
KEPT = ROOT / "build" / "roots"
"""What was made once stays here."""
RELEASE, PYTHON = "bookworm", (3, 11)
"""The Debian, and its Python: a package is for that of `.venv`."""
NEEDED = "python3,systemd,init-system-helpers,libstdc++6,zlib1g"
"""What the package depends on, as installing it must need no network."""
EMULATOR = Path("/usr/lib/binfmt.d/qemu-aarch64.conf")
BINFMT = Path("/proc/sys/fs/binfmt_misc")
"""Where the kernel is told what runs programs of another machine, and says what it was told."""

BOOT = """
set -e
mount --make-rprivate /
mount --bind "$DEBIAN" "$DEBIAN"
cd "$DEBIAN"
mount -t proc proc proc
mount --bind -o ro proc/sys proc/sys
mount -t sysfs -o ro sysfs sys
mount -t cgroup2 cgroup2 sys/fs/cgroup
mount -t tmpfs -o mode=755 tmpfs run
mount -t tmpfs tmpfs tmp
mount -t tmpfs -o mode=755 tmpfs dev
for node in null zero full random urandom tty; do touch dev/$node; mount --bind /dev/$node dev/$node; done
mkdir dev/pts dev/shm run/before
mount -t devpts -o newinstance,ptmxmode=0666 devpts dev/pts
ln -s pts/ptmx dev/ptmx
mount -t tmpfs tmpfs dev/shm
pivot_root . run/before
umount -l run/before
exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin container=other \
    /lib/systemd/systemd --system --unit=multi-user.target --log-target=journal --show-status=no
"""


def clean(architecture, folder, *options):
    """Make a folder with nothing but what Debian needs, and what the package depends on."""
    kept = KEPT / f"{RELEASE}-{architecture}"
    if not kept.exists():
        KEPT.mkdir(parents=True, exist_ok=True)
        making = kept.with_suffix(f".{os.getpid()}")
        flags = ("--quiet", f"--architectures={architecture}", f"--include={NEEDED}", *options)
        subprocess.run(["mmdebstrap", *flags, RELEASE, making], check=True, stdin=subprocess.DEVNULL)
        making.rename(kept)
    subprocess.run(["cp", "-a", kept, folder], check=True)
    return folder


def packed(architecture):
    """Make the package; return where it is."""
    command = ["make", "--no-print-directory", "--silent", "deb", f"ARCH={architecture}"]
    done = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True)
    said = done.stdout.splitlines()[-1]
    return ROOT / said.partition(":")[0]


def emulated(package, folder):
    """Install a package for arm64 in a Debian for arm64, whose programs this machine emulates; return its folder.

    The packages of that Debian are unpacked only, for setting them up would take minutes. So dpkg knows none of them.
    """
    if not (BINFMT / EMULATOR.stem).exists():
        if not (BINFMT / "register").exists():
            subprocess.run(["mount", "-t", "binfmt_misc", "binfmt_misc", BINFMT], check=True)
        (BINFMT / "register").write_text(EMULATOR.read_text())
    clean("arm64", folder, "--variant=extract", "--include=coreutils,dash,perl-base")
    for name in ("opt", "proc", "root", "run", "srv", "sys"):
        (folder / name).mkdir(exist_ok=True)
    flags = (f"--root={folder}", "--force-architecture", "--force-depends", "--force-unsafe-io")
    done = subprocess.run(["dpkg", *flags, "--install", package], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


class Debian(Systemd):
    """A Debian on a host, as it is after its first boot. `folder` is its root as seen from here."""

    def __init__(self, host, place, architecture):
        place.mkdir()
        self.folder = clean(architecture, place / "root", "--variant=minbase")
        super().__init__(host, place, BOOT, DEBIAN=str(self.folder))
        wait_until(lambda: self.run("systemctl", "is-system-running").stdout == "running\n", what="the end of the boot")

    def dpkg(self, *words):
        """Install or remove a package there, without a terminal, and without waiting for the disk."""
        command = ("env", "DEBIAN_FRONTEND=noninteractive", "dpkg", "--force-unsafe-io", *words)
        done = self.run(*command, timeout=300)
        assert done.returncode == 0, done.stdout + done.stderr

    def take(self, file):
        """Copy a file there; return its path there."""
        shutil.copy(file, self.folder / "srv")
        return f"/srv/{file.name}"

    def files(self):
        """All that is there and not only while it runs."""
        passing = {"dev", "proc", "run", "sys", "tmp"}
        found = set()
        for folder, folders, names in os.walk(self.folder):
            here = Path("/") / Path(folder).relative_to(self.folder)
            if here == Path("/"):
                folders[:] = set(folders) - passing
            found |= {str(here / name) for name in (*folders, *names)}
        return found

    def close(self):
        """End everything there, and show what the daemon has said."""
        print(self.run("journalctl", "--no-pager", "--unit=sendworthy").stdout)
        super().close()
