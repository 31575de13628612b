"""What product codes are good for: short runs that differ in the quantiser only.

With equal memory and an equally long search, 65 536 numbers: four groups of 128 codes of 128
numbers, or 128 codes of 512. With equally many bits, 12 a token: one codebook of 4096, four groups
of 8, four stages of 8. The runs of a seed are equally long and end early: they show an order, not
what can be reached.

Paper:    PT A.1 (4 groups of 128 codes: authors' code)
Notebook: notebooks/05_product_codes.ipynb
"""

from dataclasses import replace
from typing import Literal

from s2glib.corpus.script import split
from s2glib.papers.probtalk import PQVAE_PRESETS, PQVAEConfig
from s2glib.recipes.code_scores import STUDY, code_scores
from s2glib.recipes.holistic_data import fitted_features, holistic_clips
from s2glib.recipes.probtalk_pqvae import COURSES, fit_pqvae, new_pqvae
from s2glib.recipes.stage import Stage

Kind = Literal["product", "plain", "residual"]
STEPS = 500
SEEDS = (0, 1, 2)


def arms(config: PQVAEConfig) -> dict[str, PQVAEConfig]:
    """The quantisers to compare; a code is dead at the same share of the mean use in all."""

    def arm(quantizer: Kind, groups: int, codes: int) -> PQVAEConfig:
        dead = config.revive_below * config.codes / codes
        return replace(config, quantizer=quantizer, groups=groups, codes=codes, revive_below=dead)

    return {
        "PQ 4 x 128": arm("product", 4, 128),
        "VQ 128": arm("plain", 1, 128),
        "VQ 4096": arm("plain", 1, 4096),
        "PQ 4 x 8": arm("product", 4, 8),
        "RQ 4 x 8": arm("residual", 4, 8),
    }


def train(stage: Stage) -> None:
    """The stage `probtalk-codes`: all runs of one seed. It leaves a record only."""
    config, cells = PQVAE_PRESETS[stage.preset], split("train")
    features = fitted_features(cells, config)
    clips, test = (holistic_clips(some, features) for some in (cells, split("test")))
    course = replace(COURSES[stage.preset], seed=stage.seed, steps=stage.steps or STEPS)
    figures: dict[str, float] = {}
    for name, arm in arms(config).items():
        part = f"{STUDY}-{name.replace(' ', '')}"
        model = new_pqvae(arm, stage.seed, features, clips)
        model, _ = fit_pqvae(stage, part, model, course, clips)
        scores = code_scores(model, test)
        figures |= {
            f"{name}: wrist error, cm": float(scores.wrist.mean()),
            f"{name}: part-wise error": float(scores.parts.mean()),
            f"{name}: perplexity / codes": float(scores.usage.mean()),
        }
    stage.note(STUDY, {"course": {"steps": course.steps}}, figures)
