"""Tables of quality: recompute what the shipped checkpoints reach, and compare with the aims.

Paper:    AM Tab. 1-2, A.1-A.2
Notebook: notebooks/17_motion_distances.ipynb
"""

import shutil
import sys
from collections.abc import Iterable
from pathlib import Path

from s2glib.folders import cache_folder, data_folder, runs_folder
from s2glib.recipes import mddiffusion_ablation, probtalk_codes, probtalk_speakers
from s2glib.recipes.evaluate_amuse_gesture import evaluate_amuse_gesture
from s2glib.recipes.evaluate_amuse_speech import evaluate_amuse_speech
from s2glib.recipes.evaluate_mddiffusion_video import ablation_rows, evaluate_mddiffusion_video
from s2glib.recipes.evaluate_probtalk import evaluate_probtalk, recorded_rows
from s2glib.recipes.report import Row, table, write_rows
from s2glib.recipes.stage import Stage

TABLES = {
    "amuse-speech": evaluate_amuse_speech,
    "amuse-gesture": evaluate_amuse_gesture,
    "mddiffusion-video": evaluate_mddiffusion_video,
    "probtalk": evaluate_probtalk,
}
RECORDED = {"mddiffusion-video": ablation_rows, "probtalk": recorded_rows}
STUDIES = {  # the recorded runs, by table and by stage
    "mddiffusion-video": {"mddiffusion-ablation": mddiffusion_ablation},
    "probtalk": {"probtalk-codes": probtalk_codes, "probtalk-speakers": probtalk_speakers},
}
VERDICTS = {"probtalk": probtalk_codes.equal_bits_verdict}
NAMES = (*TABLES, "all")


def evaluate(
    name: str,
    *,
    json_path: Path | None = None,
    strict: bool = False,
    folder: Path | None = None,
    retrain: bool = False,
) -> int:
    """Print a table, and write it as JSON.

    Args:
        name: one of `NAMES`.
        json_path: where to write the rows.
        strict: whether a missed aim, or a floor that does not hold, is a failure.
        folder: of the checkpoints; by default the shipped ones.
        retrain: whether to do the recorded runs again, instead of reading their records.

    Returns:
        The exit code: 0, 1 if strict and something is missed, 2 if it cannot be measured.

    Raises:
        ValueError: for another name, or a checkpoint that does not fit.
        FileNotFoundError: if a checkpoint or a record is missing.
    """
    if name not in NAMES:
        raise ValueError(f"there are tables for {', '.join(NAMES)}; got {name!r}")
    folder = folder or data_folder() / "checkpoints"
    chosen = list(TABLES) if name == "all" else [name]
    again = [one for one in chosen if one in RECORDED] if retrain else []
    runs = _retrained(again, folder) if again else runs_folder()
    try:
        rows = [row for one in chosen for row in _rows(one, folder, runs)]
    except ImportError as error:
        print(
            "the test clips must be made once, which needs the extra: pip install s2glib[corpus] "
            f"({error})",
            file=sys.stderr,
        )
        return 2
    print(table(rows))
    for one in chosen:
        if one in VERDICTS:
            print(VERDICTS[one](runs))
    if json_path is not None:
        write_rows(json_path, rows)
    return int(strict and any(row.met is False or row.held is False for row in rows))


def _rows(name: str, folder: Path, runs: Path) -> list[Row]:
    """What is measured now, and what was recorded."""
    measured = TABLES[name](folder)
    return [*measured, *RECORDED[name](runs)] if name in RECORDED else measured


def _retrained(names: Iterable[str], checkpoints: Path) -> Path:
    """Do the recorded runs of tables again, in the cache; where they now stand recorded."""
    folder = cache_folder() / "retrained"
    shutil.copytree(checkpoints, folder / "checkpoints", dirs_exist_ok=True)  # some begin there
    for name in names:
        for stage, study in STUDIES[name].items():
            for seed in study.SEEDS:
                study.train(Stage(stage, folder, seed=seed))
    return folder / "runs"
