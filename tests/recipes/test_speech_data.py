import numpy as np
import pytest
import torch

from s2glib.corpus import EMOTIONS, SPEAKERS, Cell
from s2glib.recipes import FactorTable

SENTENCE, SPEAKER, EMOTION, TAKE = range(4)


def table_of(sentences=4, speakers=5, emotions=8, takes=2, holes=()):
    """Every clip's window holds the clip's own row number."""
    cells = [
        Cell(c, SPEAKERS[s], EMOTIONS[e], t)
        for c in range(sentences)
        for s in range(speakers)
        for e in range(emotions)
        for t in range(takes)
    ]
    cells = [cell for row, cell in enumerate(cells) if row not in holes]
    windows = torch.arange(len(cells)).float()[:, None, None].expand(-1, 2, 3).half()
    return FactorTable(cells, windows)


def factors(table, windows):
    return table.factors[windows[:, 0, 0].long().numpy()]


@pytest.fixture
def table():
    return table_of(holes=range(0, 320, 9))


def test_donors_share_exactly_the_factor_they_are_asked_for(table, rng):
    batch = table.factor_batch(400, rng)
    target = factors(table, batch.target)
    content, emotion, style = (factors(table, donor) for donor in batch.donors)
    assert (content[:, [SENTENCE, TAKE]] == target[:, [SENTENCE, TAKE]]).all()
    assert (emotion[:, EMOTION] == target[:, EMOTION]).all()
    assert (style[:, SPEAKER] == target[:, SPEAKER]).all()
    for donor, shared in ((content, SENTENCE), (emotion, EMOTION), (style, SPEAKER)):
        for axis in {SENTENCE, SPEAKER, EMOTION} - {shared}:
            assert 0 < (donor[:, axis] == target[:, axis]).mean() < 0.8  # free, not forbidden


def test_half_of_the_content_donors_speak_in_the_targets_emotion(table, rng):
    batch = table.factor_batch(2000, rng, same_emotion=0.5)
    same = (
        factors(table, batch.donors.content)[:, EMOTION] == factors(table, batch.target)[:, EMOTION]
    )
    assert same.mean() == pytest.approx(0.5 + 0.5 / 8, abs=0.05)


def test_labels_are_the_targets(table, rng):
    batch = table.factor_batch(50, rng)
    target = factors(table, batch.target)
    assert np.array_equal(batch.emotion, target[:, EMOTION])
    assert np.array_equal(batch.style, target[:, SPEAKER])
    assert batch.target.dtype == torch.float32


def test_a_quadruple_is_two_sentences_by_two_speakers_in_one_emotion_and_take(table, rng):
    batch = table.quadruple_batch(30, rng)
    a1, a2, a3, a4 = (factors(table, clips) for clips in batch.clips)
    assert (a1[:, SENTENCE] == a3[:, SENTENCE]).all()
    assert (a2[:, SENTENCE] == a4[:, SENTENCE]).all()
    assert (a1[:, SENTENCE] != a2[:, SENTENCE]).all()
    assert (a1[:, SPEAKER] == a2[:, SPEAKER]).all()
    assert (a3[:, SPEAKER] == a4[:, SPEAKER]).all()
    assert (a1[:, SPEAKER] != a3[:, SPEAKER]).all()
    for clip, style in zip((a1, a2, a3, a4), batch.style, strict=True):
        assert (clip[:, [EMOTION, TAKE]] == a1[:, [EMOTION, TAKE]]).all()
        assert np.array_equal(style, clip[:, SPEAKER])
    assert np.array_equal(batch.emotion, a1[:, EMOTION])


def test_chance_comes_from_the_generator(table):
    first, again, other = (
        table.factor_batch(20, np.random.default_rng(seed)).target for seed in (1, 1, 2)
    )
    assert torch.equal(first, again)
    assert not torch.equal(first, other)


def test_a_table_without_quadruples_says_so(rng):
    apart = [row for row in range(64) if row // 32 != row // 16 % 2]  # each speaks one sentence
    table = table_of(sentences=2, speakers=2, holes=apart)
    with pytest.raises(ValueError, match="does not hold 2 quadruples"):
        table.quadruple_batch(2, rng)


def test_a_table_of_holes_says_so(rng):
    table = table_of(holes=range(1, 320))
    table.speakers = np.array([3])  # whom no clip has
    with pytest.raises(ValueError, match="too many holes"):
        table.factor_batch(2, rng)
