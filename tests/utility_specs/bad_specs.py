"""Broken specs, each with all that its author shall read.

Each is the good spec with some text replaced, or a text of its own; messages come without the file's name.
"""

from dataclasses import dataclass

GOOD = """\
[[constraint]]
kind = "throughput"
limit = "2 Mbit/s"
window = 0.5

[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
aggregation = "most_recent"
weight = 1.0
utility = { kind = "video" }
scale = "1 + 10 * red"
features.red = { kind = "color_fraction", color = "red" }
forecast = { features = "last" }
"""
CAMERA = 'information_type "camera"'
ENDS = ", without a slash at its ends"
CHUNKS = "empty chunks are forbidden, as well as leading and trailing slashes"
NAME_RULE = "must be 1 to 64 letters, digits, spaces, dots, - or _, not"
UTILITIES = '"exponential", "linear", "polynomial", "power", "python", "step", "table", "video"'
REPEATED = "must be an array of tables: write"
MEANING = "this name has a meaning in expressions; choose another one for the feature"


@dataclass(frozen=True, slots=True)
class Bad:
    """A broken spec: `wrong` stands where `right` stood in the good one."""

    right: str
    wrong: str
    messages: tuple[str, ...]

    @property
    def text(self) -> str:
        """The whole file."""
        assert self.right in GOOD, f"{self.right} is not in the good spec"
        return GOOD.replace(self.right, self.wrong, 1)


def bad(right: str, wrong: str, *messages: str) -> Bad:
    """Return a broken spec."""
    return Bad(right, wrong, messages)


def camera(line: int, key: str, message: str) -> str:
    """Return a message about the information type of the good spec."""
    return f":{line}: {CAMERA}: {key}: {message}"


LIMIT = ":3: constraint #1: limit: "
KINDS = '(known: "airtime", "energy", "messages", "throughput")'
WINDOW = ":4: constraint #1: window: "

