import numpy as np
import pytest
import torch

from s2glib.corpus import Cell
from s2glib.corpus.build import MotionSet
from s2glib.papers.probtalk import TEACHING_PQVAE, HolisticFeatures
from s2glib.recipes import holistic_data
from s2glib.recipes.holistic_data import Tracks, fitted_features, holistic_clips, whole_face

CELLS = [Cell(s, "voice_01", "anger", take) for s in (0, 1) for take in (0, 10, 11)]
HEARD = 50  # frames of a made-up speech track


@pytest.fixture
def _corpus(monkeypatch):
    """Clips that nobody rendered."""

    def tracks(cells, *shape):
        draws = [np.random.default_rng([c.sentence, c.take]) for c in cells]
        return [
            d.normal(0, 0.3, (30 + 7 * c.take, *shape)) for d, c in zip(draws, cells, strict=True)
        ]

    def half(values):
        return [value.astype(np.float16) for value in values]

    monkeypatch.setattr(
        holistic_data, "motion_set", lambda cells: MotionSet(half(tracks(cells, 55, 3)), 30)
    )
    monkeypatch.setattr(holistic_data, "face_set", lambda cells: half(tracks(cells, 12)))


def spoken(cells):
    """Speech that tells its cell's sentence and take, and counts frames by twos."""
    count = torch.arange(0.0, HEARD, 2)
    for cell in cells:
        yield torch.stack([100 * cell.sentence + 10 * cell.take + 0 * count, count], dim=1)


def of(*rows):
    return np.array(rows)


def test_a_window_is_a_cut_of_its_track_and_holds_the_last_frame():
    tracks = Tracks([torch.arange(5.0)[:, None], 10 + torch.arange(3.0)[:, None]])
    cut = tracks.window(of(1, 0, 0), of(0, 1, 4), 4)[..., 0]
    assert cut.tolist() == [[10, 11, 12, 12], [1, 2, 3, 4], [4, 4, 4, 4]]


@pytest.mark.usefixtures("_corpus")
def test_clips_hold_the_features_of_poses_and_faces():
    features = fitted_features(CELLS, TEACHING_PQVAE)
    clips = holistic_clips(CELLS, features)
    poses, face = holistic_data.motion_set(CELLS[4:5]).poses[0], holistic_data.face_set(CELLS[4:5])
    expected = features.from_motion(torch.from_numpy(poses).float(), whole_face(face[0]))
    cut = clips.moving(of(4), of(3), 20)[0]
    torch.testing.assert_close(cut, expected[3:23], atol=4e-3, rtol=1e-3)
    assert clips.motion.lengths.tolist() == [30, 100, 107] * 2


@pytest.mark.usefixtures("_corpus")
def test_performances_hear_the_speech_they_share_at_their_own_frames():
    clips = holistic_clips(CELLS, HolisticFeatures(12), hear=spoken)
    heard = clips.heard(of(1, 2, 5), of(0, 3, 0), 4)
    assert heard[..., 0].tolist() == [[0.0] * 4, [10.0] * 4, [110.0] * 4]  # takes 0, 1 and 1
    assert heard[..., 1].tolist() == [[0, 2, 4, 6], [6, 8, 10, 12], [0, 2, 4, 6]]
    assert len(clips.speech.lengths) == 4


@pytest.mark.usefixtures("_corpus")
def test_windows_start_where_motion_and_speech_have_room(rng):
    silent = holistic_clips(CELLS, HolisticFeatures(12))
    heard = holistic_clips(CELLS, HolisticFeatures(12), hear=spoken)
    rows = rng.integers(len(CELLS), size=4000)
    for clips, longest in ((silent, 107), (heard, HEARD // 2)):
        offsets = clips.any_offset(rows, 20, rng)
        ends = np.minimum(clips.motion.lengths, longest)[rows]
        assert (offsets >= 0).all()
        assert (offsets <= np.maximum(ends - 20, 0)).all()
        assert offsets[rows == 2].max() == longest - 20
    assert (heard.any_offset(of(0), 40, rng) == 0).all()


@pytest.mark.usefixtures("_corpus")
def test_clips_without_speech_say_so():
    clips = holistic_clips(CELLS, HolisticFeatures(12))
    with pytest.raises(ValueError, match="no speech"):
        clips.heard(of(0), of(0), 4)


@pytest.mark.usefixtures("_corpus")
def test_first_windows_begin_every_clip():
    clips = holistic_clips(CELLS, HolisticFeatures(12))
    assert torch.equal(clips.first(16)[2:3], clips.moving(of(2), of(0), 16))


@pytest.mark.usefixtures("_corpus")
def test_statistics_are_those_of_some_frames_of_some_clips():
    features = fitted_features(CELLS * 7, TEACHING_PQVAE)
    seen = features.from_motion(
        *(
            torch.cat([pad(torch.from_numpy(x[::9]).float()) for x in some])
            for some, pad in (
                (holistic_data.motion_set(CELLS).poses, lambda x: x),
                (holistic_data.face_set(CELLS), lambda x: torch.nn.functional.pad(x, (0, 88))),
            )
        )
    )
    assert seen.mean(0).abs().max() < 0.2
    assert seen.std() == pytest.approx(1, abs=0.5)
