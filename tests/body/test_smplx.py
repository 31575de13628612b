import pickle

import numpy as np
import pytest
import smplx
import torch
from smplx.joint_names import JOINT_NAMES as PEER_NAMES

from s2glib.body import (
    JOINT_NAMES,
    PARENTS,
    axis_angle_to_matrix,
    linear_blend_skinning,
    load_smplx,
)

VERTICES = 40
KEYS = ["v_template", "f", "weights", "J_regressor", "shapedirs", "posedirs", "kintree_table"]


def smplx_arrays(directions=400, rng=None):
    """A small random body in exactly the layout of a released SMPLX_*.npz."""
    rng = rng or np.random.default_rng(0)
    regressor, weights = rng.random((55, VERTICES)), rng.random((VERTICES, 55)) ** 8
    return {
        "v_template": rng.normal(size=(VERTICES, 3)),
        "f": rng.integers(0, VERTICES, (60, 3)).astype(np.uint32),
        "weights": weights / weights.sum(axis=1, keepdims=True),
        "J_regressor": regressor / regressor.sum(axis=1, keepdims=True),
        "shapedirs": rng.normal(size=(VERTICES, 3, directions)) / 20,
        "posedirs": rng.normal(size=(VERTICES, 3, 486)) / 20,
        "kintree_table": np.array([[2**32 - 1, *PARENTS[1:]], range(55)], dtype=np.uint32),
        "hands_componentsl": np.eye(45),
        "hands_componentsr": np.eye(45),
        "hands_meanl": rng.normal(size=45),
        "hands_meanr": rng.normal(size=45),
        "lmk_faces_idx": rng.integers(0, 60, 51),
        "lmk_bary_coords": np.full((51, 3), 1 / 3),
        "dynamic_lmk_faces_idx": rng.integers(0, 60, (79, 17)),
        "dynamic_lmk_bary_coords": np.full((79, 17, 3), 1 / 3),
        "part2num": np.array({"Global": 0}, dtype=object),  # as released; pickled, never read
    }


@pytest.fixture
def save(tmp_path):
    def write(arrays):
        np.savez(tmp_path / "SMPLX_NEUTRAL.npz", **arrays)
        return tmp_path / "SMPLX_NEUTRAL.npz"

    return write


def peer_joints_and_vertices(path, poses, trans, betas, expression, monkeypatch):
    few = dict.fromkeys(smplx.vertex_ids.vertex_ids["smplx"], 0)  # our body has 40 vertices
    monkeypatch.setitem(smplx.body_models.VERTEX_IDS, "smplx", few)
    counts = {"num_betas": betas.shape[-1], "num_expression_coeffs": expression.shape[-1]}
    model = smplx.SMPLX(
        str(path), flat_hand_mean=True, use_pca=False, batch_size=len(poses), **counts
    )
    names = ("global_orient", "body_pose", "jaw_pose", "leye_pose", "reye_pose")
    hands = ("left_hand_pose", "right_hand_pose")
    parts = poses.flatten(1).split([3, 63, 3, 3, 3, 45, 45], dim=1)
    pose = dict(zip((*names, *hands), parts, strict=True))
    output = model(betas=betas, expression=expression, transl=trans, **pose)
    return output.joints[:, :55], output.vertices


@pytest.mark.parametrize(("directions", "shape", "face"), [(400, 300, 100), (20, 10, 10)])
def test_a_loaded_body_moves_as_in_the_smplx_package(
    directions, shape, face, save, generator, monkeypatch
):
    path = save(smplx_arrays(directions))
    sizes = [(3, 55, 3), (3, 3), (3, shape), (3, face)]
    poses, trans, betas, expression = (torch.randn(s, generator=generator) for s in sizes)
    ours = linear_blend_skinning(
        load_smplx(path), axis_angle_to_matrix(poses), trans, betas=betas, expression=expression
    )
    joints, vertices = peer_joints_and_vertices(path, poses, trans, betas, expression, monkeypatch)
    torch.testing.assert_close(ours.vertices, vertices, atol=1e-5, rtol=1e-5)
    torch.testing.assert_close(ours.joints, joints, atol=1e-5, rtol=1e-5)


