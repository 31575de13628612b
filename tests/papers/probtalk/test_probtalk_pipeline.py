from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from s2glib.audio import Waveform
from s2glib.body import Motion
from s2glib.checkpoint import save_checkpoint
from s2glib.papers.probtalk import PQVAE, Predictor, ProbTalk
from s2glib.papers.probtalk.config import TEACHING_PQVAE, TEACHING_PREDICTOR, TEACHING_REFINER
from s2glib.papers.probtalk.motion_features import JOINTS_OF, PARTS
from s2glib.papers.probtalk.refiner import Refiner
from s2glib.papers.probtalk.speech_features import log_mels

PREDICTOR = replace(
    TEACHING_PREDICTOR,
    audio_width=16,
    context_widths=(8, 8, 16),
    width=32,
    layers=1,
    hidden=32,
    style=8,
)
REFINER = replace(TEACHING_REFINER, width=32, layers=1, hidden=32, head=32, style=8)


@pytest.fixture(scope="module")
def networks():
    """Small, untrained, and never zero."""
    torch.manual_seed(0)
    pqvae = PQVAE(replace(TEACHING_PQVAE, widths=(8, 8, 16, 16)))
    poses, faces = 0.3 * torch.randn(300, 55, 3), torch.rand(300, 100)
    pqvae.features.fit(poses, faces)
    for parameter in pqvae.decoder.parameters():
        torch.nn.init.normal_(parameter, std=0.2)
    refiner = Refiner(REFINER)
    refiner.features.load_state_dict(pqvae.features.state_dict())
    for parameter in refiner.head.parameters():
        torch.nn.init.normal_(parameter, std=0.05)
    predictor = Predictor(PREDICTOR)
    for gate in (p for p in predictor.parameters() if not p.any()):
        torch.nn.init.normal_(gate, std=0.5)
    torch.nn.init.normal_(predictor.join.weight)  # it listens
    for odds in predictor.odds:
        torch.nn.init.normal_(odds.weight, std=0.7)  # it is rather sure of its codes
    return pqvae, predictor, refiner


@pytest.fixture(scope="module", params=[True, False], ids=["refined", "plain"])
def probtalk(request, networks):
    return ProbTalk(*networks) if request.param else ProbTalk(*networks[:2])


def speech(seconds, rate=16000, seed=0):
    """Syllables of noise, two a second or more."""
    samples = np.random.default_rng(seed).normal(0, 0.1, round(seconds * rate))
    loudness = np.sin(np.pi * (2 + seed) * np.arange(len(samples)) / rate) ** 2
    return Waveform((loudness * samples).astype(np.float32), rate)


def some_motion(frames, seed=0):
    generator = torch.Generator().manual_seed(seed)
    poses = 0.3 * torch.randn(frames, 55, 3, generator=generator)
    trans = torch.randn(frames, 3, generator=generator)
    return Motion(poses, trans, torch.rand(frames, 100, generator=generator), 30)


def generated(probtalk, waveform, seed=0, **asked):
    return probtalk.generate(waveform, generator=torch.Generator().manual_seed(seed), **asked)


@pytest.mark.parametrize("seconds", [0.5, 4.73, 176 / 30, 177 / 30, 10.01])
def test_a_motion_is_as_long_as_its_speech(probtalk, seconds):
    motion = generated(probtalk, speech(seconds))
    assert motion.frames == int(30 * seconds)
    assert motion.fps == 30


def test_the_rate_of_the_recording_does_not_matter_to_the_length(probtalk):
    assert generated(probtalk, speech(3.0, rate=22050)).frames == 90


def test_windows_cover_the_speech_and_share_three_tokens(probtalk):
    for frames in range(1, 1000, 37):
        starts = probtalk.window_starts(frames)
        assert starts == [152 * n for n in range(len(starts))]
        assert starts[-1] + 176 >= frames
        assert len(starts) == 1 or starts[-2] + 176 < frames


def test_no_frame_is_left_out_and_none_comes_twice(probtalk):
    poses = generated(probtalk, speech(12.0)).poses
    steps = poses.diff(dim=0).abs().amax((1, 2))
    assert steps.min() > 1e-5
    for lag in (24, 152, 176):
        assert (poses[lag:] - poses[:-lag]).abs().amax((1, 2)).min() > 1e-4


def test_a_window_follows_from_the_end_of_the_one_before(probtalk):
    """Nothing at a seam moves faster than elsewhere."""
    poses = generated(probtalk, speech(20.0)).poses
    steps = poses.diff(dim=0).norm(dim=(1, 2))
    seams = [152 * n + 24 - 1 for n in range(1, 4)]
    assert steps[seams].mean() < 2 * steps.mean()


