"""A corpus whose windows show their factors, and models that read and paint them."""

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import torch
from torch import nn

from s2glib.corpus.build import Request, SpeechSet
from s2glib.corpus.script import EMOTIONS, SPEAKERS, Cell
from s2glib.papers.amuse.config import TEACHING_SPEECH
from s2glib.papers.amuse.disentangler import SpeechDisentangler, SpeechLatents
from s2glib.papers.amuse.speech_judge import SpeechJudge, SpeechOpinion
from s2glib.recipes import evaluate_amuse_speech as tables
from s2glib.recipes.evaluate_amuse_speech import disentangler_rows, evaluate_amuse_speech
from s2glib.recipes.evaluate_speech_edits import edit_rows, judge_rows
from s2glib.recipes.speech_clips import decoded_errors, encode_clips
from s2glib.recipes.targets import AMUSE_SPEECH

CONFIG = replace(TEACHING_SPEECH, frames=8, mean=0.0, std=0.5)
SENTENCE, VOICE, EMOTION = slice(0, 16), slice(16, 46), slice(46, 54)
CONSTANT_ERROR = 0.01


def cells(sentences=(1, 3), voices=("voice_01", "voice_05"), take=2):
    return [Cell(*factors, take) for factors in product(sentences, voices, EMOTIONS)]


def show(cell: Cell) -> np.ndarray:
    """Five frames that show the factors, three of padding that no two clips share."""
    window = np.zeros((8, 64), np.float16)
    window[:, cell.sentence] = 1
    window[:, VOICE.start + SPEAKERS.index(cell.speaker)] = 1
    window[:, EMOTION.start + EMOTIONS.index(cell.emotion)] = 1
    window[5:] = np.random.default_rng(list(cell.id.encode())).normal(size=(3, 64))
    return window


class Painter(nn.Module):
    """Paints what the latents say, but for one that it does not look at."""

    def __init__(self, ignored: str):
        super().__init__()
        self.ignored = ignored

    def forward(self, content, emotion, style):
        latents = SpeechLatents(content, emotion, style)
        if self.ignored:
            latents = latents._replace(**{self.ignored: 0 * getattr(latents, self.ignored)})
        row = torch.cat([latents.content, latents.style, latents.emotion], dim=1)
        return nn.functional.pad(row, (0, 10))[:, None].repeat(1, 8, 1) + CONSTANT_ERROR


class Perfect(SpeechDisentangler):
    def __init__(self, ignored=""):
        nn.Module.__init__(self)
        self.config, self.decoder = CONFIG, Painter(ignored)
        self.emotion_head, self.style_head = nn.Identity(), nn.Identity()
        self.register_buffer("emotion_centres", torch.eye(8))

    def encode(self, filterbank):
        first = filterbank[:, 0]
        return SpeechLatents(first[:, SENTENCE], first[:, EMOTION], first[:, VOICE])


class Ear(SpeechJudge):
    def __init__(self):
        nn.Module.__init__(self)

    def forward(self, filterbank):
        return SpeechOpinion(filterbank[:, 0, EMOTION], filterbank[:, 0, VOICE])


@pytest.fixture(autouse=True)
def asked(monkeypatch):
    """The requests that were made of the corpus."""
    requests = []

    def speech_set(wanted, window):
        requests.extend(wanted)
        windows = np.stack([show(request.cell) for request in wanted])
        return SpeechSet(windows, np.full(len(wanted), 0.1))

    monkeypatch.setattr("s2glib.recipes.speech_clips.speech_set", speech_set)
    return requests


def figures(rows):
    return {row.name: row.value for row in rows}


def measured(model):
    test, train = encode_clips(model, cells()), encode_clips(model, cells(take=0))
    return figures(disentangler_rows(model, test, train, quadruples=8))


def test_a_perfect_model_gets_every_figure_right():
    got = measured(Perfect())
    assert got["EA"] == got["SA"] == got["EA, macro F1"] == 1
    assert got["self error"] == pytest.approx(CONSTANT_ERROR, rel=1e-4)
    for factor in ("content", "emotion", "style"):
        assert got[f"cross {factor} / self"] == pytest.approx(1)
        wrong = (62 * 0.01 + 0.99 + 1.01) / 64  # one entry lacks, one is too many
        assert got[f"reliance on {factor}"] == pytest.approx(wrong / 0.01, rel=1e-3)


