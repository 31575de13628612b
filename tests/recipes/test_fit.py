import json
from itertools import pairwise

import numpy as np
import pytest
import torch
from safetensors import safe_open
from torch import nn

from s2glib.recipes import Course, Training

COURSE = Course(steps=6, batch=4, learning_rate=0.05, warm_up=2, average=0.9)


class Regression(nn.Module):
    """Fits a line; dropout and noisy batches make every step depend on chance."""

    def __init__(self):
        super().__init__()
        self.model = nn.Linear(3, 1)
        self.dropout = nn.Dropout(0.3)

    def forward(self, batch):
        x, y = batch
        loss = (self.model(self.dropout(x)) - y).square().mean()
        return loss, {"squared error": loss}


def draw(chance):
    x = torch.randn(4, 3, generator=chance.generator)
    return x, x.sum(dim=1, keepdim=True) + 0.1 * float(chance.rng.normal())


def begin(course=COURSE, **options):
    torch.manual_seed(0)
    return Training(Regression(), course, **options)


def weights(module):
    return torch.cat([value.flatten() for value in module.state_dict().values()])


def test_a_resumed_run_gives_the_bits_of_an_uninterrupted_one(tmp_path):
    whole = begin()
    losses = [log.loss for log in whole.run(draw)]
    first = begin()
    for log in first.run(draw):
        if log.step == 2:
            first.save(tmp_path / "state.safetensors")
            break
    second = begin(resume_from=tmp_path / "state.safetensors")
    rest = [log.loss for log in second.run(draw)]
    assert rest == losses[3:]
    assert torch.equal(weights(second.bare), weights(whole.bare))
    assert torch.equal(weights(second.average), weights(whole.average))


def test_the_same_seed_gives_the_same_bits_and_another_seed_another_run():
    runs = {}
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        training = begin(Course(**{**vars(COURSE), "seed": seed}))
        runs[name] = [log.loss for log in training.run(draw)]
    assert runs["a"] == runs["b"]
    assert runs["a"] != runs["c"]


def test_steps_agree_with_adamw_written_out():
    """Oracle: torch's optimiser with the course's rate and clipping, batch by batch."""
    course = Course(steps=5, batch=4, learning_rate=0.1, warm_up=3, clip=0.5, weight_decay=0.2)
    training, chances = begin(course), []

    def remember(chance):
        batch = draw(chance)
        chances.append(batch)
        return batch

    training.bare.dropout.p = 0.0
    list(training.run(remember))
    torch.manual_seed(0)
    plain = Regression()
    plain.dropout.p = 0.0
    optimizer = torch.optim.AdamW(plain.parameters(), weight_decay=0.2)
    for step, batch in enumerate(chances):
        optimizer.param_groups[0]["lr"] = course.rate(step)
        optimizer.zero_grad()
        plain(batch)[0].backward()
        nn.utils.clip_grad_norm_(plain.parameters(), 0.5)
        optimizer.step()
    torch.testing.assert_close(weights(training.bare), weights(plain))


def test_the_rate_warms_up_and_falls_to_its_last_share():
    course = Course(steps=1000, batch=1, learning_rate=2.0, warm_up=100, last_rate=0.1)
    rates = np.array([course.rate(step) for step in range(1000)])
    assert rates[0] == pytest.approx(0.02)
    assert (np.diff(rates[:80]) > 0).all()
    assert (np.diff(rates[120:]) < 0).all()
    assert rates[-1] == pytest.approx(0.2, rel=1e-3)
    middle = 2 * (0.1 + 0.9 * 0.5)  # half of the cosine
    assert rates[500] == pytest.approx(middle)


def test_the_average_follows_the_weights():
    training = begin(Course(steps=60, batch=4, learning_rate=0.05, warm_up=2, average=0.8))
    mean = None
    for log in training.run(draw):
        decay = min(0.8, 1 - 1 / (log.step / 10 + 1))
        now = weights(training.bare).clone()
        mean = now if mean is None else decay * mean + (1 - decay) * now
        torch.testing.assert_close(weights(training.average), mean)
    assert training.result is training.average
    assert not any(p.requires_grad for p in training.average.parameters())


def test_without_an_average_the_weights_are_the_result():
    training = begin(Course(steps=1, batch=4, learning_rate=0.1))
    list(training.run(draw))
    assert training.result is training.bare


def test_frozen_weights_stay_and_the_others_learn():
    torch.manual_seed(0)
    objective = Regression()
    objective.model.bias.requires_grad_(False)
    before = weights(objective).clone()
    list(Training(objective, COURSE).run(draw))
    assert objective.model.bias == before[-1]
    assert not torch.equal(weights(objective)[:3], before[:3])


def test_training_brings_the_loss_down():
    training = begin(Course(steps=100, batch=4, learning_rate=0.05, warm_up=5))
    training.bare.dropout.p = 0.0
    losses = [log.loss for log in training.run(draw)]
    assert np.mean(losses[-20:]) < 0.5 * np.mean(losses[:20])


def test_a_log_counts_steps_and_names_terms():
    logs = list(begin().run(draw))
    assert [log.step for log in logs] == list(range(6))
    assert all(log.terms == {"squared error": log.loss} for log in logs)
    assert all(a.seconds <= b.seconds for a, b in pairwise(logs))


def test_a_draw_hears_how_far_the_course_is():
    seen = []
    list(begin().run(lambda chance: seen.append(chance.progress) or draw(chance)))
    assert seen == pytest.approx([step / 6 for step in range(6)])


def test_a_finished_run_is_saved_as_finished(tmp_path):
    training, path = begin(), tmp_path / "states" / "state.safetensors"
    list(training.run(draw))
    training.save(path)
    with safe_open(path, "pt") as stored:
        assert json.loads(stored.metadata()["step"]) == 6
    assert list(begin(resume_from=path).run(draw)) == []
    assert [file.name for file in path.parent.iterdir()] == ["state.safetensors"]


def test_a_state_that_is_not_there_yet_starts_at_the_beginning(tmp_path):
    training = begin(resume_from=tmp_path / "nothing.safetensors")
    assert len(list(training.run(draw))) == 6


def test_a_part_with_a_rate_of_its_own_takes_smaller_steps():
    course = Course(steps=1, batch=4, learning_rate=0.1, warm_up=1, slower={"second": 0.25})

    class Two(nn.Module):
        def __init__(self):
            super().__init__()
            self.first, self.second = nn.Linear(2, 1), nn.Linear(2, 1)

        def forward(self, batch):
            loss = self.first(batch).mean() + self.second(batch).mean()
            return loss, {}

    training = Training(Two(), course)
    before = [part.weight.clone() for part in (training.bare.first, training.bare.second)]
    list(training.run(lambda chance: torch.ones(3, 2)))
    after = [part.weight for part in (training.bare.first, training.bare.second)]
    moved = [float((b - a).detach().abs().mean()) for a, b in zip(before, after, strict=True)]
    assert moved[0] == pytest.approx(0.1, rel=0.02)
    assert moved[1] == pytest.approx(0.025, rel=0.02)


def test_a_part_that_is_not_there_is_named():
    with pytest.raises(ValueError, match="no part called critic"):
        begin(Course(steps=1, batch=4, learning_rate=0.1, slower={"critic": 0.5}))
