"""What every stream of the shared view could do with the constraints."""

from proxy.core.allocation import Claim
from proxy.core.limits import Limit, use_of
from proxy.core.stream import Stream
from proxy.core.view import SharedView

NEVER = 1e6
"""Age of what was never sent [s]."""


def claims(view: SharedView, now: float, limits: tuple[Limit, ...]) -> list[Claim]:
    """Return a claim on the constraints for each stream that is wanted and goes on; robots are named by their tags."""
    tags = view.tags()
    return [
        _claim(view, stream, now, robot=tags[stream.robot], limits=limits)
        for stream in view.streams()
        if stream.robot in tags and view.competes(now, stream)
    ]


def _claim(view: SharedView, stream: Stream, now: float, *, robot: str, limits: tuple[Limit, ...]) -> Claim:
    last, sent = stream.newest, stream.sent
    upcoming = stream.schedule.forecast(now, now + view.settings.horizon_time, 1)
    t_next = upcoming[0] if upcoming else now
    return Claim(
        robot=robot,
        use=use_of(last.size, view.copies(stream), limits),
        scale=last.scale * view.receivers(stream),
        utility=stream.information_type.utility_of(last.features),
        period=stream.schedule.period,
        latency=view.audiences.of(now, stream).mean,
        age=t_next - sent.t_gen if sent else NEVER,
        last_scale=sent.scale * view.receivers(stream) if sent else 0.0,
        wait=t_next - now,
    )
