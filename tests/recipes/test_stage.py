"""A stage that is stopped and resumed publishes what an uninterrupted one would have."""

import json
from dataclasses import dataclass

import torch
from torch import nn

from s2glib.checkpoint import load_checkpoint, read_metadata
from s2glib.recipes.fit import Course
from s2glib.recipes.stage import Stage


@dataclass(frozen=True)
class LineConfig:
    width: int = 2


class Line(nn.Module):
    config_class = LineConfig

    def __init__(self, config):
        super().__init__()
        self.config = config
        self.linear = nn.Linear(config.width, 1)


class Objective(nn.Module):
    def __init__(self, model):
        super().__init__()
        self.model = model

    def forward(self, x):
        loss = self.model.linear(x).square().mean()
        return loss, {"square": loss}


def trained(folder, *, steps, resume=False):
    torch.manual_seed(0)
    stage = Stage("line", folder, resume=resume)
    course = Course(steps=steps, batch=4, learning_rate=0.1, warm_up=1, average=0.9)
    draw = lambda chance: torch.randn(4, 2, generator=chance.generator)  # noqa: E731
    kept, record = stage.train("line", Objective(Line(LineConfig())), course, draw)
    return stage, kept, record


def test_the_record_of_a_finished_stage_survives_another_resume(tmp_path):
    _, _, first = trained(tmp_path, steps=120)
    _, _, again = trained(tmp_path, steps=120, resume=True)
    assert again["curve"] == first["curve"]
    assert [point["step"] for point in first["curve"]] == [50, 100, 120]


def test_a_published_run_tells_its_config_steps_and_figures(tmp_path):
    stage, kept, record = trained(tmp_path, steps=50)
    path = stage.publish("line", kept.model, record, {"error": 0.5})
    run = json.loads((tmp_path / "runs" / "line-teaching-0.json").read_text())
    assert run["config"] == {"width": 2}
    assert run["course"]["steps"] == 50
    assert read_metadata(path)["figures"] == run["figures"] == {"error": 0.5}


def test_the_published_weights_are_the_moving_average_in_half_precision(tmp_path):
    stage, kept, record = trained(tmp_path, steps=50)
    path = stage.publish("line", kept.model, record, {})
    loaded = load_checkpoint(path, Line)
    assert torch.equal(loaded.linear.weight, kept.model.linear.weight.half().float())
