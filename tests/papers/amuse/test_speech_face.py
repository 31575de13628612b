import numpy as np
import pytest
import torch

from s2glib.checkpoint import load_checkpoint, save_checkpoint
from s2glib.papers.amuse import FaceConfig, SpeechFace
from s2glib.papers.amuse.speech_face import MOUTH

CONFIG = FaceConfig(n_mels=6, context=1)


@pytest.fixture
def face():
    face = SpeechFace(CONFIG)
    face.emotion_faces.uniform_(0, 0.5)
    return face


@pytest.fixture
def heard():
    return torch.randn(4, 50, 6)


def neighbourhoods(filterbank):
    """Each frame with its neighbours, mel by mel, and a one; the ends are held."""
    rows = []
    for clip in filterbank.double().numpy():
        for t in range(len(clip)):
            around = [clip[min(max(t + d, 0), len(clip) - 1)] for d in (-1, 0, 1)]
            rows.append(np.append(np.stack(around, axis=1).flatten(), 1.0))
    return np.array(rows)


def test_the_mouth_is_the_closed_form_ridge_regression(face, heard):
    mouth = torch.rand(4, 50, 4)
    face.fit_mouth(heard, mouth, ridge=2.0)
    X = neighbourhoods(heard)
    # ridge regression is least squares on rows that pull every weight towards zero
    X_ridge = np.concatenate([X, np.sqrt(2.0) * np.eye(X.shape[1])])
    Y = np.concatenate([mouth.flatten(0, 1).double().numpy(), np.zeros((X.shape[1], 4))])
    weights, *_ = np.linalg.lstsq(X_ridge, Y)
    assert face.mouth_weights.numpy() == pytest.approx(weights, abs=1e-5)
    expected = (X @ weights).clip(0, 1).reshape(4, 50, 4)
    assert face.mouth(heard).numpy() == pytest.approx(expected, abs=1e-5)


def test_a_mouth_that_follows_the_sound_is_learned(face, heard):
    mouth = (0.5 + 0.1 * heard[..., :4]).clamp(0, 1)
    face.fit_mouth(heard, mouth, ridge=1e-6)
    assert (face.mouth(heard) - mouth).abs().mean() < 0.01


def test_jaw_and_curves_stay_in_range(face, heard):
    face.mouth_weights.normal_()
    jaw, curves = face(heard[0], torch.full((8,), 1 / 8))
    assert 0.02 <= jaw.min() <= jaw.max() <= 0.02 + CONFIG.widest_jaw + 1e-6
    assert curves.shape == (50, 12)
    assert 0 <= curves.min() <= curves.max() <= 1


def test_the_emotion_chooses_the_rest_of_the_face(face, heard):
    probabilities = torch.eye(8)[3]
    _, curves = face(heard[0], probabilities)  # an untrained mouth is shut
    torch.testing.assert_close(curves, face.emotion_faces[3].expand(50, -1))


def test_lips_move_the_last_three_curves(face, heard):
    face.emotion_faces.zero_()
    face.mouth_weights[-1] = torch.tensor([0.1, 0.2, 0.3, 0.4])  # the constant
    _, curves = face(heard[0], torch.eye(8)[0])
    assert (curves[:, :-3] == 0).all()
    torch.testing.assert_close(curves[0, -3:], 0.8 * torch.tensor([0.2, 0.3, 0.4]))
    assert MOUTH == ("jaw", "lip_round", "lip_wide", "lip_press")


def test_a_checkpoint_brings_back_the_face(face, tmp_path):
    save_checkpoint(tmp_path / "face.safetensors", face, face.config)
    loaded = load_checkpoint(tmp_path / "face.safetensors", SpeechFace)
    assert torch.equal(loaded.emotion_faces, face.emotion_faces)


def test_a_long_filterbank_is_mapped_block_by_block(face, heard, monkeypatch):
    face.mouth_weights.normal_()
    whole = face.mouth(heard)
    monkeypatch.setattr("s2glib.papers.amuse.speech_face.BLOCK", 7)
    torch.testing.assert_close(face.mouth(heard), whole)
