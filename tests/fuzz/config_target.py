"""Configurations, fuzzed byte by byte: the main file, a further one, variables, flags.

Data has these in that order, each behind a zero byte; of variables and flags each line is one.
"""

import json
import tomllib
from functools import cache
from pathlib import Path

from proxy.config_layers import PREFIX
from proxy.config_loading import load_layered
from proxy.config_origins import entries
from proxy.config_secrets import HIDDEN
from proxy.config_text import data as as_data
from proxy.config_text import toml
from proxy.errors import ConfigError
from tests.fuzz.scratch import scratch

MANUAL = Path(__file__).parents[2] / "deploy" / "sendworthy.toml"


def one_configuration(data: bytes) -> None:
    """Load a configuration, print it and load that; raises only what is a fault."""
    main, further, variables, flags = (data.split(b"\0", 3) + [b""] * 3)[:4]
    folder = _folder()
    (folder / "sendworthy.toml").write_bytes(main)
    (folder / "conf.d" / "more.toml").write_bytes(further)
    try:
        layered = load_layered(
            folder / "sendworthy.toml",
            {PREFIX + name.upper(): value for name, value in _pairs(variables)},
            dict(_pairs(flags)),
        )
    except ConfigError:
        return
    found = list(entries(layered))
    json.dumps(as_data(found))
    printed = "\n".join(toml(found))
    tomllib.loads(printed)
    if HIDDEN not in printed:
        path = folder / "alone" / "printed.toml"
        path.write_text(printed)
        again = load_layered(path, {}, {}).config
        assert _plain(again) == _plain(layered.config), printed


def seeds() -> list[bytes]:
    """Configurations to start from."""
    manual, every = MANUAL.read_text(), "\n".join(toml(entries(load_layered(None, {}, {"robot": "r1"}))))
    small = 'robot = "r1"\nmode = "shadow"\n[mesh]\nconnect = ["tcp/10.0.0.2:7500"]\nallowance = 0.1\n'
    zenoh = (
        "[mesh.zenoh.transport.link.tx]\nlease = 5000\n[app.zenoh]\nscouting = { timeout = 3 }\n[fleet]\nmode = true\n"
    )
    variables = 'mesh__listen=["tcp/0.0.0.0:7501"]\nplanner__iterations=200\nmesh__zenoh__transport__link__tx__lease=4'
    flags = "planner.coordination=shares\nmesh.scouting=false\nrobot=7\nbridge.out.bypass=['urgent/**']"
    parts = (manual, "", ""), (every, "", ""), (small, zenoh, ""), (small, "", variables), ("", small, variables)
    return ["\0".join((*each, flags)).encode() for each in parts]


def _pairs(lines: bytes) -> list[tuple[str, str]]:
    """Return what stands before and behind the first `=` of each line."""
    pairs = [line.partition("=") for line in lines.decode("utf-8", "replace").splitlines()]
    return [(name, value) for name, _, value in pairs]


def _plain(config: object) -> dict[str, object]:
    plain: dict[str, object] = config.model_dump(mode="json", by_alias=True)  # type: ignore[attr-defined]
    return plain


@cache
def _folder() -> Path:
    folder = scratch() / "configurations"
    for name in ("conf.d", "alone"):
        (folder / name).mkdir(parents=True)
    return folder
