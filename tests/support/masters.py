"""How a random run's master is described: the input mode, and what belongs to the mode MEASURED."""

from hypothesis import strategies as st

from motionsync.master import MasterInput

INPUT_MODES = st.fixed_dictionaries(
    {
        "master.input_mode": st.sampled_from([int(mode) for mode in MasterInput]),
        "master.smoothing_time": st.one_of(st.sampled_from((0.02, 0.0, 10.0)), st.floats(0.0, 1.0)),
        "master.delay": st.sampled_from((0.0, 0.0, 0.004, 1.0)),
        "master.sample_time": st.one_of(st.sampled_from((0.0, 0.0, 1e-9, 1.0)), st.floats(1e-3, 0.1)),
    }
)