def test_our_joints_are_smplxs():
    assert tuple(name.removesuffix("_smplhf") for name in PEER_NAMES[:55]) == JOINT_NAMES


def test_a_body_is_read_as_it_stands_in_the_file(save):
    arrays = smplx_arrays()
    body = load_smplx(save(arrays))
    assert body.vertices.dtype == torch.float32
    assert body.faces.tolist() == arrays["f"].tolist()
    np.testing.assert_allclose(body.pose_directions, arrays["posedirs"], rtol=1e-6)
    np.testing.assert_allclose(body.shape_directions, arrays["shapedirs"][..., :300], rtol=1e-6)
    np.testing.assert_allclose(body.joints, arrays["J_regressor"] @ arrays["v_template"], atol=1e-6)
    assert body.parents == PARENTS
    assert body.colors is None


@pytest.mark.parametrize("key", KEYS)
def test_a_missing_key_is_named(key, save):
    arrays = smplx_arrays()
    del arrays[key]
    with pytest.raises(ValueError, match=f"lacks {key}"):
        load_smplx(save(arrays))


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize("key", KEYS)
@pytest.mark.parametrize("cut", [np.s_[..., :-1], np.s_[None], np.s_[0], np.s_[0, 0]])
def test_arrays_of_the_wrong_size_are_refused(key, cut, save):
    arrays = smplx_arrays()
    with pytest.raises(ValueError, match=r" must "):
        load_smplx(save({**arrays, key: arrays[key][cut]}))


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize("key", [key for key in KEYS if key != "f"])
def test_arrays_that_miss_a_row_are_refused(key, save):
    arrays = smplx_arrays()
    with pytest.raises(ValueError, match=r" must "):
        load_smplx(save({**arrays, key: arrays[key][:-1]}))


@pytest.mark.parametrize("key", KEYS)
def test_pickled_arrays_are_never_opened(key, save):
    with pytest.raises(ValueError, match="pickled objects, which are never opened"):
        load_smplx(save({**smplx_arrays(), key: np.array([{}], dtype=object)}))


@pytest.mark.parametrize("key", KEYS)
def test_words_are_not_numbers(key, save):
    with pytest.raises(ValueError, match=rf"{key} .* must hold finite numbers"):
        load_smplx(save({**smplx_arrays(), key: np.array(["arm"])}))


def test_numbers_that_are_not_finite_are_refused(save):
    arrays = smplx_arrays()
    arrays["posedirs"][3, 1, 4] = np.nan
    with pytest.raises(ValueError, match=r"posedirs .* must hold finite numbers"):
        load_smplx(save(arrays))


def test_another_skeleton_is_refused(save):
    tree = smplx_arrays()["kintree_table"].copy()
    tree[0, 22] = 12
    with pytest.raises(ValueError, match="tree of SMPL-X"):
        load_smplx(save({**smplx_arrays(), "kintree_table": tree}))


@pytest.mark.parametrize("content", [b"", b"not a model", pickle.dumps({"v_template": 0})])
def test_files_of_another_kind_are_refused(content, tmp_path):
    path = tmp_path / "SMPLX_NEUTRAL.npz"
    path.write_bytes(content)
    with pytest.raises(ValueError, match="is not an npz file"):
        load_smplx(path)


@pytest.mark.parametrize("name", ["missing.npz", "."])
def test_a_missing_file_is_refused(name, tmp_path):
    with pytest.raises(ValueError, match="is not an npz file; give the path"):
        load_smplx(tmp_path / name)


def test_a_damaged_file_is_refused(save):
    path = save(smplx_arrays())
    content = bytearray(path.read_bytes())
    content[2000:60000] = bytes(58000)
    path.write_bytes(content)
    with pytest.raises(ValueError, match="is damaged"):
        load_smplx(path)


def test_a_truncated_file_is_refused(save):
    path = save(smplx_arrays())
    path.write_bytes(path.read_bytes()[:50000])
    with pytest.raises(ValueError, match="is not an npz file"):
        load_smplx(path)
