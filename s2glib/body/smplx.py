"""SMPL-X for readers who hold its licence: the model file becomes a `BodyModel` of ours.

Paper:    PT A.2, AM C.2 (SMPL-X bodies)
Notebook: notebooks/21_cost_and_harm.ipynb
"""

import os
import zipfile

import numpy as np
import torch

from s2glib.body.skeleton import PARENTS
from s2glib.body.skinning import BodyModel, check_shape

_KEYS = ("v_template", "f", "weights", "J_regressor", "shapedirs", "posedirs", "kintree_table")
_SHAPE_SPLITS = {400: 300, 20: 10}  # columns of shapedirs: how many of them come before the face's


def load_smplx(path: str | os.PathLike[str]) -> BodyModel:
    """Read one of the released `SMPLX_*.npz` files.

    Hands are flat at rest (`flat_hand_mean=True` in the smplx package), and poses carry all 55
    joints. Only plain arrays are read, so a file from anybody can be opened without trust.

    Args:
        path: the npz file; both releases are read, with 300 + 100 or 10 + 10 directions.

    Raises:
        ValueError: if the file is missing, is not an npz of plain arrays, lacks a key, or its
            arrays do not fit the 55 joints of SMPL-X.
    """
    arrays = _read_arrays(path)
    _check_tree(arrays["kintree_table"])
    vertices, regressor = _floats(arrays["v_template"]), _floats(arrays["J_regressor"])
    directions = _directions(arrays["shapedirs"])
    check_shape("v_template", vertices, (None, 3))
    check_shape("J_regressor", regressor, (len(PARENTS), len(vertices)))
    check_shape("shapedirs", directions, (len(vertices), 3, None))
    split = _SHAPE_SPLITS.get(directions.shape[-1])
    if split is None:
        raise ValueError(f"shapedirs must have 400 or 20 directions, got {directions.shape[-1]}")
    return BodyModel(
        vertices=vertices,
        faces=torch.from_numpy(arrays["f"].astype(np.int64)),
        weights=_floats(arrays["weights"]),
        joints=regressor @ vertices,
        parents=PARENTS,
        shape_directions=directions[..., :split],
        expression_directions=directions[..., split:],
        pose_directions=_directions(arrays["posedirs"]),
        joint_regressor=regressor,
    )


def _read_arrays(path: str | os.PathLike[str]) -> dict[str, np.ndarray]:
    if not os.path.isfile(path) or not zipfile.is_zipfile(path):
        raise ValueError(f"{path} is not an npz file; give the path of a released SMPLX_*.npz")
    with np.load(path, allow_pickle=False) as file:
        missing = [key for key in _KEYS if key not in file]
        if missing:
            raise ValueError(f"{path} lacks {', '.join(missing)}; is it an SMPL-X model?")
        try:
            arrays = {key: file[key] for key in _KEYS}
        except (ValueError, zipfile.BadZipFile, EOFError) as error:
            raise ValueError(
                f"{path} is damaged or holds pickled objects, which are never opened; "
                "download the npz release again"
            ) from error
    for key, array in arrays.items():
        if not np.issubdtype(array.dtype, np.number) or not np.isfinite(array).all():
            raise ValueError(f"{key} in {path} must hold finite numbers only")
    return arrays


def _check_tree(kintree: np.ndarray) -> None:
    """The file must have SMPL-X's joints; its root's parent may be any placeholder."""
    if kintree.shape != (2, len(PARENTS)) or kintree[0, 1:].tolist() != list(PARENTS[1:]):
        raise ValueError("kintree_table must be the (2, 55) tree of SMPL-X; SMPL and SMPL-H differ")


def _floats(array: np.ndarray) -> torch.Tensor:
    return torch.from_numpy(array.astype(np.float32))


def _directions(array: np.ndarray) -> torch.Tensor:
    """Offsets (v, 3, k), laid out in memory as (k, v, 3), which a product reads in one sweep."""
    return _floats(np.moveaxis(array, -1, 0).copy()).movedim(0, -1)