def test_seed_speaker_and_speech_change_the_motion_and_nothing_else_does(probtalk):
    first = generated(probtalk, speech(2.0)).poses
    assert torch.equal(first, generated(probtalk, speech(2.0)).poses)
    for other in (
        generated(probtalk, speech(2.0), seed=1),
        generated(probtalk, speech(2.0), speaker=5),
        generated(probtalk, speech(2.0, seed=1)),
    ):
        assert (other.poses - first).abs().max() > 1e-3


def test_without_guidance_speech_does_not_choose_the_codes(networks):
    deaf = ProbTalk(*networks[:2])
    first, second = (generated(deaf, speech(2.0, seed=n), guidance=0.0) for n in (0, 1))
    torch.testing.assert_close(first.poses, second.poses)
    strong = generated(deaf, speech(2.0), guidance=4.0)
    assert (strong.poses - generated(deaf, speech(2.0), guidance=1.0).poses).abs().max() > 1e-3


def test_a_beginning_does_not_know_what_comes_after_its_window(probtalk):
    long = speech(9.0)
    short = Waveform(long.samples[: 16000 * 7], 16000)
    first, second = (generated(probtalk, each).poses[:150] for each in (long, short))
    torch.testing.assert_close(first, second, rtol=1e-3, atol=1e-3)


@settings(max_examples=6)
@given(st.integers(0, 10_000), st.sampled_from([0.7, 3.0, 8.0]))
def test_what_is_kept_is_copied_bit_for_bit(probtalk, seed, seconds):
    generator = torch.Generator().manual_seed(seed)
    frames = round(30 * seconds)
    known = some_motion(frames, seed)
    mask = torch.rand(frames, 4, generator=generator).cumsum(0).floor().long() % 3 == 0
    result = generated(probtalk, speech(seconds), known=known, context_mask=mask)
    for column, part in enumerate(PARTS):
        rows, joints = mask[:, column], JOINTS_OF[part]
        assert torch.equal(result.poses[rows][:, joints], known.poses[rows][:, joints])
    assert torch.equal(result.expression[mask[:, 0]], known.expression[mask[:, 0]])
    whole = mask.all(1)
    assert torch.equal(result.poses[whole][:, :22], known.poses[whole][:, :22])
    assert torch.equal(result.trans[whole], known.trans[whole])


def test_a_shorter_motion_is_continued(probtalk):
    known = some_motion(40)
    result = generated(probtalk, speech(3.0), known=known)
    assert torch.equal(result.poses[:40], known.poses)
    assert (result.poses[40:] != known.poses[-1]).any((1, 2)).all()


def test_what_is_kept_has_a_say_in_the_rest(probtalk):
    mask = torch.zeros(60, 4, dtype=torch.bool)
    mask[20:50] = True
    first, second = (
        generated(probtalk, speech(2.0), known=some_motion(60, seed), context_mask=mask).poses[55:]
        for seed in (1, 2)
    )
    assert (first - second).abs().max() > 1e-3


def test_what_is_not_kept_has_no_say(probtalk):
    mask = torch.zeros(60, 4, dtype=torch.bool)
    mask[20:50, 2] = True
    known = some_motion(60)
    poses = torch.where(torch.arange(60)[:, None, None] < 20, 0.5 * known.poses, known.poses)
    other = Motion(poses, known.trans, known.expression, 30)
    first, second = (
        generated(probtalk, speech(2.0), known=each, context_mask=mask) for each in (known, other)
    )
    assert torch.equal(first.poses, second.poses)


def test_a_batch_gives_one_window_a_row(probtalk):
    waveform, nothing = speech(5.0), torch.zeros(150, 4, dtype=torch.bool)
    asked = probtalk.ask(waveform, 150, None, nothing, 3)
    many = type(asked)(*(track.repeat(3, *[1] * (track.ndim - 1)) for track in asked))
    rows = probtalk.sample(many, generator=torch.Generator().manual_seed(0))
    assert rows.shape == (3, 176, 288)
    assert (rows[0] - rows[1]).abs().max() > 1e-3


def test_a_predictor_with_one_mask_for_all_parts_sees_only_whole_frames(networks):
    pqvae = networks[0]
    torch.manual_seed(0)
    probtalk = ProbTalk(pqvae, Predictor(replace(PREDICTOR, context_parts=1)))
    known, mask = some_motion(60), torch.zeros(60, 4, dtype=torch.bool)
    mask[10:40, 2] = True
    alone = generated(probtalk, speech(2.0)).poses
    with_hand = generated(probtalk, speech(2.0), known=known, context_mask=mask).poses
    assert torch.equal(with_hand[:, 1:22], alone[:, 1:22])
    mask[10:40] = True
    whole = generated(probtalk, speech(2.0), known=known, context_mask=mask).poses
    assert (whole[45:, 12:22] - alone[45:, 12:22]).abs().max() > 1e-3