def test_linear_probes_find_each_factor_in_its_own_latent_and_only_there():
    got = measured(Perfect())
    assert got["sentence in c"] == got["emotion in e"] == got["voice in s"] == 1
    assert got["emotion in c"] == got["emotion in s"] == 1 / 8
    assert got["voice in c"] == got["sentence in e"] == got["sentence in s"] == 1 / 2


@pytest.mark.parametrize("ignored", SpeechLatents._fields)
def test_reliance_on_a_latent_that_the_decoder_ignores_is_exactly_one(ignored):
    got = measured(Perfect(ignored))
    assert got[f"reliance on {ignored}"] == 1
    assert sum(got[f"reliance on {name}"] > 1.01 for name in SpeechLatents._fields) == 2


def test_padding_does_not_count(rng):
    heard = encode_clips(Perfect(), cells())
    windows = heard.clips.windows.clone()
    windows[:, 5:] = torch.from_numpy(rng.normal(size=(32, 3, 64)))
    repadded = heard.clips._replace(windows=windows)
    errors = [decoded_errors(Perfect(), heard.latents, c) for c in (heard.clips, repadded)]
    assert np.array_equal(*errors)


def test_edits_of_a_perfect_model_are_recognised_and_meet_their_targets():
    got = figures(edit_rows(Perfect(), Ear(), encode_clips(Perfect(), cells())))
    right = ("unedited recognised", "emotion edit recognised", "style edit recognised")
    kept = ("emotion edit, voice kept", "style edit, emotion kept")
    assert all(got[name] == 1 for name in (*right, *kept))
    assert got["emotion edit by class mean, recognised"] == 1
    assert got["emotion edit, old emotion recognised"] == 0
    assert got["edit / target on the source's clock"] == pytest.approx(1)


def test_an_edit_that_the_decoder_ignores_is_not_recognised():
    model = Perfect("emotion")
    rows = edit_rows(model, Ear(), encode_clips(model, cells()))
    assert figures(rows)["emotion edit recognised"] < 0.4


def test_a_decoder_without_style_edits_emotion_but_loses_the_voice():
    model = Perfect("style")
    got = figures(edit_rows(model, Ear(), encode_clips(model, cells())))
    assert got["emotion edit recognised"] == 1
    assert got["emotion edit, voice kept"] == got["style edit recognised"] == 0.5


def test_the_target_of_an_edit_is_asked_for_on_both_clocks(asked):
    edit_rows(Perfect(), Ear(), encode_clips(Perfect(), cells()))
    retimed = [request for request in asked if request.clock_of is not None]
    assert [request.clock_of for request in retimed] == [cell.emotion for cell in cells()]
    assert all(request.cell.emotion != request.clock_of for request in retimed)
    assert {Request(request.cell) for request in retimed} <= set(asked)


def test_a_judge_that_cannot_bear_blurred_speech_is_found_out():
    got = figures(judge_rows(Ear(), encode_clips(Perfect(), cells()).clips))
    assert got["judge right, emotion"] == got["judge right, voice"] == 1
    assert got["judge right, emotion, blurred"] < 0.95


def test_the_whole_table_has_a_row_for_every_target(monkeypatch):
    splits = {
        **{"test": cells(), "train": cells(take=0)},
        **{"unseen-sentences": cells((7, 12)), "unseen-speakers": cells(voices=("voice_25",))},
    }
    models = {SpeechDisentangler: Perfect(), SpeechJudge: Ear()}
    monkeypatch.setattr(tables, "split", splits.get)
    monkeypatch.setattr(tables, "load_checkpoint", lambda path, kind: models[kind])
    monkeypatch.setattr(tables, "PROBE_CLIPS", 32)
    rows = evaluate_amuse_speech(Path("somewhere"))
    names = [row.name for row in rows]
    assert set(AMUSE_SPEECH) <= set(names)
    assert len(names) == len(set(names))
    assert "SA, unseen voices" not in names
    leaks_and_blur = {row.name for row in rows if row.met is False}
    assert leaks_and_blur == {
        *("judge right, emotion, blurred", "judge right, voice, blurred"),
        *("sentence in e", "voice in e", "sentence in s"),  # chance is 1/2 among so few clips
    }
