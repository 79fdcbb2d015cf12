"""A configuration as text."""

import json
import tomllib

from hypothesis import given
from hypothesis import strategies as st

from proxy.config_loading import load_config, load_layered
from proxy.config_origins import Entry, Origin, entries
from proxy.config_text import data, toml, written

texts = st.text(st.characters(codec="utf-8"))
values = st.recursive(
    texts | st.booleans() | st.integers(-(2**63), 2**63 - 1) | st.floats(allow_nan=False),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(texts, inner, max_size=3),
)


@given(values)
def test_values_are_read_as_they_were(value):
    """Whatever TOML can hold."""
    assert tomllib.loads(f"value = {written(value)}")["value"] == value


def test_what_is_printed_is_the_same_configuration(tmp_path):
    """Printed once more, only the origins differ."""
    flags = {
        "robot": "r1",
        "mesh.interface": "wlan0",
        "mesh.connect": '["tcp/10.0.0.2:7500"]',
        "bridge.in.deny": '["a/**"]',
        "mesh.zenoh": "{ transport.link.tx.lease = 5000 }",
        "specs.path": str(tmp_path / "specs.d"),
        "record.folder": str(tmp_path / "recordings"),
    }
    file = tmp_path / "sendworthy.toml"
    file.write_text("\n".join(toml(entries(load_layered(None, {}, flags)))))
    assert load_config(file, {}, {}) == load_config(None, {}, flags)


def test_lines_say_what_and_where():
    """Tables in the order of the manual; keys that are no words are in quotes."""
    entry = Entry(("mesh", "zenoh", "a b", "c"), ("mesh",), [1, True], Origin("file", "a.toml", 3))
    assert list(toml([Entry(("robot",), (), "r1", Origin("flag", "--robot")), entry])) == [
        'robot = "r1"'.ljust(48) + "  # --robot",
        "",
        "[mesh]",
        'zenoh."a b".c = [1, true]'.ljust(48) + "  # a.toml:3",
    ]
    assert json.loads(json.dumps(data([entry]))) == [
        {
            "key": 'mesh.zenoh."a b".c',
            "value": [1, True],
            "origin": {"kind": "file", "name": "a.toml", "line": 3},
        }
    ]
