"""What product codes are good for: short runs that differ in the quantiser only.

With equal memory and an equally long search, 65 536 numbers: four groups of 128 codes of 128
numbers, or 128 codes of 512. With equally many bits, 12 a token: one codebook of 4096, four groups
of 8, four stages of 8. The runs of a seed are equally long and end early: they show an order, not
what can be reached.

Paper:    PT A.1 (4 groups of 128 codes: authors' code)
Notebook: notebooks/05_product_codes.ipynb
"""

from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np

from s2glib.corpus.script import split
from s2glib.papers.probtalk import PQVAE_PRESETS, PQVAEConfig
from s2glib.recipes.code_scores import STUDY, code_scores
from s2glib.recipes.holistic_data import fitted_features, holistic_clips
from s2glib.recipes.probtalk_pqvae import COURSES, fit_pqvae, new_pqvae
from s2glib.recipes.records import recorded_figures
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


EQUAL_BITS = ("VQ 4096", "PQ 4 x 8", "RQ 4 x 8")
_WHY = {
    "VQ 4096": "its codes may stand anywhere, those of the others are combinations of 32 vectors",
    "PQ 4 x 8": "what its groups say is so independent that few combinations are wasted",
    "RQ 4 x 8": "each stage mends what those before it left, all over the latent",
}


def equal_bits_verdict(runs: Path) -> str:
    """Which quantiser wins at 12 bits a token, why, and at what price, by the recorded runs.

    Raises:
        FileNotFoundError: if there is no record.
    """
    figures, sizes = recorded_figures(runs, STUDY), arms(PQVAE_PRESETS["teaching"])
    errors = {
        name: np.mean([run[f"{name}: wrist error, cm"] for run in figures]) for name in EQUAL_BITS
    }
    best, *others = sorted(errors, key=errors.__getitem__)

    def numbers(name: str) -> int:
        """What all codebooks hold; those of a product divide the latent among them."""
        size = sizes[name]
        tables = size.groups if size.quantizer == "residual" else 1
        return tables * size.codes * size.latent

    prices = [f"{name} {errors[name]:.1f} cm with {numbers(name)}" for name in others]
    return (
        f"At equal bits (12 a token) {best} wins: wrists {errors[best]:.1f} cm off with "
        f"{numbers(best)} numbers in codebooks, probably because {_WHY[best]}. {', '.join(prices)}."
    )


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
