"""The events that make most of a recording, as JSON: the same text as by `json_data`, in a quarter of the time."""

import math
from collections.abc import Callable, Sequence
from json.encoder import encode_basestring
from typing import Any

from proxy.core.interface.commands import Drop, Forward
from proxy.core.interface.events import Event, SampleHanded, SamplePublished

_number = float.__repr__


def common(event: Event, commands: Sequence[Any]) -> str | None:
    """Return an event with what followed as JSON; None where it is none of the common ones, or not as they are."""
    write = _WRITERS.get(type(event))
    try:
        return None if write is None else write(event, commands)
    except TypeError:  # a whole number where there usually is a fraction
        return None


def _handed(event: SampleHanded, commands: Sequence[Any]) -> str | None:
    if commands or not math.isfinite(event.now):
        return None
    return f'{{"now":{_number(event.now)},"sample":{event.sample}}}'


def _published(event: SamplePublished, commands: Sequence[Any]) -> str | None:
    values = event.features.values()
    told = _told(commands)
    if told is None or not math.isfinite(event.now + event.t_gen + sum(values)):
        return None
    features = ",".join([f"{encode_basestring(name)}:{_number(value)}" for name, value in event.features.items()])
    origin = "null" if event.origin is None else encode_basestring(event.origin)
    return (
        f'{{"now":{_number(event.now)},"sample":{event.sample},"key":{encode_basestring(event.key)},'
        f'"size":{event.size},"t_gen":{_number(event.t_gen)},"origin":{origin},"priority":{event.priority},'
        f'"features":{{{features}}},"delete":{"true" if event.delete else "false"},'
        f'"superseded":{event.superseded}{told}}}'
    )


def _told(commands: Sequence[Any]) -> str | None:
    """Return what is said of the commands; None where another one is among them than what is done with a sample."""
    if not commands:
        return ""
    texts = []
    for command in commands:
        if type(command) is Forward:
            texts.append(f'{{"command":"Forward","sample":{command.sample}}}')
        elif type(command) is Drop:
            reason = encode_basestring(command.reason)
            texts.append(f'{{"command":"Drop","sample":{command.sample},"reason":{reason}}}')
        else:
            return None
    return f',"commands":[{",".join(texts)}]'


_WRITERS: dict[type[Event], Callable[[Any, Sequence[Any]], str | None]] = {
    SampleHanded: _handed,
    SamplePublished: _published,
}
