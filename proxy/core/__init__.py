"""The decision core: no I/O, no clock. Events come in, commands go out."""
