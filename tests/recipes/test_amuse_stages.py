"""The three stages of AMUSE on small networks and made-up data: what a step draws and learns."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from s2glib.body import axis_angle_to_matrix, matrix_to_sixd
from s2glib.corpus import EMOTIONS, SPEAKERS, Cell
from s2glib.papers.amuse import (
    TEACHING_DENOISER,
    TEACHING_EXTRACTOR,
    TEACHING_PRIOR,
    TEACHING_SPEECH,
    LatentDenoiser,
    MotionExtractor,
    MotionPrior,
    PositionJudge,
    SpeechDisentangler,
    SpeechJudge,
    SpeechLatents,
    UpperBodyFeatures,
)
from s2glib.recipes import (
    Chance,
    Course,
    FactorTable,
    MotionWindows,
    SpeechOfClips,
    Training,
    amuse_disentangler,
    amuse_extractor,
    amuse_gestures,
    amuse_prior,
)

SPEECH = replace(
    TEACHING_SPEECH, content_dim=64, emotion_dim=6, style_dim=7, width=16, layers=1, heads=2,
    decoder_width=16, content_tokens=8,
)  # fmt: skip
PRIOR = replace(TEACHING_PRIOR, frames=40, tokens=5, token_dim=6, width=16)
DENOISER = replace(
    TEACHING_DENOISER, tokens=5, token_dim=6, content_dim=64, emotion_dim=6, style_dim=7,
    frames_per_token=10, width=16, layers=3, heads=2, hidden=32,
)  # fmt: skip
EXTRACTOR = replace(TEACHING_EXTRACTOR, frames=40, width=16, layers=1, hidden=32)
COURSE = Course(steps=3, batch=6, learning_rate=1e-3, warm_up=1)
CELLS = [Cell(c, s, e, t) for c in (0, 1) for s in SPEAKERS[:2] for e in EMOTIONS for t in (0, 1)]


@pytest.fixture(autouse=True)
def seed():
    torch.manual_seed(0)


@pytest.fixture
def table():
    return FactorTable(CELLS, torch.randn(len(CELLS), 352, 64).half())


@pytest.fixture
def windows(rng):
    poses = [rng.normal(0, 0.3, (n, 55, 3)).astype(np.float16) for n in rng.integers(30, 90, 64)]
    return MotionWindows(CELLS, poses, UpperBodyFeatures(), frames=40)


@pytest.fixture
def gesture_data(windows):
    latents = SpeechLatents(torch.randn(64, 64), torch.randn(64, 6), torch.randn(64, 7))
    speech = SpeechOfClips(latents, torch.randn(64, 352, 3))
    prior = MotionPrior(PRIOR).eval()
    rows = np.arange(64)[::-1].copy()
    return amuse_gestures.GestureData(windows, rows, np.roll(rows, 1), speech, prior, SPEECH)


def test_an_edit_has_the_emotion_of_its_own_clip_and_the_words_of_the_one_it_follows(gesture_data):
    latents = gesture_data.speech.latents
    heard = gesture_data.heard(np.array([5, 0])).latents
    assert torch.equal(heard.content, latents.content[[58, 63]])
    assert torch.equal(heard.style, latents.style[[58, 63]])
    assert torch.equal(heard.emotion, latents.emotion[[59, 0]])


def chance(progress=0.0, seed=0):
    return Chance(np.random.default_rng(seed), torch.Generator().manual_seed(seed), progress)


def learns(objective, draw):
    """Three steps with finite losses, after which every weight that was trained has moved."""
    before = {name: p.clone() for name, p in objective.named_parameters() if p.requires_grad}
    training = Training(objective, COURSE)
    losses = [log.loss for log in training.run(draw)]
    assert np.isfinite(losses).all()
    now = dict(objective.named_parameters())
    return [name for name, value in before.items() if torch.equal(now[name], value)]


def test_the_full_factor_swap_trains_every_part(table):
    model = SpeechDisentangler(SPEECH)
    objective = amuse_disentangler.FactorSwapObjective(model)
    still = learns(
        objective, lambda c: amuse_disentangler.draw_factor_swap(table, model, COURSE, c)
    )
    assert still == []


def test_the_papers_quadruples_train_every_part(table):
    objective = amuse_disentangler.QuadrupleObjective(SpeechDisentangler(SPEECH))
    assert learns(objective, lambda c: table.quadruple_batch(2, c.rng)) == []


def test_the_weight_of_the_content_loss_can_be_set(table, rng):
    model = SpeechDisentangler(SPEECH).eval()
    batch = table.quadruple_batch(2, rng)
    with_it, without = (
        amuse_disentangler.QuadrupleObjective(model, content_weight=w)(batch) for w in (1.0, 0.0)
    )
    torch.testing.assert_close(with_it[0] - without[0], with_it[1]["content"] / 2)


def test_targets_stay_clean_and_donors_do_not(table):
    model = SpeechDisentangler(SPEECH)
    step = amuse_disentangler.draw_factor_swap(table, model, COURSE, chance())
    clean = table.factor_batch(COURSE.batch, np.random.default_rng(0))
    assert torch.equal(step.batch.target, clean.target)
    for heard, said in zip(step.batch.donors, clean.donors, strict=True):
        assert heard.shape == said.shape
        assert not torch.equal(heard, said)


@pytest.mark.parametrize(("progress", "cycle"), [(0.0, False), (0.64, False), (0.65, True)])
def test_the_cycle_joins_late(table, progress, cycle):
    model = SpeechDisentangler(SPEECH)
    step = amuse_disentangler.draw_factor_swap(table, model, COURSE, chance(progress))
    assert step.cycle is cycle


def test_latents_of_a_whole_table_come_in_its_order(table):
    model = SpeechDisentangler(SPEECH).eval()
    latents = amuse_disentangler.encode_all(model, table, batch=10)
    with torch.no_grad():
        expected = model.encode(table.clips(np.array([37])))
    torch.testing.assert_close(latents.emotion[37:38], expected.emotion, rtol=1e-4, atol=1e-5)
    assert latents.content.shape == (64, 64)


def test_the_prior_trains_every_part(windows):
    prior = MotionPrior(PRIOR)
    still = learns(
        amuse_prior.PriorObjective(prior),
        lambda c: amuse_prior.draw_prior(windows, COURSE, c, kl_weight=1e-3),
    )
    assert still == []


@pytest.mark.parametrize(("progress", "share"), [(0.0, 0.0), (0.005, 0.5), (0.5, 1.0)])
def test_the_kl_term_grows_over_300_steps(windows, progress, share):
    course = replace(COURSE, steps=30000)
    step = amuse_prior.draw_prior(windows, course, chance(progress), kl_weight=0.01)
    assert step.kl == pytest.approx(0.01 * share)
    assert step.motion.shape == (6, 40, 90)


def test_the_denoiser_trains_every_part(gesture_data):
    denoiser = LatentDenoiser(DENOISER)
    objective = amuse_gestures.DenoiserObjective(denoiser, torch.ones(5, 6))
    assert learns(objective, lambda c: gesture_data.draw(denoiser, COURSE, c)) == []


def test_a_denoising_step_compares_with_the_clean_latent_or_the_noise(gesture_data):
    for prediction in ("x0", "noise"):
        denoiser = LatentDenoiser(replace(DENOISER, prediction=prediction))  # predicts zero
        step = gesture_data.draw(denoiser, COURSE, chance())
        weights = torch.rand(5, 6)
        loss, _ = amuse_gestures.DenoiserObjective(denoiser, weights)(step)
        target = step.x0 if prediction == "x0" else step.noise
        torch.testing.assert_close(loss, (weights * target.square()).mean())


def test_a_condition_is_the_speech_of_the_motions_own_clip(gesture_data):
    condition = gesture_data.condition(np.array([0, 5]), np.array([0, 9]))
    rows = [63, 58]  # the rows were reversed
    assert torch.equal(condition.latents.style, gesture_data.speech.latents.style[rows])
    assert not condition.dropped.any()
    moment = (9 + 3 + 0.5) / 30  # frame 3 of the second window
    place = moment * 50 - 0.5  # 20 ms frames
    low = int(place)
    energy = gesture_data.speech.rhythm[58, :, 0]
    expected = energy[low] + (place - low) * (energy[low + 1] - energy[low])
    torch.testing.assert_close(condition.tracks[1, 3, 0], expected, rtol=1e-3, atol=1e-3)


def test_a_tenth_of_the_conditions_is_dropped(gesture_data):
    course = replace(COURSE, batch=3000)
    step = gesture_data.draw(LatentDenoiser(DENOISER), course, chance())
    assert step.condition.dropped.float().mean(0).tolist() == pytest.approx([0.1] * 3, abs=0.02)
    assert step.t.min() < 20
    assert step.t.max() > 980


def test_latents_weigh_as_much_as_they_move_the_motion():
    """Oracle: the size of the linear decoder's answer to one standard deviation of a number."""
    prior, denoiser = MotionPrior(PRIOR).eval(), LatentDenoiser(DENOISER)
    denoiser.latent_std.uniform_(0.5, 2)
    weights = amuse_gestures.latent_weights(prior, denoiser)
    answers = torch.zeros(5, 6)
    for token in range(5):
        for number in range(6):
            tokens = torch.zeros(2, 5, 6)
            tokens[1, token, number] = denoiser.latent_std[token, number]
            with torch.no_grad():
                still, moved = prior.decode(tokens)  # whose residual path starts at zero
            answers[token, number] = (moved - still).norm()
    torch.testing.assert_close(weights, answers / answers.mean(), rtol=1e-3, atol=1e-4)


