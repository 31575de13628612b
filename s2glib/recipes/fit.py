"""The training loop: a generator that takes steps, on as many processes as there are.

A batch is drawn from (seed, step, process), and so is every random number of a step. A run that
was stopped and resumed therefore takes exactly the steps it would have taken.

Paper:    -
Notebook: notebooks/10_diffusion.ipynb
"""

import json
import math
import time
from collections.abc import Callable, Iterator
from copy import deepcopy
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from accelerate import Accelerator
from accelerate.utils import send_to_device
from safetensors import safe_open
from safetensors.torch import save_file
from torch import Tensor, nn


@dataclass(frozen=True)
class Course:
    """How to train: AdamW, warm-up, cosine decay, gradient clipping, and a moving average.

    Attributes:
        last_rate: share of the learning rate at the end.
        slower: shares of the learning rate for some parts of the objective, by their names.
        average: decay of the moving average of the weights; None: none is kept.
    """

    steps: int
    batch: int
    learning_rate: float
    betas: tuple[float, float] = (0.9, 0.999)
    weight_decay: float = 0.01
    warm_up: int = 100
    last_rate: float = 0.02
    clip: float = 1.0
    slower: dict[str, float] = field(default_factory=dict)
    average: float | None = None
    seed: int = 0

    def rate(self, step: int) -> float:
        """Learning rate at a step."""
        warm = min(1.0, (step + 1) / self.warm_up)
        decay = 0.5 + 0.5 * math.cos(math.pi * step / self.steps)
        return self.learning_rate * warm * (self.last_rate + (1 - self.last_rate) * decay)


class StepLog(NamedTuple):
    """What one step saw."""

    step: int
    loss: float
    terms: dict[str, float]
    seconds: float


class Chance(NamedTuple):
    """The random numbers of one step of one process."""

    rng: np.random.Generator
    generator: torch.Generator
    progress: float  # share of the course that is done


Objective = Callable[[Any], tuple[Tensor, dict[str, Tensor]]]


class Training:
    """A model on its way: weights, optimiser, moving average, and the next step.

    Args:
        objective: a module that holds the model and turns a batch into (loss, named terms).
        course: how to train.
        resume_from: a file of `save`; where it exists, training goes on from there.
    """

    def __init__(self, objective: nn.Module, course: Course, *, resume_from: Path | None = None):
        self.course, self.step = course, 0
        self.notes: dict[str, Any] = {}  # saved with the state
        self.accelerator = Accelerator()
        optimizer = torch.optim.AdamW(
            _groups(objective, course.slower),
            course.learning_rate,
            course.betas,
            weight_decay=course.weight_decay,
        )
        self.bare = objective
        self.average = deepcopy(objective).requires_grad_(False) if course.average else None
        self.objective, self.optimizer = self.accelerator.prepare(objective, optimizer)
        self.resume_from = resume_from
        if resume_from is not None and resume_from.exists():
            self.load(resume_from)

    def run(self, draw: Callable[[Chance], Any]) -> Iterator[StepLog]:
        """Take the steps that are left; `draw` makes the batch of a step."""
        self.objective.train()
        began = time.monotonic()
        while self.step < self.course.steps:
            chance = self._chance()
            loss, terms = self.objective(send_to_device(draw(chance), self.accelerator.device))
            for group in self.optimizer.param_groups:
                group["lr"] = group["share"] * self.course.rate(self.step)
            self.optimizer.zero_grad(set_to_none=True)
            self.accelerator.backward(loss)
            self.accelerator.clip_grad_norm_(self.objective.parameters(), self.course.clip)
            self.optimizer.step()
            self._follow()
            values = {name: float(value.detach()) for name, value in terms.items()}
            self.step += 1
            yield StepLog(self.step - 1, float(loss.detach()), values, time.monotonic() - began)

    def _chance(self) -> Chance:
        key = [self.course.seed, self.step, self.accelerator.process_index]
        rng = np.random.default_rng(key)
        seed = int(rng.integers(2**62))
        torch.manual_seed(seed)  # dropout
        generator = torch.Generator().manual_seed(seed)
        return Chance(rng, generator, self.step / self.course.steps)

    @torch.no_grad()
    def _follow(self) -> None:
        """Move the average towards the weights, faster at the beginning."""
        if self.average is None or self.course.average is None:
            return
        decay = min(self.course.average, 1 - 1 / (self.step / 10 + 1))
        pairs = zip(self.average.parameters(), self.bare.parameters(), strict=True)
        for mean, value in pairs:
            mean.lerp_(value.to(mean), 1 - decay)

    @property
    def result(self) -> nn.Module:
        """The objective to keep: the moving average where there is one."""
        return self.average if self.average is not None else self.bare

    def save(self, path: Path) -> None:
        """Write everything a resume needs; the file appears whole or not at all."""
        if not self.accelerator.is_main_process:
            return
        tensors = {f"model/{k}": v for k, v in self.bare.state_dict().items()}
        if self.average is not None:
            tensors |= {f"average/{k}": v for k, v in self.average.state_dict().items()}
        for number, state in self.optimizer.state_dict()["state"].items():
            tensors |= {f"optimizer/{number}/{k}": v for k, v in state.items()}
        header = {"step": json.dumps(self.step), "notes": json.dumps(self.notes)}
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished = path.with_suffix(".tmp")
        save_file(
            {k: v.detach().clone().contiguous() for k, v in tensors.items()}, unfinished, header
        )
        unfinished.replace(path)

    def load(self, path: Path) -> None:
        """Go on from a file of `save`."""
        with safe_open(path, "pt") as stored:
            self.step, self.notes = (json.loads(stored.metadata()[k]) for k in ("step", "notes"))
            tensors = {name: stored.get_tensor(name) for name in stored.keys()}  # noqa: SIM118

        def part(prefix: str) -> dict[str, Tensor]:
            length = len(prefix)
            return {k[length:]: v for k, v in tensors.items() if k.startswith(prefix)}

        self.bare.load_state_dict(part("model/"))
        if self.average is not None:
            self.average.load_state_dict(part("average/"))
        state: dict[int, dict[str, Tensor]] = {}
        for name, value in part("optimizer/").items():
            number, key = name.split("/")
            state.setdefault(int(number), {})[key] = value
        whole = self.optimizer.state_dict()
        self.optimizer.load_state_dict({"state": state, "param_groups": whole["param_groups"]})


def _groups(objective: nn.Module, slower: dict[str, float]) -> list[dict[str, Any]]:
    """What is trained, part by part where parts have rates of their own."""
    groups: dict[str | None, dict[str, Any]] = {None: {"params": [], "share": 1.0}}
    groups |= {part: {"params": [], "share": share} for part, share in slower.items()}
    for name, parameter in objective.named_parameters():
        part = name.split(".")[0]
        if parameter.requires_grad:
            groups[part if part in slower else None]["params"].append(parameter)
    missing = [part for part in slower if not groups[part]["params"]]
    if missing:
        raise ValueError(f"the objective trains no part called {', '.join(missing)}")
    return list(groups.values())
