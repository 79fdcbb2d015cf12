"""The simulation study: who reaches what with a radio channel, on ns-3 and on a medium of our own.

A `Task` is one flight; its result is a small record, which a store keeps on disk. What is flown stands in `programme`
as data. Pages and pictures are made of the records alone.
"""
