import numpy as np
import pytest
import torch
import trimesh
from safetensors.numpy import save_file

from s2glib.body import FACE_CURVES, JOINT_NAMES, PELVIS_HEIGHT, BodyModel, joint
from s2glib.body.mannequin import build_mannequin, mannequin, save_mannequin
from s2glib.body.rotations import axis_angle_to_matrix
from s2glib.body.skinning import linear_blend_skinning


@pytest.fixture(scope="module")
def built() -> BodyModel:
    return build_mannequin()


@pytest.fixture(scope="module")
def body() -> BodyModel:
    return mannequin()


@pytest.fixture(scope="module")
def mesh(body) -> trimesh.Trimesh:
    return trimesh.Trimesh(body.vertices.numpy(), body.faces.numpy(), process=False)


def posed(body: BodyModel, **turns: tuple[float, float, float]) -> np.ndarray:
    poses = torch.zeros(55, 3)
    for name, turn in turns.items():
        poses[joint(name)] = torch.tensor(turn)
    rotations = axis_angle_to_matrix(poses)
    return linear_blend_skinning(body, rotations, torch.zeros(3)).vertices.numpy()


def winding_numbers(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """How often a surface wraps around each point: an oracle for `inside`, by solid angles."""
    a, b, c = (triangles[None] - points[:, None, None]).transpose(2, 0, 1, 3)
    la, lb, lc = (np.linalg.norm(side, axis=-1) for side in (a, b, c))
    volume = np.einsum("pfi,pfi->pf", a, np.cross(b, c))
    ab, bc, ca = (np.einsum("pfi,pfi->pf", *pair) for pair in ((a, b), (b, c), (c, a)))
    angle = np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb)
    return angle.sum(1) / (2 * np.pi)


def test_the_surface_is_one_and_closed(mesh):
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.body_count == 1
    assert mesh.volume > 0.05


def test_the_surface_has_a_moderate_number_of_vertices(body):
    assert 3000 <= len(body.vertices) <= 6000
    assert body.faces.unique().numel() == len(body.vertices)


def test_no_triangle_is_a_needle_across_the_body(mesh):
    assert mesh.edges_unique_length.max() < 0.14


def test_left_and_right_are_mirror_images(body):
    vertices = body.vertices.numpy()
    flipped = vertices * (-1, 1, 1)
    distance = np.linalg.norm(vertices[:, None, :] - flipped[None, ::7, :], axis=-1).min(0)
    assert distance.max() < 1e-5


def test_weights_mirror_with_the_joints(body):
    swap = {"left": "right", "right": "left"}
    other = [
        joint("_".join(swap.get(word, word) for word in name.split("_"))) for name in JOINT_NAMES
    ]
    vertices = body.vertices.numpy()
    distance = np.linalg.norm(vertices[:, None] - (vertices * (-1, 1, 1))[None, ::7], axis=-1)
    twin = distance.argmin(0)
    np.testing.assert_allclose(body.weights[twin], body.weights[::7][:, other], atol=2e-3)


def test_weights_are_shares_of_at_most_four_joints(body):
    assert (body.weights >= 0).all()
    assert torch.allclose(body.weights.sum(1), torch.ones(len(body.weights)), atol=1e-6)
    assert (body.weights > 0).sum(1).max() <= 4


def test_every_joint_but_the_root_moves_something(body):
    assert (body.weights.max(0).values > 0.2).all()


def test_joints_lie_inside_the_body(body, mesh):
    around = winding_numbers(body.joints.numpy(), mesh.triangles)
    np.testing.assert_allclose(around, 1, atol=1e-3)


def test_proportions_are_those_of_an_adult(body):
    y = body.vertices[:, 1]
    assert y.min().item() == pytest.approx(-PELVIS_HEIGHT, abs=1e-3)
    height = (y.max() - y.min()).item()
    face = body.vertices[body.weights[:, joint("head")] + body.weights[:, joint("jaw")] > 0.9]
    head = (face[:, 1].max() - face[:, 1].min()).item()
    assert 1.6 < height < 1.85
    assert 6.5 < height / head < 8
    assert 0.95 < 2 * body.vertices[:, 0].max().item() / height < 1.05  # span of the arms


@pytest.mark.parametrize("curve", FACE_CURVES)
def test_a_face_curve_moves_the_head_and_nothing_else(body, curve):
    step = body.expression_directions[:, :, FACE_CURVES.index(curve)].norm(dim=1)
    names = ("head", "jaw", "left_eye", "right_eye")
    on_head = sum(body.weights[:, joint(name)] for name in names) > 0.5
    assert 0.003 < step.max() < 0.03
    assert step[~on_head].max() < 1e-3


