"""Train the networks that ProbTalk's FGD is measured with: face, body and hands, all.

Paper:    PT B Tab. 7 (FGD)
Notebook: notebooks/17_motion_distances.ipynb
"""

from functools import partial

import torch
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.corpus.script import split
from s2glib.papers.probtalk.config import FEATURE_PRESETS
from s2glib.papers.probtalk.feature_autoencoder import SEEN, FeatureNets
from s2glib.recipes.fit import Course
from s2glib.recipes.holistic_data import HolisticClips, holistic_clips
from s2glib.recipes.probtalk_pqvae import draw, trained_pqvae
from s2glib.recipes.stage import Stage

COURSES = {
    "paper": Course(  # Adam at a constant rate: authors' code; so many steps: ours
        steps=40_000,
        batch=128,
        learning_rate=1e-4,
        weight_decay=0.0,
        warm_up=1,
        last_rate=1.0,
        clip=5.0,
    ),
    "teaching": Course(steps=3000, batch=64, learning_rate=2e-3, weight_decay=1e-4),
}


class FeatureObjective(nn.Module):
    """Holds the three networks; one call rebuilds what each of them sees."""

    def __init__(self, model: FeatureNets):
        super().__init__()
        self.model = model

    def forward(
        self, motion: Float[Tensor, "batch frames features"]
    ) -> tuple[Tensor, dict[str, Tensor]]:
        """The sum of the three losses, and each of them."""
        terms = {kind: losses.total() for kind, losses in self.model.losses(motion).items()}
        return torch.stack(list(terms.values())).sum(), terms


@torch.no_grad()
def unexplained(nets: FeatureNets, clips: HolisticClips) -> dict[str, float]:
    """Of each network, the error of the first windows over that of their mean window."""
    motion = clips.first(nets.config.frames)
    shares = {}
    for kind in SEEN:
        seen = nets.see(kind, motion)
        error = (nets.net(kind)(seen) - seen).abs().mean()
        shares[kind] = float(error / (seen - seen.mean(0)).abs().mean())
    return shares


def train(stage: Stage) -> None:
    """The stage `probtalk-features`; the PQ-VAE, whose statistics they share, must be there."""
    torch.manual_seed(stage.seed)
    nets = FeatureNets(FEATURE_PRESETS[stage.preset])
    pqvae = trained_pqvae(stage, nets.features.size)
    nets.features.load_state_dict(pqvae.features.state_dict())
    clips, held_out = (holistic_clips(split(s), nets.features) for s in ("train", "validation"))
    course = stage.course(COURSES[stage.preset])
    objective = FeatureObjective(nets)
    kept, record = stage.train(
        stage.name, objective, course, partial(draw, clips, nets.config.frames, course)
    )
    nets = kept.model.eval()
    figures = {f"unexplained, {kind}": share for kind, share in unexplained(nets, held_out).items()}
    stage.publish(stage.name, nets, record, figures)
