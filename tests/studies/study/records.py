"""Records of flights for tests, made up of figures that are asked for."""

from studies.study.contenders import CONTENDERS
from studies.study.programme import everything
from studies.study.store import Store


def record(*, utility=50.0, maximum=100.0, sent=20, generated=100, arrived=1.0, gains=None):
    """What a flight reached."""
    found = {
        "utility": utility,
        "maximum": maximum,
        "generated": generated,
        "sent": sent,
        "received": arrived * sent,
        "over": 0.0,
        "worst": 1.0,
        "told": 900.0,
        "decision": [0.001, 0.005],
        "network": {"arrived": arrived, "delay": [0.004, 0.005], "offered": 5000.0},
        "cpu": 5.0,
        "small": 0.99,
        "age": [0.001, 0.002],
    }
    return found if gains is None else found | {"gains": gains}


def filled(path, extent, figures):
    """A store of everything in an extent; `figures(task)` are arguments of `record`."""
    with Store(path) as store:
        for task in everything(extent):
            given = figures(task)
            if task.contender in CONTENDERS and CONTENDERS[task.contender].random:
                given = {"gains": [0.1, 0.5, 1.0]} | given
            store.add(task, record(**given))
    return store
