"""Compiles the shim to ns-3, once for each version of its source and of ns-3, and each place of that."""

import hashlib
import os
import shutil
import subprocess
import tempfile
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

from studies.ns3.errors import INSTALL, PACKAGE, Ns3Unavailable

SOURCE = Path(__file__).with_name("radio.cpp")
MODULES = ("wifi", "internet", "network", "mobility", "propagation", "core")
"""Of ns-3, that the shim calls."""
FLAGS = ("-std=c++20", "-O2", "-shared", "-fPIC")


def shim() -> Path:
    """Return the shared library, compiled now where there is none yet.

    Raises Ns3Unavailable where ns-3, in the version it is written for, or a C++ compiler is missing.
    """
    root, number = _installed()
    library = _folder() / f"radio-{_fingerprint(root, number)}.so"
    if not library.exists():
        _compile(root, library)
    return library


def _installed() -> tuple[Path, str]:
    """Find ns-3 without importing it, which would load its bindings; return its folder and its version."""
    package = find_spec("ns3")
    try:
        number = version("ns3")
    except PackageNotFoundError:
        number = ""
    if package is None or not package.submodule_search_locations or not number:
        raise Ns3Unavailable(f"this needs ns-3: {INSTALL} (there are wheels for x86_64)")
    if f"ns3=={number}" != PACKAGE:
        raise Ns3Unavailable(f"this needs another version of ns-3 than {number}: {INSTALL}")
    return Path(package.submodule_search_locations[0]), number


def _folder() -> Path:
    """Return where compiled shims are kept."""
    caches = os.environ.get("XDG_CACHE_HOME")
    folder = (Path(caches) if caches else Path.home() / ".cache") / "sendworthy" / "ns3"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _fingerprint(root: Path, number: str) -> str:
    """Tell a shim from others: it finds the libraries where they were when it was compiled."""
    return hashlib.sha256(f"{root} {number} {FLAGS} {MODULES} {SOURCE.read_text()}".encode()).hexdigest()[:16]


def _compile(root: Path, library: Path) -> None:
    """Compile to a file beside and move it there: others may do so at the same time."""
    compiler = shutil.which(os.environ.get("CXX", "c++")) or shutil.which("g++")
    if compiler is None:
        raise Ns3Unavailable("the shim to ns-3 is compiled on the spot: this needs a C++ compiler (apt install g++)")
    found = {path.name.rpartition("-")[2]: path for path in (root / "lib64").glob("libns3*-*.so")}
    linked = [str(found[f"{module}.so"]) for module in MODULES]
    with tempfile.TemporaryDirectory(dir=library.parent) as folder:
        made = Path(folder) / library.name
        command = [compiler, *FLAGS, f"-I{root / 'include'}", str(SOURCE), "-o", str(made), *linked]
        done = subprocess.run([*command, f"-Wl,-rpath,{root / 'lib64'}"], capture_output=True, text=True, check=False)
        if done.returncode:
            raise Ns3Unavailable(f"{compiler} cannot compile the shim to ns-3:\n{done.stderr.strip()[-2000:]}")
        made.replace(library)
