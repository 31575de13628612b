"""How well a picture is made to move: errors against the true film, and keypoints against wrists.

MDD shows pictures; here every film has a true one. Errors are shares of those that the first frame
makes when it is simply kept, in the quarter of the pixels that move most, on hands, and on faces.

Paper:    - (MDD E, Fig. E1 and I say in words and pictures what is measured here)
Notebook: notebooks/19_judging_video.ipynb
"""

import json
from pathlib import Path

import numpy as np
import torch

from s2glib.checkpoint import load_checkpoint
from s2glib.corpus import HELD_OUT, PORTRAIT
from s2glib.papers.mddiffusion import (
    KeypointPredictor,
    MDDiffusion,
    MotionDecoupler,
    RefinementNet,
)
from s2glib.recipes.mddiffusion_ablation import STAGE
from s2glib.recipes.mddiffusion_decoupling import first_keypoints
from s2glib.recipes.report import Row, over_draws, ratio
from s2glib.recipes.video_data import (
    TEST_CLIPS,
    TRAIN_CLIPS,
    VideoFrames,
    films,
    scenes,
)
from s2glib.recipes.video_scores import RegionErrors, film_errors, wrists_explained

_SEED = 11


def evaluate_mddiffusion_video(folder: Path) -> list[Row]:
    """All rows for the checkpoints of a folder, on films of test clips.

    Raises:
        FileNotFoundError: if a checkpoint is missing.
    """
    decoupler = load_checkpoint(folder / "mddiffusion-decoupling.safetensors", MotionDecoupler)
    refiner = load_checkpoint(folder / "mddiffusion-refinement.safetensors", RefinementNet)
    untold = load_checkpoint(folder / "mddiffusion-unlabelled.safetensors", KeypointPredictor)
    size = decoupler.config.size
    train = VideoFrames(films(scenes("train", TRAIN_CLIPS), size))
    test = VideoFrames(films(scenes("test", TEST_CLIPS), size))
    return [
        *error_rows(film_errors(decoupler, test, refiner)),
        *wrist_rows(untold, decoupler.keypoints, train, test),
        *generalisation_rows(decoupler, refiner),
        *larger_rows(MDDiffusion.load(folder, size=128)),
    ]


def error_rows(errors: RegionErrors) -> list[Row]:
    """Region by region: before and after refinement, and what needs no network."""
    moving = errors.moving
    rows = [
        ratio("moving region / copied, refined", moving.refined, moving.copied),
        ratio("moving region / copied, decoupler", moving.made, moving.copied),
        ratio("moving region / copied, bent only", moving.warped, moving.copied),
        ratio("moving region / copied, mean frame", moving.mean, moving.copied),
    ]
    for region, there in (("hand", errors.hand), ("face", errors.face)):
        rows += [
            ratio(f"{region} region / copied, refined", there.refined, there.copied),
            ratio(f"{region} region, refined / decoupler", there.refined, there.made),
        ]
    return rows


def wrist_rows(
    untold: KeypointPredictor, shipped: KeypointPredictor, train: VideoFrames, test: VideoFrames
) -> list[Row]:
    """Whether keypoints tell where the wrists are, and whether training had a part in it.

    The shipped keypoints began on the limbs, so the floors are for those that nobody told
    anything. The untrained network has the same start as these, keypoints included.
    """
    torch.manual_seed(_SEED)
    untrained = KeypointPredictor(untold.config)
    untrained.start_at(first_keypoints(train, untold.config, False, _SEED))
    shares = [
        float(wrists_explained(predictor, train, test).mean())
        for predictor in (untold, untrained.eval(), shipped)
    ]
    measured = {"": shares[0], ", untrained": shares[1], " above untrained": shares[0] - shares[1]}
    measured[", begun on the limbs"] = shares[2]
    n = len(test.lengths)
    return [Row(f"wrists in keypoints, R2{which}", value, n) for which, value in measured.items()]


def generalisation_rows(decoupler: MotionDecoupler, refiner: RefinementNet) -> list[Row]:
    """The same gestures by a known person in known clothes, in unknown ones, and by a stranger.

    [MDD I]
    """
    known = [shot for shot in scenes("test", TEST_CLIPS) if shot.cell.speaker == "voice_01"]
    rows = []
    for name, look in (("known clothes", None), ("new clothes", HELD_OUT), ("stranger", PORTRAIT)):
        shots = [shot._replace(appearance=look or shot.appearance) for shot in known]
        video = VideoFrames(films(shots, decoupler.config.size))
        errors = film_errors(decoupler, video, refiner).moving
        rows.append(ratio(f"moving region / copied, {name}", errors.refined, errors.copied))
    return rows


def larger_rows(system: MDDiffusion) -> list[Row]:
    """Errors region by region again, of networks for larger pictures."""
    size = system.decoupler.config.size
    test = VideoFrames(films(scenes("test", TEST_CLIPS), size))
    rows = error_rows(film_errors(system.decoupler, test, system.refiner))
    return [row._replace(name=f"{size} px: {row.name}") for row in rows]


def ablation_rows(runs: Path) -> list[Row]:
    """The recorded short runs of `mddiffusion_ablation`; intervals are ranges over the seeds.

    Raises:
        FileNotFoundError: if there is no record.
    """
    records = [json.loads(path.read_text()) for path in sorted(runs.glob(f"{STAGE}-teaching-*"))]
    if not records:
        raise FileNotFoundError(f"no record of {STAGE} in {runs}; evaluate with --retrain")

    def compared(name: str, this: str, other: str) -> Row:
        figures = [record["figures"] for record in records]
        values = np.array([one[this] / one[other] for one in figures])
        return over_draws(f"short runs: {name}", values, len(records))._replace(recorded=True)

    rows = [
        compared(
            f"{region}, splines / affine{how}", f"splines{how}: {region}", f"affine{how}: {region}"
        )
        for region in ("moving", "hand", "face")
        for how in ("", ", refined")
    ]
    rows += [
        compared(
            f"{region}, {kind}, refined / not", f"{kind}, refined: {region}", f"{kind}: {region}"
        )
        for region in ("hand", "face")
        for kind in ("splines", "affine")
    ]
    return [*rows, compared("four speakers / one", "four speakers: moving", "one speaker: moving")]
