"""Values of fields as they survive the wire, drawn at random."""

from hypothesis import strategies as st

from proxy.core.protocol.fixed import rounded, single
from proxy.core.protocol.tuning import TUNING

time = st.integers(0, 10**13).map(lambda ticks_: ticks_ / 1e4)
count = st.integers(0, 2**53)
samples = st.integers(0, TUNING.samples)
size = st.integers(0, TUNING.sample_bytes)
amount = st.floats(0.0, 3600.0).map(rounded)
period = st.floats(1e-4, 3600.0).map(rounded)
part = st.floats(0.0, 1.0).map(rounded)
feature = st.one_of(st.integers(-(2**53), 2**53).map(float), st.floats(-1e30, 1e30).map(single))
name = st.text(max_size=20)
zid = st.one_of(name, st.binary(min_size=1, max_size=16).map(bytes.hex))
key = st.text(st.characters(exclude_characters="*", exclude_categories=["Cs"]), min_size=1, max_size=20)