def test_local_tokens_share_their_statistics():
    latents = torch.randn(500, 5, 6) * 2 + torch.arange(5)[:, None]
    mean, std = amuse_gestures.token_statistics(latents)
    torch.testing.assert_close(mean[0], latents[:, 0].mean(0))
    torch.testing.assert_close(mean[3], latents[:, 1:].mean(dim=(0, 1)))
    assert torch.equal(std[1], std[4])


@pytest.mark.parametrize(
    ("model_class", "objective_class"),
    [
        (MotionExtractor, amuse_extractor.ExtractorObjective),
        (PositionJudge, amuse_extractor.PositionObjective),
    ],
)
def test_both_judges_of_motion_train_every_part(windows, model_class, objective_class):
    objective = objective_class(model_class(EXTRACTOR))
    assert learns(objective, lambda c: amuse_extractor.draw_motion(windows, COURSE, c)) == []


def test_the_judge_of_speech_trains_every_part(table):
    judge = SpeechJudge(SPEECH)
    still = learns(
        amuse_extractor.SpeechJudgeObjective(judge),
        lambda c: amuse_extractor.draw_speech(table, judge, COURSE, c),
    )
    assert still == []


def test_judges_see_the_labels_of_what_they_see(table, windows):
    speech = amuse_extractor.draw_speech(table, SpeechJudge(SPEECH), COURSE, chance())
    rows = np.random.default_rng(0).integers(64, size=6)
    assert np.array_equal(speech.emotion, table.factors[rows, 2])
    assert np.array_equal(speech.style, table.factors[rows, 1])
    motion = amuse_extractor.draw_motion(windows, COURSE, chance())
    assert torch.equal(motion.emotion, windows.emotion[rows])


@pytest.mark.parametrize("width", [0, 1, 2])
def test_a_blur_is_a_local_mean(width):
    x = torch.randn(1, 12, 9)
    blurred = amuse_extractor.blur(x, width)
    reach = 1 if width else 0
    around = x[0, 6 - width : 7 + width, 4 - reach : 5 + reach]
    torch.testing.assert_close(blurred[0, 6, 4], around.mean())
    corner = x[0, : width + 1, : reach + 1]
    torch.testing.assert_close(blurred[0, 0, 0], corner.mean())


def test_the_wrist_error_is_in_centimetres(windows):
    turns = axis_angle_to_matrix(torch.zeros(13, 3))
    still = torch.cat([matrix_to_sixd(turns).flatten(), torch.zeros(12)])

    class Frozen(MotionPrior):
        def forward(self, motion):
            return still.expand_as(motion)

    prior = Frozen(PRIOR)
    true = prior.features.positions(windows.first())[..., 5:7, :]
    arms_out = prior.features.positions(still)[5:7]
    expected = 100 * torch.linalg.vector_norm(true - arms_out, dim=-1).mean()
    assert amuse_prior.wrist_error(prior, windows) == pytest.approx(float(expected), rel=1e-4)
