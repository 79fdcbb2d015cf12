"""Traffic from CSV."""

import tracemalloc

import pytest

from studies.foreign import csv_files
from studies.foreign.arrived import Arrived
from studies.foreign.csv_files import LONGEST_LINE, Table, is_key
from studies.foreign.errors import ImportFailedError

HEAD = "t_gen,robot,key,size,red,note\n"


@pytest.fixture
def table(tmp_path):
    def write(text):
        path = tmp_path / "traffic.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return Table(path)

    return write


def test_columns_of_numbers_are_features_and_text_is_ignored(table):
    """An empty field, or one that is not finite, is no feature; nor are columns without a name."""
    found = table(HEAD + "0.5,r1,robot/r1/camera,1000,0.25,dark\n1,r2,a,0,,\n\n2,r2,a,7,inf,3\n")
    assert list(found.samples()) == [
        Arrived(0.5, "r1", "robot/r1/camera", 1000, {"red": 0.25}),
        Arrived(1.0, "r2", "a", 0),
        Arrived(2.0, "r2", "a", 7),
    ]
    assert found.ignored == ["note"]


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_what_programs_write_is_read(table, separator):
    """Columns in any order, with a byte order mark, quotes and other ends of lines."""
    text = '\ufeffsize,"key",robot , t_gen,\r\n1e3,"a/b",r1, 1.5,\r\n'
    assert list(table(text.replace(",", separator)).samples()) == [Arrived(1.5, "r1", "a/b", 1000)]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "traffic.csv is empty"),
        ("\n", "traffic.csv:1: the header is empty"),
        (HEAD, "traffic.csv has no line below its header"),
        ("t_gen,robot,kye,size\n", 'traffic.csv:1: there is no column "key" (did you mean "kye"?)'),
        ("a,b\n", 'traffic.csv:1: there is no column "t_gen" (known: "a", "b")'),
        ("t_gen,robot,key,size,size\n", 'traffic.csv:1: the column "size" is there twice'),
        (HEAD + "1,r1,a,5,1,x\nx,r1,a,5,1,x\n", 'traffic.csv:3: column "t_gen" (1): "x" is not a number'),
        (HEAD + "1,r1,a,5,1,x\n,r1,a,5,1,x\n", 'traffic.csv:3: column "t_gen" (1): is empty'),
        (HEAD + "nan,r1,a,5,1,x\n", 'traffic.csv:2: column "t_gen" (1): nan is not finite'),
        (HEAD + "1.7e18,r1,a,5,1,x\n", "1.7e18 s is no time: is it in nanoseconds?"),
        (HEAD + "1,r1,a,5.5,1,x\n", 'traffic.csv:2: column "size" (4): "5.5" is not a whole number of bytes'),
        (HEAD + "1,r1,a,-5,1,x\n", 'column "size" (4): "-5" is not a whole number of bytes'),
        (HEAD + "1,r1,/a,5,1,x\n", 'traffic.csv:2: column "key" (3): "/a" is no key'),
        (HEAD + "1,r1,a/*,5,1,x\n", '"a/*" is no key'),
        (HEAD + "1,,a,5,1,x\n", 'traffic.csv:2: column "robot" (2): must not be empty'),
        (HEAD + "1,r/1,a,5,1,x\n", 'traffic.csv:2: column "robot" (2): must be one chunk of a key, without /: "r/1"'),
        (HEAD + "1,r\x1b,a,5,1,x\n", "without '\\x1b': \"r\ufffd\""),
        (HEAD + "1,r1,a,5,1,x\n2,r1,a,5,red,x\n", 'traffic.csv:3: column "red" (5): "red" is not a number'),
        (HEAD + "1,r1,a\n", "traffic.csv:2: 3 fields, but the header has 6"),
        (HEAD + '1,r1,a,5,1,"x\n', "traffic.csv:2: this is no line of CSV"),
        (HEAD + "1,r1,a,5,1," + "x" * LONGEST_LINE + "\n", "traffic.csv:2: the line has more than 65,536 characters"),
        (HEAD + "1,r1,a,5,1,\0\n", "traffic.csv:2: there are zero bytes in it"),
        (b"\x89MCAP0\r\n" + bytes(range(256)), "traffic.csv is no text in UTF-8"),
    ],
)
def test_mistakes_are_named_by_file_line_and_column(table, text, message):
    """With what to write instead."""
    with pytest.raises(ImportFailedError) as raised:
        list(table(text).samples())
    assert message in str(raised.value)


def test_lines_may_be_in_any_order(table, monkeypatch):
    """What is more than a run is put in order on the disk."""
    monkeypatch.setattr(csv_files, "RUN", 10)
    times = [(7 * i) % 50 for i in range(50)]
    found = list(table(HEAD + "".join(f"{t},r1,a,{i},1,\n" for i, t in enumerate(times))).samples())
    assert [each.t_gen for each in found] == sorted(times)
    assert {each.size for each in found} == set(range(50))


@pytest.mark.full
def test_a_file_is_never_held(table):
    """However long it is."""
    found = table(HEAD + "".join(f"{i},r1,a,{i},1,\n" for i in range(20_000)))
    tracemalloc.start()
    try:
        assert sum(1 for _ in found.samples()) == 20_000
        assert tracemalloc.get_traced_memory()[1] < 300_000
    finally:
        tracemalloc.stop()


def test_keys_are_those_of_zenoh():
    """No expressions for several."""
    assert [is_key(each) for each in ("a", "a/b c", "", "a//b", "a/", "**", "a/$*")] == [True, True, *[False] * 5]
