"""Figures of recorded runs.

Paper:    -
Notebook: notebooks/17_motion_distances.ipynb
"""

import json
from pathlib import Path


def recorded_figures(runs: Path, stage: str) -> list[dict[str, float]]:
    """The figures of a stage's recorded runs, seed after seed.

    Raises:
        FileNotFoundError: if there is no record.
    """
    paths = sorted(runs.glob(f"{stage}-teaching-*.json"))
    if not paths:
        raise FileNotFoundError(f"no record of {stage} in {runs}; evaluate with --retrain")
    return [json.loads(path.read_text(encoding="utf8"))["figures"] for path in paths]
