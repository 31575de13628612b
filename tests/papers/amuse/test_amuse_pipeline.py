from dataclasses import replace

import numpy as np
import pytest
import torch

from s2glib.audio import Waveform
from s2glib.body import PELVIS_HEIGHT, Motion, joint
from s2glib.checkpoint import save_checkpoint
from s2glib.diffusion import from_noise_prediction, timesteps
from s2glib.papers.amuse import (
    PAPER_DENOISER,
    PAPER_PRIOR,
    PAPER_SPEECH,
    Amuse,
    FaceConfig,
    LatentDenoiser,
    MotionPrior,
    Sampling,
    SpeechCondition,
    SpeechDisentangler,
    SpeechFace,
)
from s2glib.papers.amuse.motion_features import HANDS, UPPER_BODY
from s2glib.papers.amuse.stress_listener import StressConfig, StressListener


def noise(seconds, sample_rate=16000, seed=0):
    rng = np.random.default_rng(seed)
    swell = np.sin(np.linspace(0, 9 * seconds, int(seconds * sample_rate))) ** 2
    return Waveform((0.1 * rng.normal(size=len(swell)) * swell).astype(np.float32), sample_rate)


def chance(seed=0):
    return torch.Generator().manual_seed(seed)


@pytest.fixture
def amuse(speech, prior, denoiser):
    face = SpeechFace(FaceConfig())
    face.mouth_weights.normal_(std=0.1)
    speech.emotion_centres.normal_()
    stress = StressListener(StressConfig())
    return Amuse(speech, prior, denoiser, stress, face, Sampling(steps=4, overlap=10))


@pytest.mark.parametrize("seconds", [0.5, 4.0, 12.0])
def test_any_length_of_speech_gets_as_many_frames(amuse, seconds):
    motion = amuse.generate(noise(seconds), generator=chance())
    assert isinstance(motion, Motion)  # whose numbers are finite
    assert motion.frames == seconds * 30
    assert motion.fps == 30


def test_the_same_noise_gives_the_same_motion_and_other_noise_another(amuse):
    speech = noise(4.0)
    first, again, other = (amuse.generate(speech, generator=chance(s)).poses for s in (0, 0, 1))
    assert torch.equal(first, again)
    assert (first - other).abs().max() > 0.01


def test_a_denoiser_of_noise_is_sampled_too(amuse, awake):
    config = replace(amuse.denoiser.config, prediction="noise")
    amuse.denoiser = awake(LatentDenoiser(config))
    assert amuse.generate(noise(2.0), generator=chance()).frames == 60


def test_the_rate_of_the_recording_does_not_matter_to_the_length(amuse):
    motion = amuse.generate(noise(2.0, sample_rate=22050), generator=chance())
    assert motion.frames == 60


def test_a_body_stands_moves_its_upper_half_and_speaks(amuse):
    motion = amuse.generate(noise(4.0), generator=chance())
    moving = {*UPPER_BODY, *HANDS, joint("jaw")}
    still = [j for j in range(55) if j not in moving]
    assert (motion.poses[:, still] == 0).all()
    assert (motion.trans == torch.tensor([0.0, PELVIS_HEIGHT, 0.0])).all()
    jaw = motion.poses[:, joint("jaw"), 0]
    assert jaw.std() > 0
    assert 0.02 <= jaw.min() <= jaw.max() <= 0.32 + 1e-6
    assert (motion.expression[:, 12:] == 0).all()


def test_long_speech_is_heard_in_windows_that_share_one_style(amuse):
    heard = amuse.hear(noise(12.0))
    windows = len(heard.tracks)
    assert windows == 12  # (360 - 10) / 30 rounded up
    style = heard.latents.style
    assert torch.equal(style, style[:1].expand(windows, -1))
    assert (heard.latents.emotion.std(0) > 0).any()


def test_each_motion_window_hears_its_own_moment(amuse):
    """A loud second in the middle shows in the tracks of the windows that contain it."""
    samples = np.zeros(12 * 16000, np.float32)
    samples[6 * 16000 : 7 * 16000] = 0.1 * np.random.default_rng(0).normal(size=16000)
    energy = amuse.hear(Waveform(samples, 16000)).tracks[..., 0]
    for window, begin in enumerate(range(0, 360, 30)):
        for frame in range(40):
            inside = 6.2 < (begin + frame + 0.5) / 30 < 6.8
            outside = not 5.8 < (begin + frame + 0.5) / 30 < 7.2
            if inside:
                assert energy[window, frame] > energy.min() + 0.1
            if outside:
                assert energy[window, frame] < energy.min() + 0.05


def test_an_edit_by_number_uses_the_classes_mean_latent(amuse):
    source = noise(3.0)
    edited = amuse.edit(source, emotion=2, generator=chance())
    heard = amuse.hear(source).with_emotion(amuse.speech.emotion_centres[2])
    assert torch.equal(edited.poses, amuse.gesture(heard, generator=chance()).poses)


def test_an_edit_by_donors_takes_their_mean_latents(amuse):
    source, donor = noise(3.0), noise(2.0, seed=5)
    edited = amuse.edit(source, emotion=donor, style=donor, generator=chance())
    latents = amuse.hear(donor).latents
    heard = amuse.hear(source).with_emotion(latents.emotion.mean(0))
    heard = heard.with_style(latents.style.mean(0))
    assert torch.equal(edited.poses, amuse.gesture(heard, generator=chance()).poses)
    plain = amuse.generate(source, generator=chance())
    assert edited.frames == plain.frames
    assert not torch.equal(edited.poses, plain.poses)


