import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from s2glib.corpus import intensity
from s2glib.corpus.intensity import MEAN, STRONGEST
from s2glib.corpus.script import EMOTIONS, SPEAKERS, Cell, split

cells = st.builds(
    Cell,
    st.integers(0, 15),
    st.sampled_from(SPEAKERS),
    st.sampled_from(EMOTIONS),
    st.integers(0, 19),
)


@given(cells)
def test_a_clip_has_one_intensity(cell):
    assert intensity(cell) == intensity(cell)
    assert 0 <= intensity(cell) <= STRONGEST


@given(cells.filter(lambda cell: cell.take >= 10))
def test_a_motion_take_is_as_intense_as_its_speech(cell):
    assert intensity(cell) == intensity(cell._replace(take=cell.take % 2))


def test_no_emotion_is_played_stronger_than_another():
    strengths = {e: [] for e in EMOTIONS}
    for cell in split("test"):
        strengths[cell.emotion].append(intensity(cell))
    means = [np.mean(values) for values in strengths.values()]
    assert np.abs(np.subtract(means, MEAN)).max() < 0.12
