"""Warping: thin-plate splines, affine maps, sampling grids, flows and random deformations."""

from s2glib.warping.affine import (
    Region,
    apply_affine,
    cholesky_root,
    condition_number,
    fit_region_affine,
    invert_affine,
    principal_root,
    region_heatmap,
    region_of_heatmap,
    region_of_points,
)
from s2glib.warping.flow import (
    combine_flows,
    compose_flows,
    cycle_error,
    identity_flow,
    resize_flow,
    warp_features,
    warp_with_each,
    weight_maps,
    with_identity,
)
from s2glib.warping.grids import coordinate_grid, gaussian_heatmap, warp_image
from s2glib.warping.random_warps import random_affine, random_tps, undo_tps
from s2glib.warping.tps import (
    ThinPlateSpline,
    apply_tps,
    bending_energy,
    fit_tps,
    radial_basis,
    tps_grid,
)

__all__ = [
    "Region",
    "ThinPlateSpline",
    "apply_affine",
    "apply_tps",
    "bending_energy",
    "cholesky_root",
    "combine_flows",
    "compose_flows",
    "condition_number",
    "coordinate_grid",
    "cycle_error",
    "fit_region_affine",
    "fit_tps",
    "gaussian_heatmap",
    "identity_flow",
    "invert_affine",
    "principal_root",
    "radial_basis",
    "random_affine",
    "random_tps",
    "region_heatmap",
    "region_of_heatmap",
    "region_of_points",
    "resize_flow",
    "tps_grid",
    "undo_tps",
    "warp_features",
    "warp_image",
    "warp_with_each",
    "weight_maps",
    "with_identity",
]