def test_an_edit_of_nothing_is_refused(amuse):
    with pytest.raises(ValueError, match="neither"):
        amuse.edit(noise(1.0), generator=chance())


@pytest.mark.parametrize("number", [-1, 8])
def test_an_emotion_that_does_not_exist_is_refused(amuse, number):
    with pytest.raises(ValueError, match=f"0 to 7, got {number}"):
        amuse.edit(noise(1.0), emotion=number, generator=chance())


def test_a_folder_of_checkpoints_is_the_whole_system(amuse, tmp_path):
    parts = {
        "disentangler": amuse.speech,
        "prior": amuse.prior,
        "denoiser": amuse.denoiser,
        "stress": amuse.stress,
        "face": amuse.face,
    }
    for name, model in parts.items():
        save_checkpoint(tmp_path / f"amuse-{name}.safetensors", model, model.config)
    loaded = Amuse.load(tmp_path, amuse.sampling)
    speech = noise(1.0)
    first, second = (system.generate(speech, generator=chance()) for system in (amuse, loaded))
    assert torch.equal(first.poses, second.poses)
    assert torch.equal(first.expression, second.expression)


def test_a_folder_without_one_of_them_is_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match="amuse-disentangler"):
        Amuse.load(tmp_path)


@pytest.mark.parametrize("emotion", ["anger", 2.7, [2]])
def test_an_emotion_that_is_no_number_is_refused_with_a_way_out(amuse, without_type_hook, emotion):
    with pytest.raises(TypeError, match=r"number from 0 to 7.*EMOTIONS\.index"):
        amuse.edit(noise(1.0), emotion=emotion, generator=chance())


def test_bare_samples_are_refused_with_a_way_out(amuse, without_type_hook):
    with pytest.raises(TypeError, match=r"Waveform, got ndarray.*audio\.load"):
        amuse.generate(noise(1.0).samples, generator=chance())


@pytest.fixture
def paper():
    """The paper's preset, narrow and shallow: 300 frames, 333 numbers, one token, noise."""
    thin = {"layers": 3, "heads": 2, "hidden": 16}
    speech = replace(
        PAPER_SPEECH, n_mels=16, width=8, layers=1, heads=2, decoder_width=8,
    )  # fmt: skip
    return Amuse(
        SpeechDisentangler(speech),
        MotionPrior(replace(PAPER_PRIOR, token_dim=16, **thin)),
        LatentDenoiser(replace(PAPER_DENOISER, token_dim=16, width=16, **thin)),
        StressListener(StressConfig(n_mels=16)),
        SpeechFace(FaceConfig(n_mels=16)),
        Sampling(steps=3),
    )


@pytest.mark.parametrize(("seconds", "windows"), [(2.0, 1), (10.0, 1), (12.0, 2)])
def test_the_papers_preset_gestures_with_its_whole_body(paper, seconds, windows):
    heard = paper.hear(noise(seconds))
    assert len(heard.latents.content) == windows
    motion = paper.gesture(heard, generator=chance())  # whose numbers are finite
    assert motion.frames == seconds * 30
    assert (motion.poses.std(0) > 0).sum() > 150  # of 165; the jaw speaks with one axis
    assert (motion.trans.std(0) > 0).all()


def test_the_papers_single_token_has_no_joins_to_mend(paper):
    heard = paper.hear(noise(2.0))
    nothing = torch.zeros(1, 3, dtype=torch.bool)
    condition = SpeechCondition(heard.latents, heard.tracks, nothing)
    paper.sampling = replace(paper.sampling, steps=1, guidance=1.0, spread=1.0)
    (window,) = paper.sample_windows(condition, generator=chance())
    noisy = torch.randn(1, 1, 16, generator=chance())
    level = timesteps(1000, 1, "linspace")[0]
    denoise = from_noise_prediction(paper.denoiser, paper.schedule)
    with torch.no_grad():
        expected = paper.prior.decode(denoise(noisy, level, condition))
    torch.testing.assert_close(window[None], expected)


def test_the_papers_denoiser_hears_content_emotion_and_style_alone(paper):
    heard = paper.hear(noise(2.0))
    silent = replace(heard, tracks=torch.zeros_like(heard.tracks))
    first, second = (paper.gesture(h, generator=chance()).poses for h in (heard, silent))
    assert torch.equal(first, second)


@pytest.mark.parametrize("at_once", [1, 5, 11])
def test_how_many_windows_a_network_sees_together_changes_nothing(amuse, monkeypatch, at_once):
    speech = noise(12.0)  # 12 windows
    whole = amuse.generate(speech, generator=chance())
    for module in ("pipeline", "stitching"):
        monkeypatch.setattr(f"s2glib.papers.amuse.{module}.AT_ONCE", at_once)
    pieces = amuse.generate(speech, generator=chance())
    torch.testing.assert_close(pieces.poses, whole.poses, atol=1e-3, rtol=0)
    torch.testing.assert_close(pieces.expression, whole.expression, atol=1e-5, rtol=0)
