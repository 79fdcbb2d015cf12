"""The budget benchmark measures real daemons and routers, busy, idle and as they start."""

from proxy.profiling.stages import STAGES
from studies.benchmarks.report import Picture, Table


def test_what_a_daemon_costs_is_told_beside_a_router(measured):
    """For a sample, when idle, and at the start; the router takes less of everything."""
    samples, idle, starts, *_ = measured("budget")
    assert len(samples.rows) == 4
    for _, daemon, router in samples.rows:
        assert float(daemon) > float(router) > 0.0
    daemon, router = idle.rows
    assert [daemon[0], router[0]] == ["daemon", "router"]
    for ours, its in zip(daemon[2:], router[2:], strict=True):
        assert int(ours) > int(its) > 0
    assert float(daemon[1].rstrip("%")) > 0.0
    for _, median, longest in starts.rows:
        assert 0.0 < float(median) <= float(longest)


def test_stages_are_told_and_drawn(measured):
    """Of the daemon that has to decide, of one that need not, and of an idle one."""
    *_, stages, picture = measured("budget")
    assert isinstance(stages, Table)
    assert [row[0] for row in stages.rows] == [*STAGES, "all"]
    *_, whole = stages.rows
    assert all(float(cell.rstrip("%")) > 0.0 for cell in whole[1:])
    assert isinstance(picture, Picture)
    assert picture.svg.startswith("<svg ")
