"""A daemon's memory lies close together, and what it does not need any more the system has."""

import ctypes
import subprocess
import sys

import pytest

pytestmark = pytest.mark.skipif(not hasattr(ctypes.CDLL(None), "mallopt"), reason="another C library than glibc")

THREAD = """
import threading
from pathlib import Path
from proxy.heap import keep_together
if {together}:
    keep_together()
kept = []
thread = threading.Thread(target=lambda: kept.append(bytes(60_000)))
thread.start()
thread.join()
heap = next(line for line in Path("/proc/self/maps").read_text().splitlines() if line.endswith("[heap]"))
start, end = (int(each, 16) for each in heap.split()[0].split("-"))
print(start <= id(kept[0]) < end)
"""
FREED = """
import os
from proxy.heap import give_back
from studies.benchmarks.resources import private_memory
parts = [bytes(2_000) for _ in range(10_000)]
last = bytes(2_000)
del parts
before = private_memory(os.getpid())
give_back()
print(before - private_memory(os.getpid()) > 10e6)
"""
SPARE = """
import os
from proxy.heap import Spare
from studies.benchmarks.resources import private_memory
from proxy.tuning import TUNING
spare, held = Spare(), []
for now in (0.0, TUNING.spare_looks / 2, TUNING.spare_looks, 2 * TUNING.spare_looks):
    if now == 0.0:
        parts = [bytes(2_000) for _ in range(20_000)]
        last = bytes(2_000)
        del parts
    spare.look(now)
    held.append(private_memory(os.getpid()) / 1e6)
print(held[0] - held[1] < 1, held[1] - held[2] > 20, abs(held[2] - held[3]) < 1)
"""


def said(code):
    """Return what a process says that runs this."""
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()


def test_threads_take_memory_from_one_heap():
    """Else each of them has its own, and keeps there what it frees."""
    assert said(THREAD.format(together=True)) == "True"
    assert said(THREAD.format(together=False)) == "False"


def test_what_is_free_between_what_is_used_is_given_back():
    """The C library itself gives back only what is free at the end."""
    assert said(FREED) == "True"


def test_what_is_not_needed_again_is_given_back():
    """Not at once, as it may be needed by the next message; after that there is nothing to give back."""
    assert said(SPARE) == "True True True"
