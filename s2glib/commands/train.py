"""Train a stage and write its checkpoint and run record.

Paper:    -
Notebook: -
"""

from argparse import ArgumentParser, Namespace
from pathlib import Path

from s2glib.commands.arguments import natural, positive

STAGES = {
    "amuse-disentangler": "s2glib.recipes.amuse_disentangler",
    "amuse-gestures": "s2glib.recipes.amuse_gestures",
    "amuse-extractor": "s2glib.recipes.amuse_extractor",
    "mddiffusion-decoupling": "s2glib.recipes.mddiffusion_decoupling",
    "mddiffusion-refinement": "s2glib.recipes.mddiffusion_refinement",
    "mddiffusion-128": "s2glib.recipes.mddiffusion_128",
    "mddiffusion-unlabelled": "s2glib.recipes.mddiffusion_unlabelled",
    "mddiffusion-ablation": "s2glib.recipes.mddiffusion_ablation",
    "probtalk-pqvae": "s2glib.recipes.probtalk_pqvae",
    "probtalk-codes": "s2glib.recipes.probtalk_codes",
    "probtalk-predictor": "s2glib.recipes.probtalk_predictor",
    "probtalk-refiner": "s2glib.recipes.probtalk_refiner",
    "probtalk-features": "s2glib.recipes.probtalk_features",
    "probtalk-speakers": "s2glib.recipes.probtalk_speakers",
}
TAKES_DATA = ("mddiffusion-decoupling", "mddiffusion-refinement", "mddiffusion-128")


def describe(parser: ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument("stage", choices=STAGES, metavar="STAGE", help=", ".join(STAGES))
    parser.add_argument("--preset", choices=("teaching", "paper"), default="teaching")
    parser.add_argument(
        "--data",
        type=Path,
        metavar="FOLDER",
        help=f"films of your own instead of the corpus, see s2glib/data/films.py; for "
        f"{', '.join(TAKES_DATA)}",
    )
    parser.add_argument("--out", type=Path, default=Path("trained"), help="for files of the stage")
    parser.add_argument("--seed", type=natural, default=0)
    parser.add_argument("--steps", type=positive, help="instead of the recipe's number")
    parser.add_argument("--resume", action="store_true", help="go on from the saved state")


def run(options: Namespace) -> int:
    """Train.

    Raises:
        ValueError: if the stage cannot take the data, or the data is not as it should be.
        FileNotFoundError: if the data or an earlier stage's checkpoint is missing.
    """
    if options.data is not None and options.stage not in TAKES_DATA:
        raise ValueError(
            f"{options.stage} trains on the corpus only; leave out --data, which is for "
            f"{', '.join(TAKES_DATA)}"
        )
    from importlib import import_module

    from s2glib.recipes.stage import Stage

    stage = Stage(
        name=options.stage,
        folder=options.out,
        preset=options.preset,
        seed=options.seed,
        steps=options.steps,
        resume=options.resume,
        data=options.data,
    )
    import_module(STAGES[options.stage]).train(stage)
    return 0
