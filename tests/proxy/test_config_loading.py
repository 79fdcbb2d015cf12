"""Reading the configuration: layers and every mistake at its place."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from proxy.config import Config
from proxy.config_loading import load_config
from proxy.core.model.mode import Mode
from proxy.errors import ConfigError

ENDPOINT = 'must be an endpoint like "tcp/192.168.1.2:7500", not'


@pytest.fixture
def load(tmp_path):
    """Load a configuration from its text."""

    def load_text(text, environ=None, overrides=None):
        file = tmp_path / "sendworthy.toml"
        file.write_text(text)
        return load_config(file, environ or {}, overrides or {})

    return load_text


@pytest.fixture
def problems(load, tmp_path):
    """Load a broken configuration; return its problems without the folder of the file."""

    def load_broken(text, environ=None, overrides=None):
        with pytest.raises(ConfigError) as refused:
            load(text, environ, overrides)
        assert str(refused.value) == "\n".join(refused.value.problems)
        return [problem.replace(f"{tmp_path}/", "") for problem in refused.value.problems]

    return load_broken


def test_nothing_set_means_defaults():
    """Without file, variables and flags everything has its default."""
    assert load_config(None, {}, {}) == Config()


def test_flags_win_over_variables_over_the_file(load):
    """Each layer hides the one below, key by key."""
    text = "[planner]\niterations = 1\nhorizon = 1\ndeadline = 1"
    environ = {"SENDWORTHY_PLANNER__ITERATIONS": "2", "SENDWORTHY_PLANNER__HORIZON": "2"}
    planner = load(text, environ, {"planner.iterations": "3"}).planner
    assert (planner.iterations, planner.horizon, planner.deadline) == (3, 2, 1.0)


@pytest.mark.parametrize(("before", "now"), [("auto", "announce"), ("overhear", "announce"), ("shares", "split")])
def test_ways_of_coordination_are_brought_up_to_date_and_told_with_their_place(load, tmp_path, before, now):
    """In the file, a variable or a flag; whatever the transport is."""
    text = f'robot = "r1"\n[planner]\ncoordination = "{before}"\n'
    told = f'"{before}" is called "{now}" now: please write that'
    found = load(text)
    assert found.planner.coordination == now
    assert found.outdated == (f"{tmp_path}/sendworthy.toml:3: planner.coordination: {told}",)
    found = load("", {"SENDWORTHY_PLANNER__COORDINATION": before})
    assert found.planner.coordination == now
    assert found.outdated == (f"SENDWORTHY_PLANNER__COORDINATION: planner.coordination: {told}",)
    found = load(text, {}, {"planner.coordination": before, "mesh.transport": "broadcast"})
    assert found.planner.coordination == now
    assert found.outdated == (f"--planner.coordination: {told}",)


def test_what_is_up_to_date_is_not_told_of(load):
    """Nor what a higher layer replaces."""
    assert load('[planner]\ncoordination = "split"').outdated == ()
    assert load('[planner]\ncoordination = "auto"', {}, {"planner.coordination": "announce"}).outdated == ()
    assert load("").outdated == ()


@settings(max_examples=40)
@given(
    file=st.none() | st.integers(1, 9999),
    further=st.lists(st.integers(1, 9999), max_size=2),
    variable=st.none() | st.integers(1, 9999),
    flag=st.none() | st.integers(1, 9999),
)
def test_the_highest_layer_that_speaks_decides(tmp_path_factory, file, further, variable, flag):
    """Whatever subset of the layers sets a key, the highest of them has its way."""
    path = tmp_path_factory.mktemp("config") / "sendworthy.toml"
    path.write_text("" if file is None else f"planner.iterations = {file}")
    (path.parent / "conf.d").mkdir()
    for number, value in enumerate(further):
        (path.parent / "conf.d" / f"{number}.toml").write_text(f"planner.iterations = {value}")
    environ = {} if variable is None else {"SENDWORTHY_PLANNER__ITERATIONS": str(variable)}
    flags = {} if flag is None else {"planner.iterations": str(flag)}
    expected = next((n for n in (flag, variable, *further[::-1], file) if n is not None), 300)
    assert load_config(path, environ, flags).planner.iterations == expected


def test_text_needs_no_quotes(load):
    """A name that looks like a number is a name; a list is written as in TOML."""
    config = load("", {"SENDWORTHY_ROBOT": "7", "SENDWORTHY_MODE": "shadow"}, {"mesh.connect": '["tcp/10.0.0.2:7500"]'})
    assert config.robot == "7"
    assert config.mode is Mode.SHADOW
    assert config.mesh.connect == ("tcp/10.0.0.2:7500",)


def test_zenoh_tables_are_merged_through_the_layers(load):
    """A flag adds to the table of the file instead of replacing it."""
    zenoh = load(
        "[mesh.zenoh.transport.link.tx]\nlease = 5000",
        {"SENDWORTHY_MESH__ZENOH__TRANSPORT__LINK__TX__BATCH_SIZE": "9000"},
        {"mesh.zenoh": "{ transport.unicast.max_links = 2 }"},
    ).mesh.zenoh
    tx = {"lease": 5000, "batch_size": 9000}
    assert zenoh == {"transport": {"link": {"tx": tx}, "unicast": {"max_links": 2}}}


def test_specs_are_beside_the_file(load, tmp_path):
    """A relative path is relative to the file that says it."""
    (tmp_path / "mine").mkdir()
    assert load('[specs]\npath = "mine"').specs.path == tmp_path / "mine"


def test_default_specs_may_be_missing(load, tmp_path):
    """The default folder is beside the file, and need not exist."""
    assert load("").specs.path == tmp_path / "specs.d"


def test_specs_of_a_flag_are_relative_to_the_working_directory(load, tmp_path, monkeypatch):
    """Who types a path means it from where they are."""
    (tmp_path / "work" / "here").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "work")
    assert load('[specs]\npath = "gone.toml"', {}, {"specs.path": "here"}).specs.path == Path("here")


GROUP = 'must be a multicast group and a port like "224.0.0.226:7449" or "[ff02::226]:7449", not'
BROKEN = {
    "robot empty": ('robot = ""', "1: robot: must not be empty"),
    "robot with slash": ('robot = "a/b"', '1: robot: must be one chunk of a key, without /: "a/b"'),
    "robot verbatim": ('robot = "@a"', '1: robot: must not start with "@": "@a"'),
    "robot no text": ("robot = true", "1: robot: must be a string, not true"),
    "mode misspelt": ('\nmode = "enforced"', '2: mode: unknown "enforced" (did you mean "enforce"?)'),
    "mode no text": ("mode = false", '1: mode: must be "pass", "shadow", "enforce", not false'),
    "unknown key": ('robto = "r1"', '1: robto: unknown key (did you mean "robot"?)'),
    "unknown table": ("\n\n[planer]", '3: planer: unknown key (did you mean "planner"?)'),
    "unknown inner key": (
        "[mesh]\nscoutin = true",
        '2: mesh.scoutin: unknown key (did you mean "scouting"?)',
    ),
    "table is a value": ("app = true", "1: app: must be a table, not true"),
    "listen no list": (
        '[app]\nlisten = "tcp/a:1"',
        '2: app.listen: must be an array: write ["tcp/a:1"] instead of "tcp/a:1"',
    ),
    "no router to meet at": ('[mesh]\nmode = "client"', '1: mesh.connect: must name a router in mode "client"'),
    "listen empty": ("[app]\nlisten = []", "2: app.listen: must not be empty, unless connect names a router"),
    "listen item no text": ("[app]\nlisten = [\n\nfalse]", "4: app.listen[0]: must be a string, not false"),
    "endpoint without protocol": ('[mesh]\nlisten = ["a:1"]', f'2: mesh.listen[0]: {ENDPOINT} "a:1"'),
    "endpoint of unknown protocol": (
        '[mesh]\nlisten = ["tcp/a:1", "tpc/a:1"]',
        f'2: mesh.listen[1]: {ENDPOINT} "tpc/a:1": unknown protocol "tpc" (did you mean "tcp"?)',
    ),
    "endpoint without port": (
        '[mesh]\nconnect = ["tcp/a"]',
        f'2: mesh.connect[0]: {ENDPOINT} "tcp/a": the address must be HOST:PORT or [IPv6]:PORT',
    ),
    "port too large": (
        '[mesh]\nconnect = ["tcp/a:99999"]',
        f'2: mesh.connect[0]: {ENDPOINT} "tcp/a:99999": a port is at most 65535',
    ),
    "port 0 dialled": (
        '[mesh]\nconnect = ["tcp/a:0"]',
        '2: mesh.connect[0]: port 0 cannot be dialled: "tcp/a:0"',
    ),
    "scouting maybe": ('[mesh]\nscouting = "maybe"', '2: mesh.scouting: must be true or false, not "maybe"'),
    "interface empty": (
        '[mesh]\ninterface = ""',
        '2: mesh.interface: must be "auto" or an interface like "wlan0", not ""',
    ),
    "allowance too large": ("[mesh]\nallowance = 0.75", "2: mesh.allowance: must be at most 0.5, not 0.75"),
    "allowance negative": ("[mesh]\nallowance = -0.1", "2: mesh.allowance: must be at least 0, not -0.1"),
    "iterations no number": (
        '[planner]\niterations = "many"',
        '2: planner.iterations: must be a whole number, not "many"',
    ),
    "iterations broken": (
        "[planner]\niterations = 1.5",
        "2: planner.iterations: must be a whole number, not 1.5",
    ),
    "iterations none": ("[planner]\niterations = 0", "2: planner.iterations: must be at least 1, not 0"),
    "iterations too many": (
        "[planner]\niterations = 1000001",
        "2: planner.iterations: must be at most 1000000, not 1000001",
    ),
    "deadline none": ("[planner]\ndeadline = 1e-300", "2: planner.deadline: must be at least 0.001, not 1e-300"),
    "deadline infinite": (
        "[planner]\ndeadline = inf",
        "2: planner.deadline: must be a finite number, not inf",
    ),
    "horizon true": ("[planner]\nhorizon = true", "2: planner.horizon: must be a whole number, not true"),
    "search unknown": (
        '[planner]\nsearch = "bets"',
        '2: planner.search: unknown "bets" (did you mean "best"?)',
    ),
    "engine unknown": (
        '[planner]\nengine = "c"',
        '2: planner.engine: unknown "c" (known: "native", "python")',
    ),
    "transport unknown": (
        '[mesh]\ntransport = "multicast"',
        '2: mesh.transport: unknown "multicast" (did you mean "unicast"?)',
    ),
    "group that is none": (
        '[mesh]\ntransport = "broadcast"\ngroup = "10.0.0.1:7449"',
        f'3: mesh.group: {GROUP} "10.0.0.1:7449"',
    ),
    "coordination unknown": (
        '[planner]\ncoordination = "splits"',
        '2: planner.coordination: unknown "splits" (did you mean "split"?)',
    ),
    "level unknown": ('[log]\nlevel = "warn"', '2: log.level: unknown "warn" (did you mean "warning"?)'),
    "profile unknown": (
        '[bridge]\nprofile = "ros"',
        '2: bridge.profile: unknown "ros" (did you mean "ros2"?)',
    ),
    "key expression with an empty chunk": (
        '[bridge.out]\n\ndeny = ["ok", "a//b"]',
        (
            '3: bridge.out.deny[1]: must be a key expression, not "a//b": empty chunks are forbidden, as well as '
            "leading and trailing slashes"
        ),
    ),
    "key expression not canonical": (
        '[bridge.in]\nallow = ["a/**/**"]',
        (
            '2: bridge.in.allow[0]: must be a key expression, not "a/**/**": `**/**` must be replaced by `**` to reach '
            "canon-form"
        ),
    ),
    "name of a ROS 2 topic": (
        '[bridge.out]\nbypass = ["/cmd_vel"]',
        (
            '2: bridge.out.bypass[0]: must be a key expression, not "/cmd_vel": empty chunks are forbidden, as well as '
            'leading and trailing slashes; the ROS 2 topic /cmd_vel has keys like "*/cmd_vel/**"'
        ),
    ),
    "bypass of what comes in": (
        '[bridge.in]\nbypass = ["a"]',
        '2: bridge.in.bypass: unknown key (known keys: "allow", "deny")',
    ),
    "into is no table": ("[bridge]\ninto = {}", '2: bridge.into: unknown key (did you mean "in"?)'),
    "specs missing": ('[specs]\npath = "none.toml"', "2: specs.path: none.toml does not exist"),
    "specs no path": ('[specs]\npath = "a\\u0000b.toml"', "2: specs.path: must be a path, which holds no zero byte"),
    "no folder": ('[record]\nfolder = "a\\u0000"', "2: record.folder: must be a path, which holds no zero byte"),
    "specs no text": ("[specs]\npath = false", "2: specs.path: must be a string, not false"),
    "specs no table": ("specs = false", "1: specs: must be a table, not false"),
    "zenoh no table": ("[mesh]\nzenoh = false", "2: mesh.zenoh: must be a table, not false"),
    "zenoh unknown key": (
        "[mesh.zenoh.transport.link.tx]\nlese = 5",
        '2: mesh.zenoh.transport.link.tx.lese: unknown key of Zenoh (did you mean "lease"?)',
    ),
    "zenoh mode is a table": (
        '[app.zenoh.mode]\nrouter = "x"',
        "2: app.zenoh.mode.router: unknown key of Zenoh",
    ),
    "zenoh wrong value": (
        '[app.zenoh]\nmode = "boss"',
        ("2: app.zenoh.mode: Zenoh refuses it: unknown variant `boss`, expected one of `router`, `peer`, `client`"),
    ),
    "zenoh app mode": (
        '[app.zenoh]\nmode = "client"',
        '2: app.zenoh.mode: must be "router" if it is set: the daemon is that on this side',
    ),
    "zenoh mesh mode": (
        '[mesh.zenoh]\nmode = "client"',
        (
            '2: mesh.zenoh.mode: must be "peer" if it is set: '
            "the daemon is that on this side; mesh.mode says how robots meet"
        ),
    ),
    "zenoh mesh mode of a client": (
        '[mesh]\nmode = "client"\nconnect = ["tcp/10.0.0.1:7447"]\n[mesh.zenoh]\nmode = "peer"',
        (
            '5: mesh.zenoh.mode: must be "router" if it is set: '
            "the daemon is that on this side; mesh.mode says how robots meet"
        ),
    ),
    "no TOML": ("robot = r1", '1: not valid TOML: Invalid value (column 9); text and quantities stand in quotes: "r1"'),
    "key twice": (
        'robot = "a"\nrobot = "b"\n[log]',
        "2: not valid TOML: Cannot overwrite a value (column 12)",
    ),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_mistake_in_the_file_is_named_with_its_line_and_key(problems, name):
    """The message says where the mistake is, what is wrong and what would be right."""
    text, message = BROKEN[name]
    assert problems(text) == [f"sendworthy.toml:{message}"]


def test_a_missing_file_is_a_mistake(tmp_path):
    """A configuration that was asked for must be there."""
    with pytest.raises(ConfigError) as refused:
        load_config(tmp_path / "gone.toml", {}, {})
    assert refused.value.problems == (f"{tmp_path}/gone.toml: does not exist",)


@pytest.mark.parametrize(
    ("environ", "message"),
    [
        (
            {"SENDWORTHY_MESH__SCOUTING": "maybe"},
            'SENDWORTHY_MESH__SCOUTING: mesh.scouting: must be true or false, not "maybe"',
        ),
        (
            {"SENDWORTHY_MESH__CONNECT": "tcp/a:1"},
            'SENDWORTHY_MESH__CONNECT: mesh.connect: must be an array: write ["tcp/a:1"] instead of "tcp/a:1"',
        ),
        (
            {"SENDWORTHY_MESH__CONNECT": '["tcp/a:1", "b"]'},
            f'SENDWORTHY_MESH__CONNECT: mesh.connect[1]: {ENDPOINT} "b"',
        ),
        (
            {"SENDWORTHY_PLANNER__ITERATION": "5"},
            ('SENDWORTHY_PLANNER__ITERATION: unknown key planner.iteration (did you mean "planner.iterations"?)'),
        ),
        (
            {"SENDWORTHY_ROBOT__NAME": "r1"},
            'SENDWORTHY_ROBOT__NAME: unknown key robot.name (did you mean "robot"?)',
        ),
        (
            {"SENDWORTHY_APP__ZENOH__MODE": "boss"},
            (
                "SENDWORTHY_APP__ZENOH__MODE: app.zenoh.mode: Zenoh refuses it: unknown variant `boss`, "
                "expected one of `router`, `peer`, `client`"
            ),
        ),
        ({"SENDWORTHY_SPECS__PATH": "/a.toml"}, "SENDWORTHY_SPECS__PATH: specs.path: /a.toml does not exist"),
    ],
)
def test_a_mistake_in_a_variable_names_the_variable(problems, environ, message):
    """The file is not to blame for what the environment says."""
    assert problems('robot = "r1"', environ) == [message]


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        ({"mesh.scouting": "maybe"}, '--mesh.scouting: must be true or false, not "maybe"'),
        ({"mesh.connect": '["b"]'}, f'--mesh.connect: mesh.connect[0]: {ENDPOINT} "b"'),
        ({"planner.iteration": "5"}, "--planner.iteration: unknown key planner.iteration (did you mean"),
        ({"robot": ""}, "--robot: must not be empty"),
    ],
)
def test_a_mistake_in_a_flag_names_the_flag(problems, overrides, message):
    """A flag is called by its name, without repeating its key."""
    (problem,) = problems("", {}, overrides)
    assert problem.startswith(message)


def test_all_mistakes_are_reported_at_once_in_the_order_of_the_file(problems):
    """One run shows everything that is to be mended: the file by lines, then variables and flags."""
    found = problems(
        '[planner]\nsearch = "bad"\n[mesh]\nscouting = 1.5\n[mesh.zenoh]\nmod = "peer"\n[specs]\npath = "gone.toml"',
        {"SENDWORTHY_LOG__LEVEL": "loud"},
        {"mode": "on"},
    )
    assert [problem.split(": ")[0] for problem in found] == [
        "sendworthy.toml:2",
        "sendworthy.toml:4",
        "sendworthy.toml:6",
        "sendworthy.toml:8",
        "--mode",
        "SENDWORTHY_LOG__LEVEL",
    ]


def test_mistakes_of_all_files_come_in_the_order_of_the_files(problems, tmp_path):
    """Each with its own line; what a later file replaces is not looked at."""
    (tmp_path / "conf.d").mkdir()
    (tmp_path / "conf.d" / "b.toml").write_text('[planner]\nsearch = "bad"\n[mesh.zenoh]\nmod = "peer"')
    (tmp_path / "conf.d" / "a.toml").write_text("\n\nrobto = 1\n[log]\nlevel = 'info'")
    found = problems("mode = 'fast'\nplanner.search = 1\nlog.level = 3", {"SENDWORTHY_ROBOT": "a/b"})
    assert [problem.split(": ")[0] for problem in found] == [
        "sendworthy.toml:1",
        "conf.d/a.toml:3",
        "conf.d/b.toml:2",
        "conf.d/b.toml:4",
        "SENDWORTHY_ROBOT",
    ]


def test_paths_are_relative_to_the_main_file_in_whichever_they_stand(load, tmp_path):
    """So a file of conf.d may name what is beside the main one."""
    (tmp_path / "conf.d").mkdir()
    (tmp_path / "conf.d" / "a.toml").write_text('specs.path = "mine"\nrecord.folder = "drive"')
    config = load("")
    assert (config.specs.path, config.record.folder) == (tmp_path / "mine", tmp_path / "drive")


def test_paths_in_tables_of_zenoh_are_relative_to_the_main_file_too(load, tmp_path, monkeypatch):
    """Certificates, keys and dictionaries; what a flag names is meant from where one is."""
    (tmp_path / "tls").mkdir()
    for name in ("ca.pem", "r1.pem", "r1.key", "users"):
        (tmp_path / "tls" / name).touch()
    (tmp_path / "conf.d").mkdir()
    (tmp_path / "conf.d" / "tls.toml").write_text(
        '[mesh.zenoh.transport.link.tls]\nroot_ca_certificate = "tls/ca.pem"\nlisten_certificate = "tls/gone.pem"\n'
        '[app.zenoh.transport.auth.usrpwd]\nuser = "tls/ca.pem"\ndictionary_file = "tls/users"'
    )
    (tmp_path / "tls" / "here").mkdir()
    (tmp_path / "tls" / "here" / "r1.pem").touch()
    monkeypatch.chdir(tmp_path / "tls")
    config = load("", {}, {"mesh.zenoh.transport.link.tls.listen_certificate": "here/r1.pem"})
    tls = {"root_ca_certificate": str(tmp_path / "tls" / "ca.pem"), "listen_certificate": "here/r1.pem"}
    assert config.mesh.zenoh == {"transport": {"link": {"tls": tls}}}
    users = {"user": "tls/ca.pem", "dictionary_file": str(tmp_path / "tls" / "users")}
    assert config.app.zenoh == {"transport": {"auth": {"usrpwd": users}}}
    with pytest.raises(ConfigError) as refused:
        load("")
    key = "mesh.zenoh.transport.link.tls.listen_certificate"
    assert refused.value.problems == (f"{tmp_path}/conf.d/tls.toml:3: {key}: {tmp_path}/tls/gone.pem does not exist",)


def test_a_flag_mends_a_mistake_of_the_file(load):
    """What a higher layer replaces is not looked at."""
    assert load('mode = "bad"', {}, {"mode": "pass"}).mode is Mode.PASS


@settings(max_examples=40)
@given(st.text(max_size=60))
def test_any_text_is_a_configuration_or_a_clear_error(tmp_path_factory, text):
    """No file makes the reader fail in any other way."""
    path = tmp_path_factory.mktemp("config") / "sendworthy.toml"
    path.write_bytes(text.encode("utf-8", "surrogatepass"))
    problems = ()
    try:
        load_config(path, {}, {})
    except ConfigError as error:
        problems = error.problems
    assert all(problem.startswith(str(path)) for problem in problems)
