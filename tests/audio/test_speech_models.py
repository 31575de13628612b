import json
import sys

import numpy as np
import pytest
import torch
import transformers

from s2glib.audio import load_speech_model, resample, wav2vec2_features, wavlm_features

TINY = {
    "hidden_size": 16,
    "num_hidden_layers": 2,
    "num_attention_heads": 2,
    "intermediate_size": 16,
    "conv_dim": (8,) * 7,
    "num_conv_pos_embeddings": 8,
    "num_conv_pos_embedding_groups": 2,
}


@pytest.fixture(scope="module")
def wav2vec2_folder(tmp_path_factory):
    """Like wav2vec2-base-960h: a recogniser, whose output head is not wanted."""
    folder = tmp_path_factory.mktemp("wav2vec2")
    torch.manual_seed(0)
    transformers.Wav2Vec2ForCTC(transformers.Wav2Vec2Config(**TINY)).save_pretrained(folder)
    return folder


@pytest.fixture(scope="module")
def wavlm_folder(tmp_path_factory):
    """Like wavlm-large: layer norms in the convolutions and before attention."""
    folder = tmp_path_factory.mktemp("wavlm")
    torch.manual_seed(0)
    config = transformers.WavLMConfig(
        **TINY, feat_extract_norm="layer", do_stable_layer_norm=True, num_buckets=8
    )
    transformers.WavLMModel(config).save_pretrained(folder)
    return folder


def interpolated(hidden, frames):
    """Torch's own resizing as the oracle."""
    resized = torch.nn.functional.interpolate(
        hidden.mT, size=frames, mode="linear", align_corners=True
    )
    return resized[0].mT.numpy()


def test_wav2vec2_features_are_transformers_last_layer_at_30_fps(wav2vec2_folder, vowel):
    reference = transformers.Wav2Vec2ForCTC.from_pretrained(wav2vec2_folder).wav2vec2.eval()
    inputs = transformers.Wav2Vec2FeatureExtractor()(
        vowel, sampling_rate=16000, return_tensors="pt"
    )
    with torch.no_grad():
        hidden = reference(inputs.input_values).last_hidden_state
    ours = wav2vec2_features(load_speech_model(wav2vec2_folder), vowel)
    assert ours.shape == (int(len(vowel) / 16000 * 30), 16)
    np.testing.assert_allclose(ours, interpolated(hidden, 96), atol=1e-3)


def test_wavlm_features_go_from_159_to_160_to_80_frames(wavlm_folder, vowel):
    reference = transformers.WavLMModel.from_pretrained(wavlm_folder).eval()
    sound = torch.from_numpy(vowel)[None]
    with torch.no_grad():
        hidden = reference(torch.nn.functional.layer_norm(sound, sound.shape)).last_hidden_state
    assert hidden.shape == (1, 159, 16)
    doubled = torch.cat([hidden, hidden[:, -1:]], dim=1)
    ours = wavlm_features(load_speech_model(wavlm_folder), vowel)
    np.testing.assert_allclose(ours, interpolated(doubled, 80), atol=1e-3)


def test_features_do_not_depend_on_the_level_or_much_on_the_sample_rate(wavlm_folder, vowel):
    model = load_speech_model(wavlm_folder)
    features = wavlm_features(model, vowel)
    np.testing.assert_allclose(wavlm_features(model, 2 * vowel), features, atol=0.02)
    at_32_khz = wavlm_features(model, resample(vowel, 16000, 32000), 32000)
    assert np.abs(at_32_khz - features).mean() < 0.1 * features.std()


@pytest.mark.parametrize("door", [wav2vec2_features, wavlm_features])
@pytest.mark.parametrize("bad", [np.zeros(0), np.zeros(399), np.full(800, np.nan)])
def test_too_little_and_not_a_number_are_refused(wavlm_folder, door, bad):
    with pytest.raises(ValueError, match="samples"):
        door(load_speech_model(wavlm_folder), bad)


def test_a_folder_without_a_model_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"no readable config\.json"):
        load_speech_model(tmp_path / "nowhere")
    (tmp_path / "config.json").write_text("[]")
    with pytest.raises(ValueError, match=r"no readable config\.json"):
        load_speech_model(tmp_path)


def test_another_kind_of_model_is_named(tmp_path):
    (tmp_path / "config.json").write_text(json.dumps({"model_type": "bert"}))
    with pytest.raises(ValueError, match=r"wav2vec2 or wavlm .* got bert"):
        load_speech_model(tmp_path)


def test_a_truncated_weight_file_is_refused(wavlm_folder, tmp_path):
    (tmp_path / "config.json").write_text((wavlm_folder / "config.json").read_text())
    with pytest.raises(ValueError, match="cannot be read"):
        load_speech_model(tmp_path)
    weights = (wavlm_folder / "model.safetensors").read_bytes()
    (tmp_path / "model.safetensors").write_bytes(weights[:5000])
    with pytest.raises(ValueError, match="cannot be read"):
        load_speech_model(tmp_path)


def test_without_transformers_the_extra_is_named(wavlm_folder, monkeypatch):
    monkeypatch.setitem(sys.modules, "transformers", None)
    with pytest.raises(ImportError, match="pretrained"):
        load_speech_model(wavlm_folder)
