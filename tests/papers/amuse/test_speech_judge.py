import torch

from s2glib.checkpoint import load_checkpoint, save_checkpoint
from s2glib.papers.amuse import SpeechJudge


def test_the_judge_scores_emotion_and_speaker(speech_config, awake):
    judge = awake(SpeechJudge(speech_config))
    opinion = judge(torch.randn(2, 352, 64))
    assert opinion.emotion.shape == (2, 8)
    assert opinion.style.shape == (2, 5)
    assert (opinion.emotion[0] - opinion.emotion[1]).abs().max() > 1e-3


def test_a_checkpoint_brings_back_the_judge(speech_config, awake, tmp_path):
    judge = awake(SpeechJudge(speech_config))
    save_checkpoint(tmp_path / "judge.safetensors", judge, judge.config)
    clips = torch.randn(1, 352, 64)
    loaded = load_checkpoint(tmp_path / "judge.safetensors", SpeechJudge)
    assert torch.equal(loaded(clips).emotion, judge(clips).emotion)
