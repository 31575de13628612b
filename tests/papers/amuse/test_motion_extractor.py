import pytest
import torch
from torch.nn import functional as F

from s2glib.checkpoint import load_checkpoint, save_checkpoint
from s2glib.papers.amuse import PAPER_EXTRACTOR, MotionExtractor, PositionJudge


@pytest.fixture
def motion():
    return torch.randn(3, 40, 90)


@pytest.fixture
def extractor(extractor_config, awake):
    return awake(MotionExtractor(extractor_config))


@pytest.fixture
def judge(extractor_config, awake):
    return awake(PositionJudge(extractor_config))


def test_the_paper_extractor_names_eight_emotions_from_ten_seconds():
    with torch.device("meta"):
        extractor = MotionExtractor(PAPER_EXTRACTOR)
        judgement = extractor(torch.zeros(2, 300, 333))
        emotion, reconstruction = extractor.losses(
            torch.zeros(2, 300, 333), torch.zeros(2, dtype=torch.long)
        )
    assert judgement.logits.shape == (2, 8)
    assert judgement.features.shape == (2, 256)
    assert emotion.shape == reconstruction.shape == ()


def test_the_class_is_read_off_the_features(extractor, motion):
    judgement = extractor(motion)
    torch.testing.assert_close(judgement.logits, extractor.classify(judgement.features))


def test_the_losses_are_cross_entropy_and_the_auto_encoders_error(extractor, motion):
    labels = torch.tensor([0, 4, 7])
    emotion, reconstruction = extractor.losses(motion, labels)
    torch.testing.assert_close(emotion, F.cross_entropy(extractor(motion).logits, labels))
    tokens = extractor._tokens(motion)[:, 1:]
    drawn = [extractor.reconstruct(tokens[:, n]).reshape(3, 4, 90) for n in range(10)]
    torch.testing.assert_close(reconstruction, F.mse_loss(torch.cat(drawn, dim=1), motion))


def test_the_extractor_hears_the_order_of_frames(extractor, motion):
    assert (extractor(motion).features - extractor(motion.flip(1)).features).abs().max() > 1e-3


def test_the_second_judge_sees_where_joints_are_and_not_the_fingers(judge, motion):
    fingers = motion.clone()
    fingers[..., 78:] += torch.randn(3, 40, 12)
    assert torch.equal(judge(fingers).logits, judge(motion).logits)
    arms = motion.clone()
    arms[..., :78] += torch.randn(3, 40, 78)
    assert (judge(arms).logits - judge(motion).logits).abs().max() > 1e-3


@pytest.mark.parametrize("judge_class", [MotionExtractor, PositionJudge])
def test_a_checkpoint_brings_back_the_same_judgement(
    judge_class, extractor_config, awake, motion, tmp_path
):
    judge = awake(judge_class(extractor_config))
    judge.features.fit(torch.randn(30, 55, 3))
    save_checkpoint(tmp_path / "judge.safetensors", judge, judge.config)
    loaded = load_checkpoint(tmp_path / "judge.safetensors", judge_class)
    assert torch.equal(loaded(motion).features, judge(motion).features)
