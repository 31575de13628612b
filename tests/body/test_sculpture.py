import numpy as np
import pytest
import trimesh

from s2glib.body.sculpture.solids import Solid, join, loft, mirror, profile, ring, smooth, tube

X, Y, Z = np.eye(3)


def ball(center, radius: float) -> Solid:
    mesh = trimesh.creation.icosphere(subdivisions=3, radius=radius)
    return Solid(mesh.vertices + np.array(center), np.asarray(mesh.faces))


def mesh_of(solid) -> trimesh.Trimesh:
    return trimesh.Trimesh(solid.vertices, solid.faces, process=False)


def test_a_loft_of_equal_rings_is_a_prism():
    rings = [ring((0.0, y, 0.0), 2 * Z, X, sides=200) for y in (0.0, 1.0, 3.0)]
    mesh = mesh_of(loft(np.stack(rings)))
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(3 * np.pi * 2, rel=1e-3)


def test_a_tube_stands_across_its_path():
    path = np.stack([np.linspace(0, 2, 9), np.zeros(9), np.zeros(9)], 1)
    mesh = mesh_of(tube(path, np.tile([0.3, 0.5], (9, 1)), second=Z, sides=100))
    np.testing.assert_allclose(mesh.extents, [2, 0.6, 1.0], atol=1e-3)
    assert mesh.volume == pytest.approx(2 * np.pi * 0.15, rel=2e-3)


def test_a_profile_goes_through_its_table_and_does_not_overshoot():
    table = np.array([[0.0, 1.0], [1.0, 1.0], [2.0, 5.0], [3.0, 5.0]])
    values = profile(table, np.linspace(0, 3, 301))[:, 0]
    np.testing.assert_allclose(values[::100], [1, 1, 5, 5])
    assert values.min() >= 1
    assert values.max() <= 5


def test_a_union_has_the_volume_of_both_balls_less_their_lens():
    surface = join([ball((0, 0, 0), 1.0), ball((0, 1, 0), 1.0)], shortest=0.0)
    lens = 5 * np.pi / 12  # pi (4 + d) (2 - d)^2 / 12 for unit balls at the distance d = 1
    mesh = mesh_of(surface)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(8 * np.pi / 3 - lens, rel=0.02)


def test_seam_vertices_belong_to_both_parts():
    surface = join([ball((0, 0, 0), 1.0), ball((0, 1, 0), 1.0)], shortest=0.0)
    on_seam = surface.membership.all(1)
    assert on_seam.any()
    np.testing.assert_allclose(surface.vertices[on_seam, 1], 0.5, atol=0.02)
    assert surface.membership.any(1).all()


def test_welding_removes_short_edges_and_keeps_the_surface_closed():
    parts = [ball((0, 0, 0), 1.0), ball((0.02, 1, 0.01), 1.0)]
    raw, welded = (mesh_of(join(parts, shortest=shortest)) for shortest in (0.0, 0.04))
    assert welded.is_watertight
    assert len(welded.vertices) < len(raw.vertices)
    assert welded.volume == pytest.approx(raw.volume, rel=0.01)


def test_a_part_given_on_the_left_appears_on_the_right_too():
    surface = join([ball((0, 0, 0), 1.0), ball((1.0, 0, 0), 0.5)], shortest=0.0)
    mirrored = surface.vertices * (-1, 1, 1)
    distance = np.linalg.norm(surface.vertices[:, None] - mirrored[None], axis=-1).min(0)
    assert distance.max() == 0
    assert surface.vertices[:, 0].min() == pytest.approx(-1.5, abs=1e-3)


def test_crumbs_that_touch_nothing_are_dropped():
    surface = join([ball((0, 0, 0), 1.0), ball((0, 3, 0), 0.1)], shortest=0.0)
    assert surface.vertices[:, 1].max() <= 1.0 + 1e-6


def test_mirroring_closes_half_a_tetrahedron():
    vertices = np.array([[0, 0, 0], [0, 1, 0], [0, 0, 1], [1.0, 0, 0]])
    half = Solid(vertices, np.array([[0, 3, 2], [0, 1, 3], [1, 2, 3]]))
    mesh = mesh_of(mirror(half))
    assert mesh.is_watertight
    assert abs(mesh.volume) == pytest.approx(1 / 3)


def test_smoothing_pulls_only_where_it_should():
    solid = ball((0, 0, 0), 1.0)
    values = solid.vertices[:, 1:2]
    amount = (solid.vertices[:, 0] > 0).astype(float)
    pulled = smooth(values, solid.faces, amount, rounds=3)
    assert (pulled[amount == 0] == values[amount == 0]).all()
    assert np.abs(pulled[amount == 1]).max() < np.abs(values[amount == 1]).max()
    ones = np.ones_like(values)
    np.testing.assert_allclose(smooth(ones, solid.faces, amount, rounds=5), ones)
