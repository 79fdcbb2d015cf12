"""The threads of this process, and their names."""

import _thread
import threading
from pathlib import Path

from proxy.profiling.threads import is_zenohs, names, others
from tests.waiting import wait_until


def test_a_thread_of_python_has_the_name_that_python_gave_it():
    """The kernel calls it as it calls the process."""
    stop = threading.Event()
    thread = threading.Thread(target=stop.wait, name="search")
    thread.start()
    assert thread.native_id in others()
    assert names([thread.native_id]) == {thread.native_id: "search"}
    stop.set()
    thread.join()
    wait_until(lambda: thread.native_id not in others())
    assert names([thread.native_id]) == {}


def test_a_foreign_thread_keeps_its_name_when_python_learns_of_it():
    """It asks Python which thread it is, as logging does in a callback of Zenoh: a dummy for Python from then on."""
    known, stop = threading.Event(), threading.Event()
    natives = []

    def run():
        natives.append(threading.get_native_id())
        Path(f"/proc/self/task/{natives[0]}/comm").write_text("rx-7")
        assert threading.current_thread().name.startswith("Dummy")
        known.set()
        stop.wait()

    _thread.start_new_thread(run, ())
    assert known.wait(10.0)
    found = names(natives)
    stop.set()
    assert found == {natives[0]: "rx-7"}


def test_threads_of_zenoh_are_told_by_their_names():
    """They are numbered, and called by what they do."""
    assert is_zenohs("rx-0")
    assert is_zenohs("tx-12")
    assert not is_zenohs("rx")
    assert not is_zenohs("search-1")
