"""Names of functions are read from memory, where there may be none."""

from proxy.profiling.functions import Functions


def test_a_function_is_named_by_its_code():
    """By file and qualified name."""
    found = Functions().of(id(Functions.of.__code__))
    assert (found.file, found.name) == (Functions.of.__code__.co_filename, "Functions.of")


def test_what_is_no_code_has_no_name():
    """Neither another object, nor memory that is not there."""
    functions = Functions()
    for address in (0, 8, id(functions), id("text"), 2**47 + 16):
        assert functions.of(address) is None
