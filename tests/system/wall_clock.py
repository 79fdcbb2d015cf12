"""A wall clock that only the processes of one host see, and that may be set while they run: `wall_clock.cpp`."""

import subprocess
from datetime import UTC, datetime
from pathlib import Path

SOURCE = Path(__file__).with_suffix(".cpp")


def compiled(folder):
    """Compile the library into `folder`; return where it is."""
    library = folder / "wall_clock.so"
    subprocess.run(["g++", "-O1", "-shared", "-fPIC", "-o", str(library), str(SOURCE), "-ldl"], check=True)
    return library


class WallClock:
    """Shows `ahead` seconds more than the machine's; its processes are to be started with `environ`."""

    def __init__(self, library, file, ahead):
        self._file = file
        file.write_bytes(bytes(8))
        self.environ = {"LD_PRELOAD": str(library), "WALL_CLOCK": str(file)}
        self.set(ahead)

    def set(self, ahead):
        """Let it show `ahead` seconds more than the machine's from now on."""
        self.ahead = ahead
        with self._file.open("r+b") as written:
            written.write(round(ahead * 1e9).to_bytes(8, "little", signed=True))


def since_1970():
    """What a clock that was never set is behind by [s]."""
    return -datetime.now(UTC).timestamp()
