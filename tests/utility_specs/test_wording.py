"""What pydantic says, in words for someone who edits a file."""

from enum import StrEnum
from typing import Annotated, Any, Literal

import pytest
from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, ValidationError

from utility_specs.wording import Place, message_of


class Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class Round(Strict):
    kind: Literal["round"]
    radius: float = 1.0


class Square(Strict):
    kind: Literal["square"]
    side: float = 1.0


class Size(StrEnum):
    SMALL = "small"
    LARGE = "large"


Shape = Annotated[Round | Square, Field(discriminator="kind")]


class Model(Strict):
    word: str = ""
    number: Annotated[float, Field(gt=0.0, le=10.0)] = 1.0
    count: Annotated[int, Field(ge=0, lt=5)] = 1
    yes: bool = True
    choice: Literal["one", "two"] = "one"
    version: Literal[1] = 1
    size: Annotated[Size, Field(strict=False)] = Size.SMALL
    shape: Shape = Round(kind="round")
    shapes: dict[str, Shape] = {}
    inner: Round | None = None
    table: dict[str, int] = {}
    many: list[Round] = []
    few: Annotated[list[str], Field(min_length=1)] = ["x"]
    pair: Annotated[list[int], Field(max_length=2)] = []
    even: Annotated[int, Field(multiple_of=2)] = 2
    filled: Annotated[str, Field(min_length=1)] = "x"
    either: Annotated[
        Annotated[Literal["big"], Tag("name")] | Annotated[Round, Tag("table")],
        Discriminator(lambda value: "table" if isinstance(value, dict) else "name"),
    ] = "big"


def told(data: dict[str, Any]) -> list[str]:
    with pytest.raises(ValidationError) as caught:
        Model.model_validate(data)
    schema = Model.model_json_schema()
    places = [(Place.find(schema, each["loc"], each["type"]), each) for each in caught.value.errors()]
    return [f"{'.'.join(map(str, place.path))}: {message_of(detail, place)}" for place, detail in places]


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        ({"word": 1}, "word: must be a string, not 1"),
        ({"number": "1"}, 'number: must be a number, not "1"'),
        ({"number": 0}, "number: must be more than 0, not 0"),
        ({"number": 11.5}, "number: must be at most 10, not 11.5"),
        ({"number": float("nan")}, "number: must be a finite number, not nan"),
        ({"count": 1.5}, "count: must be a whole number, not 1.5"),
        ({"count": -1}, "count: must be at least 0, not -1"),
        ({"count": 5}, "count: must be less than 5, not 5"),
        ({"yes": "no"}, 'yes: must be true or false, not "no"'),
        ({"choice": "twoo"}, 'choice: unknown "twoo" (did you mean "two"?)'),
        ({"choice": 2}, 'choice: must be "one", "two", not 2'),
        ({"version": 2}, "version: must be 1, not 2"),
        ({"version": "1"}, 'version: must be 1, not "1"'),
        ({"size": "smal"}, 'size: unknown "smal" (did you mean "small"?)'),
        ({"shape": {"kind": "rond"}}, 'shape.kind: unknown kind "rond" (did you mean "round"?)'),
        ({"shape": {}}, 'shape.kind: is missing (one of "round", "square")'),
        ({"shape": "round"}, 'shape: must be a table: write { kind = "round" } instead of "round"'),
        ({"shape": "oval"}, 'shape: must be a table, not "oval"'),
        ({"few": "a"}, 'few: must be an array: write ["a"] instead of "a"'),
        (
            {"few": "[a,b]"},
            'few: must be an array: write ["a", "b"] instead of "[a,b]", on a command line between single quotes',
        ),
        ({"few": "[::1]:80"}, 'few: must be an array: write ["[::1]:80"] instead of "[::1]:80"'),
        ({"shape": {"kind": "round", "side": 1.0}}, 'shape.side: unknown key (known keys: "kind", "radius")'),
        ({"shapes": {"a": {"kind": "square", "side": True}}}, "shapes.a.side: must be a number, not true"),
        ({"inner": {"kind": "round", "radus": 1}}, 'inner.radus: unknown key (did you mean "radius"?)'),
        ({"inner": {"kind": "square"}}, 'inner.kind: unknown kind "square" (known: "round")'),
        ({"table": []}, "table: must be a table, not an array"),
        ({"table": {"a": "b"}}, 'table.a: must be a whole number, not "b"'),
        ({"many": {}}, "many: must be an array of tables: write [[many]] instead of [many]"),
        ({"many": [{}]}, "many.0.kind: is missing"),
        ({"few": {}}, "few: must be an array, not a table"),
        ({"few": []}, "few: must not be empty"),
        ({"either": "bigg"}, 'either: unknown "bigg" (did you mean "big"?)'),
        ({"either": {"kind": "round", "radus": 1}}, 'either.radus: unknown key (did you mean "radius"?)'),
        ({"filled": ""}, "filled: must not be empty"),
        ({"pair": [1, 2, 3]}, "pair: must hold at most 2 values, not 3"),
        ({"even": 3}, "even: input should be a multiple of 2"),
        ({"wrod": 1}, 'wrod: unknown key (did you mean "word"?)'),
    ],
)
def test_each_kind_of_mistake_has_its_words(data, expected):
    """The path is that of the file, the message says what would be right."""
    assert told(data) == [expected]


def test_without_a_schema_the_location_is_taken_as_it_is():
    """A caller without a model still gets the path, less hints."""
    assert Place.find({}, ("a", 0, "b", "[key]"), "missing") == Place(("a", 0, "b"))
