"""One training stage from start to finish: progress, a state to resume from, a record, a file.

Paper:    -
Notebook: notebooks/09_disentanglement.ipynb
"""

import json
import subprocess
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, TypeVar, cast

from torch import nn
from tqdm import tqdm

from s2glib.checkpoint import save_checkpoint
from s2glib.recipes.fit import Chance, Course, Training

SAVE_EVERY = 60.0  # seconds
CURVE_EVERY = 50  # steps averaged into one point of the recorded loss curve
Kept = TypeVar("Kept", bound=nn.Module)


@dataclass(frozen=True)
class Stage:
    """Where a stage keeps its files, and how far it goes.

    Attributes:
        name: such as "amuse-disentangler".
        folder: for checkpoints, resume states and run records.
        preset: "teaching" or "paper".
        seed: of everything.
        steps: overrides the course's own number.
        resume: go on from the saved state, where there is one.
        data: a folder of films, instead of the corpus; for the video stages.
    """

    name: str
    folder: Path
    preset: str = "teaching"
    seed: int = 0
    steps: int | None = None
    resume: bool = False
    data: Path | None = None

    def course(self, course: Course) -> Course:
        """A course with this stage's seed and length."""
        return replace(course, seed=self.seed, steps=self.steps or course.steps)

    def state_file(self, part: str) -> Path:
        """Where the resume state of a model lies."""
        return self.folder / "states" / f"{part}-{self.preset}-{self.seed}.safetensors"

    def train(
        self, part: str, objective: Kept, course: Course, draw: Callable[[Chance], Any]
    ) -> tuple[Kept, dict[str, Any]]:
        """Run a course with a progress bar; give back the objective (on the CPU) and its record."""
        state = self.state_file(part)
        training = Training(objective, course, resume_from=state if self.resume else None)
        bar = tqdm(total=course.steps, initial=training.step, desc=part, mininterval=2)
        notes = training.notes  # of the part before a resume, too
        curve, before = notes.setdefault("curve", []), notes.get("seconds", 0.0)
        window: list[dict[str, float]] = []
        saved = time.monotonic()
        for log in training.run(draw):
            bar.update()
            notes["seconds"] = round(before + log.seconds, 1)
            window.append({"loss": log.loss, **log.terms})
            if len(window) == CURVE_EVERY or log.step + 1 == course.steps:
                curve.append({"step": log.step + 1, **_means(window)})
                bar.set_postfix({k: f"{v:.3f}" for k, v in curve[-1].items() if k != "step"})
                window = []
            if time.monotonic() - saved > SAVE_EVERY:
                training.save(state)
                saved = time.monotonic()
        bar.close()
        training.save(state)
        record = {"course": asdict(course), "seconds": notes["seconds"], "curve": curve}
        return cast(Kept, training.result.cpu()), record

    def publish(
        self, part: str, model: nn.Module, record: dict[str, Any], figures: dict[str, float]
    ) -> Path:
        """Write the checkpoint (half precision) and the run's record.

        The figures come from the functions that `evaluate` uses. What goes with one PQ-VAE has the
        `codes` of its `fingerprint` in the record.
        """
        path = self.folder / "checkpoints" / f"{part}.safetensors"
        path.parent.mkdir(parents=True, exist_ok=True)
        metadata = {**self._known(record), "figures": figures}
        config: Any = model.config
        save_checkpoint(path, model, config, metadata=metadata, half=True)
        self.note(part, record | {"config": asdict(config)}, figures)
        return path

    def note(self, part: str, record: dict[str, Any], figures: dict[str, float]) -> None:
        """Write a run's record alone."""
        whole = {
            "stage": self.name,
            "part": part,
            "preset": self.preset,
            "commit": _commit(),
            **self._known(record),
            **record,
            "figures": figures,
        }
        runs = self.folder / "runs" / f"{part}-{self.preset}-{self.seed}.json"
        runs.parent.mkdir(parents=True, exist_ok=True)
        runs.write_text(json.dumps(whole, indent=1) + "\n", encoding="utf8")

    def _known(self, record: dict[str, Any]) -> dict[str, Any]:
        known = {"recipe": self.name, "seed": self.seed, "steps": record["course"]["steps"]}
        known |= {"data": self.data.resolve().name} if self.data else {}
        return known | ({"codes": record["codes"]} if "codes" in record else {})


def _means(rows: list[dict[str, float]]) -> dict[str, float]:
    return {name: round(sum(r[name] for r in rows) / len(rows), 5) for name in rows[0]}


def _commit() -> str:
    """The commit of the checkout the package runs from, or "unknown" outside one."""
    done = subprocess.run(
        ["git", "rev-parse", "--short", "HEAD"],
        cwd=Path(__file__).parent,
        capture_output=True,
        text=True,
        check=False,
    )
    return done.stdout.strip() or "unknown"