def lips(body: BodyModel) -> tuple[int, int]:
    """The vertices in the middle of the upper and of the lower lip's edge."""
    x, y, z = body.vertices.T
    front = (x.abs() < 1e-6) & (z > 0.095) & ((y - 0.5885).abs() < 0.003)
    edge = torch.where(front)[0]
    return edge[y[edge].argmax()].item(), edge[y[edge].argmin()].item()


def test_the_jaw_opens_the_mouth(body):
    upper, lower = lips(body)
    rest, opened = posed(body), posed(body, jaw=(0.3, 0.0, 0.0))
    assert rest[upper, 1] - rest[lower, 1] < 0.006
    assert opened[upper, 1] - opened[lower, 1] > 0.018


def test_closed_lids_cover_the_pupils(body):
    vertices, directions = body.vertices, body.expression_directions
    closed = vertices + directions[:, :, FACE_CURVES.index("lid_close")]
    eye = body.weights[:, joint("left_eye")] > 0.99
    pupil = closed[eye][closed[eye][:, 2].argmax()]
    skin = closed[~eye]
    over = skin[((skin - pupil)[:, :2]).norm(dim=1) < 0.008]
    assert over[:, 2].max() > pupil[2]


def test_a_bent_elbow_keeps_its_girth(body):
    rest = posed(body)
    bent = posed(body, left_elbow=(0.0, -2.09, 0.0))
    ring = np.abs(rest[:, 0] - body.joints[joint("left_elbow"), 0].item()) < 0.003
    assert np.ptp(bent[ring, 1]) > 0.9 * np.ptp(rest[ring, 1])  # the axis of the bend is y
    assert np.ptp(bent[ring, 0] - bent[ring, 2]) > 0.5 * np.ptp(rest[ring, 2])


def test_hanging_arms_stay_clear_of_each_other_and_keep_the_shoulder(body):
    hanging = posed(body, left_shoulder=(0.0, 0.0, -1.3), right_shoulder=(0.0, 0.0, 1.3))
    edges = trimesh.Trimesh(hanging, body.faces.numpy(), process=False).edges_unique_length
    assert edges.max() < 0.14
    left = hanging[body.weights[:, joint("left_wrist")].numpy() > 0.5]
    assert left[:, 0].min() > 0.17
    assert left[:, 1].max() < 0.0


def test_the_shipped_file_is_what_the_parts_give(body, built):
    assert torch.equal(body.faces, built.faces)
    torch.testing.assert_close(body.vertices, built.vertices, atol=1e-5, rtol=0)
    torch.testing.assert_close(body.joints, built.joints, atol=1e-6, rtol=0)
    torch.testing.assert_close(body.weights, built.weights, atol=2e-3, rtol=0)
    torch.testing.assert_close(body.colors, built.colors, atol=1 / 255, rtol=0)
    torch.testing.assert_close(
        body.expression_directions, built.expression_directions, atol=2e-5, rtol=0
    )


def test_the_shipped_file_is_small(body, tmp_path):
    save_mannequin(body, tmp_path / "copy.safetensors")
    assert (tmp_path / "copy.safetensors").stat().st_size < 500_000
    assert [path.name for path in tmp_path.iterdir()] == ["copy.safetensors"]


def test_a_saved_mannequin_loads_again(built, tmp_path):
    save_mannequin(built, tmp_path / "again.safetensors")
    again = mannequin(tmp_path / "again.safetensors")
    assert torch.equal(again.vertices, built.vertices)
    assert again.parents == built.parents


def test_a_missing_file_is_named(tmp_path, monkeypatch):
    monkeypatch.setenv("S2G_DATA", str(tmp_path))
    with pytest.raises(ValueError, match=r"no mannequin in .*mannequin\.safetensors"):
        mannequin()


def test_another_file_is_refused(tmp_path):
    save_file({"x": np.zeros(3)}, tmp_path / "other.safetensors", metadata={"format": "else/1"})
    with pytest.raises(ValueError, match="format else/1, expected s2glib-mannequin/1"):
        mannequin(tmp_path / "other.safetensors")


def test_a_broken_file_is_refused(tmp_path):
    (tmp_path / "broken.safetensors").write_bytes(b"no tensors here")
    with pytest.raises(ValueError, match="no mannequin"):
        mannequin(tmp_path / "broken.safetensors")


def test_a_body_without_colors_is_not_saved(body, tmp_path):
    plain = BodyModel(body.vertices, body.faces, body.weights, body.joints, body.parents)
    with pytest.raises(ValueError, match="has colors"):
        save_mannequin(plain, tmp_path / "plain.safetensors")
