"""Processes that work side by side."""

import os
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context


def processes(jobs: int | None = None) -> ProcessPoolExecutor:
    """Return a pool of so many new processes, or one for each core.

    None is a fork: what was forked from a process that had Zenoh sessions waited for ever, as soon as it collected one
    of these as garbage, for a thread that only the other process has.
    """
    return ProcessPoolExecutor(jobs or os.cpu_count(), mp_context=get_context("spawn"))
