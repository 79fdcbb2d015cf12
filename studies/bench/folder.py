"""The folder of mission files: which there are, and that they are what `SHA256SUMS` says."""

import hashlib
from collections.abc import Iterable, Sequence
from pathlib import Path

from studies.bench.errors import BenchError
from studies.bench.format import Mission, read
from utility_specs.suggestions import hint

MISSIONS = Path(__file__).parent / "missions"
"""Those that come with Sendworthy."""
SUMS = "SHA256SUMS"
SUFFIX = ".jsonl"


def names(folder: Path = MISSIONS) -> list[str]:
    """Return the names of the missions in a folder."""
    return sorted(path.stem for path in folder.glob(f"*{SUFFIX}"))


def find(wanted: Sequence[str] | None) -> list[Path]:
    """Return the files of missions by name or path; all of ours where none is wanted. Raises BenchError."""
    ours = names()
    if wanted is None:
        return [MISSIONS / f"{name}{SUFFIX}" for name in ours]
    found = []
    for word in wanted:
        if word not in ours and not word.endswith(SUFFIX):
            raise BenchError(f'there is no mission "{word}"{hint(word, ours)}; a file of your own ends in {SUFFIX}')
        found.append(MISSIONS / f"{word}{SUFFIX}" if word in ours else Path(word))
    return found


def load(path: Path) -> Mission:
    """Read a mission; one beside a `SHA256SUMS` has to be in it as it is. Raises BenchError."""
    sums = path.parent / SUMS
    if sums.is_file() and path.is_file():
        known = _sums(sums)
        if path.name not in known:
            raise BenchError(f"{path}: {sums} does not know it; a mission of your own belongs into another folder")
        if known[path.name] != checksum(path):
            raise BenchError(f"{path} is not what it was when {sums} was written: scores of it cannot be compared")
    return read(path)


def checksum(path: Path) -> str:
    """Return the SHA-256 of a file, as `sha256sum` prints it."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def write_sums(folder: Path) -> None:
    """Write the checksums of all missions of a folder, as `sha256sum` does."""
    lines = (f"{checksum(path)}  {path.name}\n" for path in _files(folder))
    (folder / SUMS).write_text("".join(lines), encoding="utf-8")


def _files(folder: Path) -> Iterable[Path]:
    return (folder / f"{name}{SUFFIX}" for name in names(folder))


def _sums(path: Path) -> dict[str, str]:
    found = {}
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        checked, two_spaces, name = line.partition("  ")
        if not two_spaces or len(checked) != 64:
            raise BenchError(f"{path}:{number}: a line is a SHA-256, two spaces and a file's name")
        found[name] = checked
    return found