def test_speech_features_of_another_size_are_refused(networks):
    for hear in (lambda _, frames: torch.zeros(frames, 768), log_mels):
        predictor = Predictor(replace(PREDICTOR, speech=64 if hear is not log_mels else 768))
        probtalk = ProbTalk(networks[0], predictor, hear=hear)
        with pytest.raises(ValueError, match=r"load with hear=wav2vec2\(folder\)"):
            generated(probtalk, speech(1.0))


@pytest.mark.parametrize("known", [None, some_motion(40)], ids=["nothing", "something"])
def test_what_is_asked_is_where_the_networks_are(networks, known):
    probtalk = ProbTalk(*(deepcopy(each).to("meta") for each in networks))
    asked = probtalk.ask(speech(2.0), 60, known, torch.ones(60, 4, dtype=torch.bool), 3)
    assert {track.device.type for track in asked} == {"meta"}


@pytest.mark.gpu
def test_networks_on_a_gpu_make_motion_on_the_cpu(networks):
    probtalk = ProbTalk(*(deepcopy(each).to("cuda") for each in networks))
    known = some_motion(40)
    motion = generated(probtalk, speech(3.0), known=known)
    assert motion.poses.device.type == motion.expression.device.type == "cpu"
    assert torch.equal(motion.poses[:40], known.poses)
    assert motion.poses.isfinite().all()


@pytest.mark.parametrize(
    ("asked", "error", "reason"),
    [
        ({"waveform": np.zeros(16000, np.float32)}, TypeError, "as a Waveform"),
        ({"speaker": 24}, ValueError, "0 to 23, got 24"),
        ({"speaker": -1}, ValueError, "0 to 23"),
        ({"speaker": "voice_01"}, TypeError, "a speaker is a number"),
        ({"steps": 0}, ValueError, "1 step or more"),
        ({"context_mask": torch.ones(60, 4).bool()}, ValueError, "known motion"),
    ],
)
def test_doors(probtalk, without_type_hook, asked, error, reason):
    with pytest.raises(error, match=reason):
        generated(probtalk, **{"waveform": speech(2.0), **asked})


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"codes": 64}, "codes differ"),
        ({"motion": 376}, "numbers a frame differ"),
        ({"groups": 8}, "groups differ"),
        ({"speech": 768}, "speech differ"),
        ({"speakers": 4}, "speakers differ"),
        ({"context_parts": 1}, "parts of the mask differ"),
    ],
)
def test_networks_of_different_trainings_are_refused(networks, changed, reason):
    pqvae, _, refiner = networks
    with pytest.raises(ValueError, match=reason):
        ProbTalk(pqvae, Predictor(replace(PREDICTOR, **changed)), refiner)


def test_a_folder_of_checkpoints_makes_the_same_motion(networks, tmp_path):
    for name, model in zip(("pqvae", "predictor", "refiner"), networks, strict=True):
        save_checkpoint(tmp_path / f"probtalk-{name}.safetensors", model, model.config)
    loaded = generated(ProbTalk.load(tmp_path), speech(1.0))
    assert torch.equal(loaded.poses, generated(ProbTalk(*networks), speech(1.0)).poses)


def test_a_missing_checkpoint_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match="probtalk-pqvae"):
        ProbTalk.load(tmp_path)


@pytest.mark.parametrize("wrong", ["predictor", "refiner"])
def test_networks_for_the_codes_of_another_pqvae_are_refused(networks, tmp_path, wrong):
    pqvae, other = networks[0], PQVAE(networks[0].config)
    assert other.fingerprint() != pqvae.fingerprint()

    def keep(made_for):
        for name, model in zip(("pqvae", "predictor", "refiner"), networks, strict=True):
            notes = {"codes": made_for.get(name, pqvae).fingerprint()}
            path = tmp_path / f"probtalk-{name}.safetensors"
            save_checkpoint(path, model, model.config, metadata=notes, half=True)

    keep({wrong: other})
    with pytest.raises(ValueError, match=f"probtalk-{wrong}.* codes of another PQ-VAE"):
        ProbTalk.load(tmp_path)
    keep({})
    assert ProbTalk.load(tmp_path).pqvae.fingerprint() == pqvae.fingerprint()