CORPUS = [
    # constraints
    bad('"throughput"', '"thruput"',
        ':2: constraint #1: kind: unknown kind "thruput" (did you mean "throughput"?)'),
    bad('"throughput"', '"power"', f':2: constraint #1: kind: unknown kind "power" {KINDS}'),
    bad('"throughput"', "3", f':2: constraint #1: kind: unknown kind "3" {KINDS}'),
    bad('kind = "throughput"\n', "",
        ':1: constraint #1: kind: is missing (one of "airtime", "energy", "messages", "throughput")'),
    bad('"throughput"', '"messages"', LIMIT + 'must be a whole number, not "2 Mbit/s"'),
    bad('throughput"\nlimit = "2 Mbit/s"', 'messages"\nlimit = 0', LIMIT + "must be at least 1, not 0"),
    bad('throughput"\nlimit = "2 Mbit/s"', 'messages"\nlimit = 2.5', LIMIT + "must be a whole number, not 2.5"),
    bad('throughput"\nlimit = "2 Mbit/s"', 'airtime"\nlimit = 40',
        ":1: constraint #1: rate: is missing", LIMIT + "must be a fraction of at most 1, not 40"),
    bad('throughput"\nlimit = "2 Mbit/s"', 'airtime"\nlimit = "120 %"\nrate = "1 MB/s"',
        LIMIT + 'must be a fraction of at most 1, not "120 %"'),
    bad('throughput"\nlimit = "2 Mbit/s"', 'airtime"\nlimit = "40 %"\nrate = "54 Mbps"\nwifi = "mesh"\nhops = 0',
        ':4: constraint #1: rate: unknown unit "Mbps" (did you mean "Mbit/s"?)',
        ':5: constraint #1: wifi: unknown "mesh" (known: "adhoc", "infrastructure", "wired")',
        ":6: constraint #1: hops: must be at least 1, not 0"),
    bad('throughput"\nlimit = "2 Mbit/s"', 'energy"\nlimit = "1 J"',
        ":1: constraint #1: needs per_byte or per_message, or both: what does a message cost?"),
    bad('throughput"\nlimit = "2 Mbit/s"', 'energy"\nlimit = 1\nper_byte = "2 W"',
        LIMIT + 'needs a unit; write for example "0.5 J"',
        ':4: constraint #1: per_byte: unknown unit "W" '
        '(known units: "J", "mJ", "uJ", "μJ", "nJ", "kJ", "mWh", "Wh")'),
    bad('limit = "2 Mbit/s"\n', "", ":1: constraint #1: limit: is missing"),
    bad('"2 Mbit/s"', "2000000", LIMIT + 'needs a unit; write for example "2 Mbit/s"'),
    bad('"2 Mbit/s"', '"2"', LIMIT + 'needs a unit; write for example "2 Mbit/s"'),
    bad('"2 Mbit/s"', '"2 Mbps"', LIMIT + 'unknown unit "Mbps" (did you mean "Mbit/s"?)'),
    bad('"2 Mbit/s"', '"2 mbit/s"', LIMIT + 'unknown unit "mbit/s" (did you mean "Mbit/s"?)'),
    bad('"2 Mbit/s"', '"fast"', LIMIT + '"fast" is not a rate; write for example "2 Mbit/s"'),
    bad('"2 Mbit/s"', '"0 Mbit/s"', LIMIT + 'must be a finite rate above 0, not "0 Mbit/s"'),
    bad('"2 Mbit/s"', '"-1 Mbit/s"', LIMIT + 'must be a finite rate above 0, not "-1 Mbit/s"'),
    bad('"2 Mbit/s"', "true", LIMIT + 'must be a rate such as "2 Mbit/s", not true'),
    bad('"2 Mbit/s"', '["2 Mbit/s"]', LIMIT + 'must be a rate such as "2 Mbit/s", not an array'),
    bad('"2 Mbit/s"', '"adaptive"',
        ':1: constraint #1: limit = "adaptive" needs a ceiling: the most that the channel can carry at its best'),
    bad('"2 Mbit/s"', '"adaptive"\nceiling = "1 Mbit/s"\nfloor = "2 Mbit/s"',
        ":1: constraint #1: floor is above ceiling"),
    bad('"2 Mbit/s"', '"2 Mbit/s"\nceiling = "6 Mbit/s"',
        ':1: constraint #1: floor and ceiling are for limit = "adaptive"; a fixed limit has none'),
    bad('"2 Mbit/s"', '"adaptive"\nceiling = "6 Mbps"',
        ':4: constraint #1: ceiling: unknown unit "Mbps" (did you mean "Mbit/s"?)'),
    bad('"2 Mbit/s"', '"adaptiv"', LIMIT + '"adaptiv" is not a rate; write for example "2 Mbit/s"'),
    bad("0.5", "0", WINDOW + "must be a finite duration above 0, not 0"),
    bad("0.5", "-0.5", WINDOW + "must be a finite duration above 0, not -0.5"),
    bad("0.5", "inf", WINDOW + "must be a finite duration above 0, not inf"),
    bad("0.5", '"500 msec"', WINDOW + 'unknown unit "msec" (did you mean "ms"?)'),
    bad("window", "windows", ':4: constraint #1: windows: unknown key (did you mean "window"?)'),
    bad("[[constraint]]", "[constraint]",
        f":1: constraint: {REPEATED} [[constraint]] instead of [constraint]"),
    bad("[[constraint]]", "[[constraints]]", ':1: constraints: unknown key (did you mean "constraint"?)'),
    bad("[[constraint]]", '[[constraint]]\nname = ""', f':2: constraint #1: name: {NAME_RULE} ""'),
    bad("[[information_type]]", '[[constraint]]\nkind = "throughput"\nname = "air"\nlimit = "1 B/s"\n'
        '[[constraint]]\nkind = "throughput"\nname = "air"\nlimit = "1 B/s"\n[[information_type]]',
        ':12: constraint "air": name: "air" is already the name of the one at FILE:8'),
    # the file
    bad("[[constraint]]", "version = 2\n[[constraint]]", ":1: version: must be 1, not 2"),
    bad("[[constraint]]", 'version = "1"\n[[constraint]]', ':1: version: must be the whole number 1, not "1"'),
    bad("[[constraint]]", "verison = 1\n[[constraint]]",
        ':1: verison: unknown key (did you mean "version"?)'),
    bad("[[constraint]]", "colour = 1\n[[constraint]]",
        ':1: colour: unknown key (known keys: "version", "floor", "fallback", "constants", "constraint", '
            '"information_type")'),
    bad(GOOD, "", ": information_type: is missing; a spec needs at least one"),
    bad(GOOD, "information_type = []", ": information_type: is missing; a spec needs at least one"),
    bad(GOOD, "information_type = 3", ":1: information_type: must be an array, not 3"),
    bad(GOOD, "[[information_type]]\n[[information_type]]\n",
        ":1: information_type #1: name: is missing", ":1: information_type #1: keys: is missing",
        ":1: information_type #1: utility: is missing", ":2: information_type #2: name: is missing",
        ":2: information_type #2: keys: is missing", ":2: information_type #2: utility: is missing"),
    bad("[[information_type]]", "[information_type]",
        f":6: information_type: {REPEATED} [[information_type]] instead of [information_type]"),
    bad("[[information_type]]", "[[information_types]]", ':6: information_types: unknown key '
        '(did you mean "information_type"?)'),
    bad("weight = 1.0", "weight =", ":10: not valid TOML: Invalid value (column 9)"),
    bad("weight = 1.0", "weight 1.0",
        ":10: not valid TOML: Expected '=' after a key in a key/value pair (column 8)"),
    bad("weight = 1.0", "name = 'x'", ":10: not valid TOML: Cannot overwrite a value (column 11)"),
    bad("[[information_type]]", "[[information_type]",
        ":6: not valid TOML: Expected ']]' at the end of an array declaration (column 19)"),
    # names and keys
    bad('name = "camera"\n', "", ":6: information_type #1: name: is missing"),
    bad('name = "camera"', 'name = ""', f':7: information_type #1: name: {NAME_RULE} ""'),
    bad('name = "camera"', 'name = "a\\nb"',
        f':7: information_type "a\ufffdb": name: {NAME_RULE} "a\ufffdb"'),
    bad('name = "camera"', f'name = "{"x" * 65}"',
        f':7: information_type "{"x" * 39}…": name: {NAME_RULE} "{"x" * 39}…"'),
    bad('name = "camera"', "name = 7", ":7: information_type #1: name: must be a string, not 7"),
    bad('keys = ["robot/*/camera"]\n', "", camera(6, "keys", "is missing")),
    bad('["robot/*/camera"]', "[]", camera(8, "keys", "must not be empty")),
    bad('["robot/*/camera"]', '"robot/*/camera"',
        camera(8, "keys", 'must be an array: write ["robot/*/camera"] instead of "robot/*/camera"')),
    bad('["robot/*/camera"]', "[1]", camera(8, "keys[0]", "must be a string, not 1")),
    bad('"robot/*/camera"', '"/robot"', camera(8, "keys[0]", f'"/robot" is not a key expression: write "robot"{ENDS}')),
    bad('"robot/*/camera"', '"a", "b//c"', camera(8, "keys[1]", f'"b//c" is not a key expression: {CHUNKS}')),
    bad('"robot/*/camera"', '\n"a/"', camera(9, "keys[0]", f'"a/" is not a key expression: write "a"{ENDS}')),
    bad('"robot/*/camera"', '""', camera(8, "keys[0]", f'"" is not a key expression: {CHUNKS}')),
    bad('"robot/*/camera"', '"a#b"',
        camera(8, "keys[0]", '"a#b" is not a key expression: `#` and `?` are forbidden characters')),
    bad('"robot/*/camera"', '"cam*"',
        camera(8, "keys[0]", '"cam*" is not a key expression: `*` may only be preceded by `/` or `$`')),
    bad('"robot/*/camera"', '"a$b"',
        camera(8, "keys[0]", '"a$b" is not a key expression: `$` is only allowed in `$*`')),
    bad('"robot/*/camera"', '"a/**/*"', camera(8, "keys[0]",
        '"a/**/*" is not a key expression: `**/*` must be replaced by `*/**` to reach canon-form')),
    bad("[[constraint]]",
        '[[information_type]]\nname = "camera"\nkeys = ["x"]\nutility.kind = "video"\n[[constraint]]',
        ':11: information_type "camera": name: "camera" is already the name of the one at FILE:2'),
    # worth
    bad('"most_recent"', '"most_recnt"',
        camera(9, "aggregation", 'unknown "most_recnt" (did you mean "most_recent"?)')),
    bad('"most_recent"', '"mean"', camera(9, "aggregation",
        'unknown "mean" (known: "most_recent", "best", "sum", "once", "current")')),
    bad('"most_recent"', "3", camera(9, "aggregation",
        'must be "most_recent", "best", "sum", "once", "current", not 3')),
    bad('"most_recent"\nweight = 1.0\nutility = { kind = "video"', '"current"\nutility = { kind = "power", beta = 0.5',
        camera(9, "aggregation",
        '"current" needs a utility that is finite at the age 0, to know what is lost; "power" is not')),
    bad('"most_recent"', '{ kind = "sum" }', camera(9, "aggregation.python", "is missing"),
        camera(9, "aggregation.kind", 'unknown key (known keys: "python")')),
    bad('"most_recent"', '{ python = "coverage" }', camera(9, "aggregation.python",
        '"coverage" is not the path of a class; write "package.module:name"')),
    bad('"most_recent"', '{ python = "math:pi" }',
        camera(9, "aggregation.python", '"math:pi" is a float, not a class')),
    bad('"most_recent"', '{ python = "tests.utility_specs.models:Greatset" }', camera(9, "aggregation.python",
        '"tests.utility_specs.models" has no "Greatset" (did you mean "Greatest"?)')),
    bad('"most_recent"', '{ python = "tests.utility_specs.models:Failing" }',
        camera(9, "aggregation", "Failing.add() failed: RuntimeError: one two")),
    bad('"most_recent"', '{ python = "tests.utility_specs.models:Lacking" }', camera(9, "aggregation",
        "tests.utility_specs.models:Lacking has no add() and no value(); an aggregation has empty, add, value")),
    bad("1.0", "-1", camera(10, "weight", "must be at least 0, not -1")),
    bad("1.0", "nan", camera(10, "weight", "must be a finite number, not nan")),
    bad("1.0", "inf", camera(10, "weight", "must be a finite number, not inf")),
    bad("1.0", '"one"', camera(10, "weight", 'unknown feature "one" (known: "red")')),
    bad("1.0", '"-"', camera(10, "weight", "is not an expression: invalid syntax (at its end)")),
    bad("1.0", '["red"]', camera(10, "weight", "must be a number or an expression, not an array")),
    bad("1.0", "true", camera(10, "weight", "must be a number or an expression, not true")),
    bad("1.0", "0x" + "f" * 5000, camera(10, "weight", "must be a finite number, not a huge number")),
    bad("weight", "wieght", camera(10, "wieght", 'unknown key (did you mean "weight"?)')),
    bad('utility = { kind = "video" }\n', "", camera(6, "utility", "is missing")),
    bad('{ kind = "video" }', '"video"',
        camera(11, "utility", 'must be a table: write { kind = "video" } instead of "video"')),
    bad('{ kind = "video" }', "{}", camera(11, "utility.kind", f"is missing (one of {UTILITIES})")),
    bad('"video"', '"vidoe"', camera(11, "utility.kind", 'unknown kind "vidoe" (did you mean "video"?)')),
    bad('"video"', '"freshest"', camera(11, "utility.kind", f'unknown kind "freshest" (known: {UTILITIES})')),
    bad('"video"', '"linear"', camera(11, "utility.slope", "is missing")),
    bad('"video"', '"linear", slope = 0', camera(11, "utility.slope", "must be more than 0, not 0")),
    bad('"video"', '"linear", slope = 1, u0 = -1', camera(11, "utility.u0", "must be more than 0, not -1")),
    bad('"video"', '"linear", slope = 1, a0 = 1',
        camera(11, "utility.a0", 'unknown key (known keys: "kind", "u0", "slope")')),
    bad('"video"', '"video", a0 = 20', camera(11, "utility.a1", "must be more than a0 (20 s), not 10 s")),
    bad('"video"', '"video", a1 = "30 ms"',
        camera(11, "utility.a1", "must be more than a0 (0.0333333 s), not 0.03 s")),
    bad('"video"', '"video", a0 = "x"',
        camera(11, "utility.a0", '"x" is not a duration; write for example "200 ms"')),
    bad('"video"', '"exponential", tau = 0',
        camera(11, "utility.tau", "must be a finite duration above 0, not 0")),
    bad('"video"', '"step", lifetime = "3 x"', camera(11, "utility.lifetime",
        'unknown unit "x" (known units: "s", "ms", "us", "μs", "min", "h")')),
    bad('"video"', '"polynomial", a1 = 3, k = 0', camera(11, "utility.k", "must be more than 0, not 0")),
    bad('"video"', '"power", beta = 1', camera(11, "utility.beta", "must be less than 1, not 1")),
    bad('"video"', '"table", points = []', camera(11, "utility.points", "must not be empty")),
    bad('"video"', '"table", points = [[0, 1], ["0 s", 2]]',
        camera(11, "utility.points", "must have rising ages, not 0 s after 0 s")),
    bad('"video"', '"table", points = [[0], [1, 2, 3], ["-1 s", 0], 4, [5, -1]]',
        camera(11, "utility.points[0][1]", "is missing"),
        camera(11, "utility.points[1]", "must hold at most 2 values, not 3"),
        camera(11, "utility.points[2][0]", 'must be a finite duration of at least 0, not "-1 s"'),
        camera(11, "utility.points[3]", "must be an array, not 4"),
        camera(11, "utility.points[4][1]", "must be at least 0, not -1")),
    bad('"video"', '"table", points = [[0, 1e308], [1e-300, 0]]',
        camera(11, "utility.points[0][1]", "must be at most 1e+15, not 1e+308"),
        camera(11, "utility.points[1][0]", "must be a duration of at least 1e-09 s, not 1e-300")),
    bad('"video"', '"python"', camera(11, "utility.function", "is missing")),
    bad('"video"', '"python", function = "math:sqr"',
        camera(11, "utility.function", '"math" has no "sqr" (did you mean "sqrt"?)')),
    bad('"video"', '"python", function = "tests.utility_specs.worths:by_blue"', camera(11, "utility",
        "tests.utility_specs.worths:by_blue raises KeyError: 'blue'")),
    bad('"video"', '"python", function = "tests.utility_specs.worths:two_lines"', camera(11, "utility",
        "tests.utility_specs.worths:two_lines raises RuntimeError: one two")),
    # scale
    bad("10 * red", "10 * redd", camera(12, "scale", 'unknown feature "redd" (did you mean "red"?)')),
    bad("10 * red", "10 * red +", camera(12, "scale", "is not an expression: invalid syntax (at its end)")),
    bad("10 * red", "mx(red, 1)", camera(12, "scale", 'unknown function "mx" (did you mean "max"?)')),
    bad("10 * red", "max(red)", camera(12, "scale", "max takes at least 2 arguments, not 1")),
    bad('"1 + 10 * red"', '""', camera(12, "scale", "is empty")),
    bad('"1 + 10 * red"', '"1 / 0"', camera(12, "scale", '"1 / 0" divides by zero')),
    bad('"1 + 10 * red"', "2", camera(12, "scale", "must be a string, not 2")),
    bad('features.red = { kind = "color_fraction", color = "red" }\n', "",
        camera(12, "scale", 'unknown feature "red" (this type has no features)')),
    # features
    bad('"color_fraction"', '"color_fractoin"',
        camera(13, "features.red.kind", 'unknown kind "color_fractoin" (did you mean "color_fraction"?)')),
    bad('color = "red"', 'color = "rd"',
        camera(13, "features.red.color", 'unknown "rd" (did you mean "red"?)')),
    bad(', color = "red"', "", camera(13, "features.red.color", "is missing")),
    bad('color = "red"', 'colour = "red"', camera(13, "features.red.color", "is missing"),
        camera(13, "features.red.colour", 'unknown key (did you mean "color"?)')),
    bad('color = "red"', 'color = "red", default = nan',
        camera(13, "features.red.default", "must be a finite number, not nan")),
    bad('"video" }', '"python", function = "tests.utility_specs.worths:by_red" }\n'
        + "".join(f'features.f{n} = {{ kind = "size" }}\n' for n in range(32)),
        camera(12, "features", "a python utility has at most 32 features, not 33")),
    bad("features.red = ", "features.max = ", camera(13, "features.max", MEANING)),
    bad("features.red = ", "features.if = ", camera(13, "features.if", MEANING)),
    bad("features.red = ", 'features."red pixels" = ', camera(13, 'features."red pixels"',
        "a feature's name must be letters, digits and _, and not begin with a digit")),
    bad("features.red = ", "features.red.x = ",
        camera(13, "features.red.kind", 'is missing (one of "attachment", "brightness", "cdr", "change", '
            '"color_fraction", "json", "key_chunk", "msgpack", "python", "sharpness", "size")')),
    bad('{ kind = "color_fraction", color = "red" }', '"red"',
        camera(13, "features.red", 'must be a table, not "red"')),
    bad('features = "last"', 'features = "mena"',
        camera(14, "forecast.features", 'unknown "mena" (did you mean "mean"?)')),
    bad('features = "last"', 'features = { red = "trnd" }',
        camera(14, "forecast.features.red", 'unknown "trnd" (did you mean "trend"?)')),
    bad('features = "last"', 'features = { redd = "trend" }',
        camera(14, "forecast.features.redd", 'unknown feature "redd" (did you mean "red"?)')),
    bad('features = "last"', 'features = { python = "tests.utility_specs.outlooks:double" }',
        camera(14, "forecast.features.python",
            '"tests.utility_specs.outlooks" has no "double" (did you mean "doubled"?)')),
    bad('features = "last"', 'features = { python = "tests.utility_specs.outlooks:endless" }',
        camera(14, "forecast.features",
            "tests.utility_specs.outlooks:endless returned inf, which is not finite")),
    bad('features = "last"', 'schedule = "atuo"',
        camera(14, "forecast.schedule", 'unknown "atuo" (did you mean "auto"?)')),
    bad('features = "last"', 'schedule = { kind = "periodical", period = 1 }',
        camera(14, "forecast.schedule.kind", 'unknown kind "periodical" (did you mean "periodic"?)')),
    bad('features = "last"', "schedule = { period = 1 }",
        camera(14, "forecast.schedule.kind", 'is missing (one of "periodic", "poisson", "python", "times")')),
    bad('features = "last"', 'schedule = { kind = "periodic", period = "1 m" }',
        camera(14, "forecast.schedule.period", 'unknown unit "m" (did you mean "min"?)')),
    bad('features = "last"', 'schedule = { kind = "periodic", period = 1, phas = 1 }',
        camera(14, "forecast.schedule.phas", 'unknown key (did you mean "phase"?)')),
    bad('features = "last"', 'schedule = { kind = "poisson", rate = 0.2 }',
        camera(14, "forecast.schedule.rate", 'needs a unit; write for example "0.2 Hz"')),
    bad('features = "last"', 'schedule = { kind = "poisson", rate = "1 Hz", interval = "1 s" }',
        camera(14, "forecast.schedule", 'needs one of rate (such as "0.2 Hz") and interval (such as "5 s")')),
    bad('features = "last"', 'schedule = { kind = "poisson" }',
        camera(14, "forecast.schedule", 'needs one of rate (such as "0.2 Hz") and interval (such as "5 s")')),
    bad('features = "last"', 'schedule = { kind = "times", times = [] }',
        camera(14, "forecast.schedule.times", "must not be empty")),
    bad('features = "last"', 'schedule = { kind = "times", times = [0, "2 s", 1] }',
        camera(14, "forecast.schedule.times", "must rise, not have 1 s after 2 s")),
    bad('features = "last"', 'schedule = { kind = "times", times = [1, 4], every = 3 }',
        camera(14, "forecast.schedule.every", "must be more than the 3 s from the first to the last of times")),
    bad('features = "last"', 'schedule = { kind = "python", function = "mision:next" }',
        camera(14, "forecast.schedule.function",
            'cannot import "mision": ModuleNotFoundError: No module named \'mision\'')),
    bad('features = "last"', 'schedule = { kind = "python", function = "tests.utility_specs.outlooks:no_list" }',
        camera(14, "forecast.schedule", "tests.utility_specs.outlooks:no_list failed: TypeError: "
            "'NoneType' object is not iterable")),
    bad('features = "last"', 'feature = "last"',
        camera(14, "forecast.feature", 'unknown key (did you mean "features"?)')),
    # several at once, in the order of the file
    bad('weight = 1.0\nutility = { kind = "video" }', 'weight = -1\nutility = { kind = "v" }\nx = 1',
        camera(10, "weight", "must be at least 0, not -1"),
        camera(11, "utility.kind", f'unknown kind "v" (known: {UTILITIES})'),
        camera(12, "x", 'unknown key (known keys: "name", "keys", "mode", "bypass", "min_rate", "max_age", '
            '"deletes", "queries", "aggregation", "utility", "features", "weight", "scale", "forecast")')),
]  # fmt: skip
