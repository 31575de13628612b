# ---
# jupyter:
#   s2g: {"id": "02", "minutes": 75, "needs": ["01"], "goals": ["warp a picture by looking backward", "derive and solve the system of a thin-plate spline", "say what bends a plate and what does not", "choose a ridge and say what it costs", "say why a thin region is a bad handle"], "papers": {"MDD": ["A", "E", "Fig. E1"]}, "demos": ["tps pad"], "data": ["shipped"], "budget_s": 25, "exercises": ["02-1", "02-2", "02-3"], "questions": ["02-p1", "02-p2", "02-p3", "02-q1", "02-q2", "02-q3", "02-q4"], "reached": {"warp a picture by looking backward": ["02-p1", "02-q2", "02-3"], "derive and solve the system of a thin-plate spline": ["02-1", "02-2", "02-q1"], "say what bends a plate and what does not": ["02-p2", "02-q3", "tps pad"], "choose a ridge and say what it costs": ["02-p3"], "say why a thin region is a bad handle": ["02-q4"]}}
# ---

# %% [markdown]
# # Thin-plate splines: how do five points bend a whole picture?
#
# | | |
# |---|---|
# | After this you can | warp a picture by looking backward; derive and solve the system of a thin-plate spline; say what bends a plate and what does not; choose a ridge and say what it costs; say why a thin region is a bad handle |
# | You need | [01 Motion and sound](01_motion_and_sound.ipynb) |
# | Time | 45 minutes, and 30 for the exercises |
# | Papers | MDD A (Eqs. A1-A5), E and Fig. E1 |
# | Data | one frame of a clip that comes with the workbook |

# %% tags=["s2g-setup"]
import matplotlib.pyplot as plt
import numpy as np
import torch

from s2glib.teaching import PALETTE, ask, check, figure, report, setup, show_solution

setup("02")

# %% [markdown]
# ## 1. A picture, and a wish
#
# MDD makes one picture of a person gesture. It knows a few *keypoints* in the picture, the **source**, and
# where they should be in the next frame, the **driving** image. What about all the other pixels?

# %% tags=["s2g-figure"]
from s2glib.body import Motion
from s2glib.corpus import appearances, render_frames
from s2glib.data import load_clip
from s2glib.viz import draw_control_points, draw_picture

clip = load_clip("s04-voice_13-anger-t2")
motion = clip.motion
first = Motion(motion.poses[:1], motion.trans[:1], motion.expression[:1], fps=25)
frame = render_frames(first, appearances(clip.speaker)[0], size=256).frames[0]
picture = torch.from_numpy(frame).movedim(-1, 0).double() / 255  # (3, height, width)

source = torch.tensor(
    [[0.05, -0.75], [0.65, 0.15], [-0.65, 0.15], [0.30, 0.95], [-0.30, 0.95]], dtype=torch.float64
)
driving = source + torch.tensor([[0.3, 0.05], [0.1, -0.3], [0, 0.15], [0, 0], [0, 0]])

fig, axes = plt.subplots(figsize=(5.4, 3.8))
draw_control_points(draw_picture(axes, picture.numpy()), driving.numpy(), source.numpy())
axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
figure(
    fig,
    "A speaker of our corpus. The head shall go to the right, one elbow up, the other down; "
    "the hips shall stay.",
)
report(picture=picture.shape, pixels=picture[0].numel(), keypoints=len(source))

# %% [markdown]
# Places are in *image units*: x from -1 at the left to 1 at the right, y from -1 at the top to 1 at the
# bottom. One unit is 127.5 pixels here. Five arrows, 65536 pixels. We need a rule for all of them.
#
# ## 2. Look back, do not carry forward
#
# The obvious way: carry each pixel of the source to its new place. Try it with the simplest rule there is,
# making everything 1.5 times as large. **Predict first.**

# %%
ask("02-p1")

# %% tags=["s2g-figure"]
from s2glib.warping import coordinate_grid, warp_image

pixels = coordinate_grid(256, 256, dtype=torch.float64)  # (height, width, 2): where each pixel is


def look_up(flow):
    """The picture in which each pixel shows the source at the place that the flow names."""
    return warp_image(picture[None], flow[None])[0]


x, y = ((1.5 * pixels + 1) * 127.5).round().long().unbind(-1)  # where each pixel is carried to
inside = (x >= 0) & (x < 256) & (y >= 0) & (y < 256)
carried = torch.zeros_like(picture)
carried[:, y[inside], x[inside]] = picture[:, inside]
hit = torch.zeros(256, 256, dtype=torch.bool)
hit[y[inside], x[inside]] = True

fig, panels = plt.subplots(1, 2, figsize=(6, 3), sharey=True)
for axes, shown, title in zip(
    panels, (carried, look_up(pixels / 1.5)), ("carried forward", "looked up backward"), strict=True
):
    draw_picture(axes, shown[:, 40:140, 80:180].numpy()).set(title=title)
    axes.set(xlabel="x", ylabel="y", xticks=[], yticks=[])
figure(
    fig,
    "A part of the enlarged picture. Carried pixels leave black holes between them; "
    "looking back gives every pixel a colour.",
)
report(share_of_holes=1 - hit.double().mean(), expected=1 - 1 / 1.5**2)

# %% [markdown]
# So every warp in this workbook goes **backward**: for each pixel of the *new* picture it says which point
# of the *source* to show. That is a *sampling grid*, in MDD the *backward optical flow*. Mind the direction:
# to make the picture larger, we divide.
#
# The wish now reads: find a smooth map $\mathcal{T}$ with $\mathcal{T}(p_i^{\mathbf{D}}) = p_i^{\mathbf{S}}$ for
# all five pairs.
#
# ## 3. Six numbers are not enough
#
# An **affine** map is the simplest candidate: an offset, and a matrix that turns, stretches and shears.
# These are six numbers, three for x and three for y. Five pairs want ten. Take the best
# affine map that there is, by least squares:

# %%
ones = torch.ones(len(driving), 1, dtype=torch.float64)
P = torch.cat([ones, driving], dim=1)  # (n, 3): 1, x, y
affine = torch.linalg.lstsq(P, source).solution  # (3, 2)
miss = (P @ affine - source).norm(dim=1)
report(affine=affine, largest_miss_in_pixels=127.5 * miss.max())

# %% [markdown]
# It misses by up to 18 pixels: straight lines stay straight, so head and elbows cannot each go their own way.
# Something must bend.
#
# ## 4. A bent metal plate
#
# Take a thin, flat metal plate, and lay it over the driving image. At each driving point push it up or down,
# to a height that says how far to the right that pixel must look. The plate bends, and between the points
# it finds a shape of its own: the one that takes the least *bending*. A second plate does the same for y.
#
# Here are both, already solved. You will build the three functions that did it.

# %% tags=["s2g-figure"]
from s2glib.warping import ThinPlateSpline, apply_tps, fit_tps, radial_basis

spline = fit_tps(driving, source)
coarse = coordinate_grid(33, 33, dtype=torch.float64)
heights = apply_tps(spline, coarse.flatten(0, 1)).view_as(coarse) - coarse
pushed = source - driving

fig, panels = plt.subplots(1, 2, figsize=(9, 4), subplot_kw={"projection": "3d"})
for k, (axes, name) in enumerate(zip(panels, ("to the right", "down"), strict=True)):
    axes.computed_zorder = False  # draw the dots last
    axes.plot_surface(*coarse.unbind(-1), heights[..., k], cmap="cividis", alpha=0.8)
    axes.scatter(*driving.T, pushed[:, k], color=PALETTE["vermilion"], s=40, depthshade=False)
    axes.set(xlabel="x", ylabel="y", title=f"look this much {name}")
    axes.view_init(elev=25, azim=-60)
    axes.invert_yaxis()
figure(
    fig,
    "The two plates, in image units; dots are the five places where they are held. "
    "Between the dots nothing is prescribed but smoothness.",
)
report(held_exactly=torch.allclose(apply_tps(spline, driving), source))

# %% [markdown]
# As a formula: among all maps that meet the points, take the one for which this integral is smallest, for x and
# for y [MDD A1]:
#
# $$\iint \Bigl(\frac{\partial^2 \mathcal{T}}{\partial x^2}\Bigr)^2 + 2\Bigl(\frac{\partial^2 \mathcal{T}}{\partial x\,\partial y}\Bigr)^2
# + \Bigl(\frac{\partial^2 \mathcal{T}}{\partial y^2}\Bigr)^2 \,dx\,dy$$
#
# Second derivatives measure bends; a flat plate has none, however tilted. The answer can be proved to be an
# affine map plus one bend for each point [MDD A2]:
#
# $$\mathcal{T}(p) = A \begin{bmatrix} 1 \\ p \end{bmatrix} + \sum_{i=1}^N w_i\, U\bigl(\lVert p_i^{\mathbf{D}} - p \rVert\bigr),
# \qquad U(r) = r^2 \log r^2$$
#
# ## 5. What one push does
#
# A push of $w_i$ at a point bends the plate all around it, by $w_i$ times $U$ of the distance.
#
# ### Exercise 02-1: the bend around one point
#
# ●○○ · 6 minutes · [MDD Eq. A2]
#
# Write $U$ as a function of $r^2$, which saves a square root. Log has base $e$. Take care of $r = 0$: there
# the logarithm is minus infinity, but $U$ is 0.
#
# As always, you may skip an exercise: the notebook then goes on with the package's function.


# %% tags=["s2g-exercise"]
def radial_basis(sq_dist):
    """U of squared distances, of any shape."""
    ...  # your code


# %% tags=["s2g-solution"]
def radial_basis(sq_dist):
    """U of squared distances, of any shape."""
    safe = torch.where(sq_dist > 0, sq_dist, 1.0)
    return sq_dist * safe.log()


# %% tags=["s2g-check", "nbval-ignore-output"]
radial_basis = check("02-1", radial_basis)

# %% [markdown]
# Stuck? Click on a hint. The solution is the package's own code.

# %% tags=["s2g-source"]
show_solution("02-1")

# %% [markdown]
# Why just this function? Away from the points nothing pushes the plate, and the shape of least bending
# fulfils $\Delta^2 \mathcal{T} = 0$: the Laplacian, twice. At a point there is a push, a spike. So one bend must
# be a function whose $\Delta^2$ is one spike and nothing else [MDD A3, A4]. Check it with differences between
# neighbours on a grid:

# %% tags=["s2g-figure"]
step = 0.05
square = torch.arange(-20, 21, dtype=torch.float64) * step
U = radial_basis(square[:, None] ** 2 + square**2)


def laplacian(values):
    """Neighbours minus four times the middle, over step squared; one less on each side."""
    around = values[2:, 1:-1] + values[:-2, 1:-1] + values[1:-1, 2:] + values[1:-1, :-2]
    return (around - 4 * values[1:-1, 1:-1]) / step**2


once, twice = laplacian(U), laplacian(laplacian(U))
fig, panels = plt.subplots(1, 3, figsize=(10, 2.8))
curves = {"U": U, "Laplacian of U": once, "Laplacian, twice": twice}
for axes, (name, values) in zip(panels, curves.items(), strict=True):
    cut = len(square) - len(values)
    axes.plot(square[cut // 2 : len(square) - cut // 2], values[len(values) // 2])
    axes.set(title=name, xlabel="distance from the point", ylabel="value")
figure(
    fig,
    "A cut through the middle. U is smooth, its Laplacian dips at the point, "
    "and the Laplacian of that is zero but for one spike.",
)
far = (square[2:-2, None] ** 2 + square[2:-2] ** 2) > 0.25
report(
    spike_times_its_area=twice.sum() * step**2,
    sixteen_pi=16 * np.pi,
    elsewhere_below_a_thousandth_of_the_spike=bool(twice[far].abs().max() < 1e-3 * twice.max()),
)

# %% [markdown]
# The height of the spike times the area of its cell is $16\pi$. The paper says "proportional to" and leaves the factor
# open.
#
# ## 6. How hard must each point push?
#
# For each plate there are $N$ weights and three affine numbers: $N + 3$ unknowns. Meeting the points gives
# $N$ equations. Three more come from the plate itself. Nothing holds it but the points. If all pushes
# together lifted or tilted it, it would go on bending far outside, without end. So
#
# $$\sum_i w_i = 0, \qquad \sum_i w_i x_i = 0, \qquad \sum_i w_i y_i = 0.$$
#
# All together is one linear system [MDD before A5]:
#
# $$L = \begin{bmatrix} K & P \\ P^\top & 0 \end{bmatrix}, \quad
# L \begin{bmatrix} w \\ A^\top \end{bmatrix} = Y = \begin{bmatrix} p^{\mathbf{S}} \\ 0 \end{bmatrix}$$
#
# $K_{ij} = U(r_{ij})$ holds the distances between *driving* points. $P$ has a row $1, x_i, y_i$ for each of them.
# $Y$ has the *source* points, then three rows of zeros. Its two columns are the two plates.
#
# ### Exercise 02-2: solve for the spline
#
# ●●● · 15 minutes · [MDD Eq. A5]
#
# Build $L$ and $Y$, solve, and cut the answer in two. You may leave `ridge` alone: section 9 is about it.


# %% tags=["s2g-exercise"]
def fit_tps(driving, source, *, ridge=0.0):
    """Points (n, 2), both; a ThinPlateSpline(centers, weights (n, 2), affine (3, 2))."""
    ...  # your code


# %% tags=["s2g-solution"]
def fit_tps(driving, source, *, ridge=0.0):
    """Points (n, 2), both; a ThinPlateSpline(centers, weights (n, 2), affine (3, 2))."""
    n = len(driving)
    K = radial_basis((driving[:, None] - driving).square().sum(-1))
    P = torch.cat([torch.ones_like(driving[:, :1]), driving], dim=1)
    L = torch.cat([torch.cat([K, P], 1), torch.cat([P.mT, driving.new_zeros(3, 3)], 1)])
    Y = torch.cat([source, source.new_zeros(3, 2)])
    solution = torch.linalg.solve(L + ridge * torch.eye(n + 3, dtype=L.dtype), Y)
    return ThinPlateSpline(driving, solution[:n], solution[n:])


# %% tags=["s2g-check", "nbval-ignore-output"]
fit_tps = check("02-2", fit_tps)

# %% tags=["s2g-source"]
show_solution("02-2")

# %%
spline = fit_tps(driving, source)
report(
    pushes_to_the_right=spline.weights[:, 0],
    pushes_down=spline.weights[:, 1],
    no_lift=torch.allclose(spline.weights.sum(0), torch.zeros(2, dtype=torch.float64)),
    no_tilt=torch.allclose(driving.mT @ spline.weights, torch.zeros(2, 2, dtype=torch.float64)),
    affine=spline.affine,
)

# %% [markdown]
# ## 7. Bend the picture
#
# ### Exercise 02-3: move any point
#
# ●●○ · 9 minutes · [MDD Eq. A2]
#
# The pushes are known, so the formula of section 4 gives the map of *any* point. The rows of
# `spline.affine` are the offset, then what x adds, then what y adds.


# %% tags=["s2g-exercise"]
def apply_tps(spline, points):
    """Where the spline takes points, (m, 2) to (m, 2)."""
    ...  # your code


# %% tags=["s2g-solution"]
def apply_tps(spline, points):
    """Where the spline takes points, (m, 2) to (m, 2)."""
    U = radial_basis((points[:, None] - spline.centers).square().sum(-1))
    return spline.affine[0] + points @ spline.affine[1:] + U @ spline.weights


# %% tags=["s2g-check", "nbval-ignore-output"]
apply_tps = check("02-3", apply_tps)

# %% tags=["s2g-source"]
show_solution("02-3")

# %% [markdown]
# Now ask every pixel where to look. Is the answer right? SciPy solves the same problem in its own way:

# %%
from scipy.interpolate import RBFInterpolator

flow = apply_tps(spline, pixels.flatten(0, 1)).view_as(pixels)
places = pixels.flatten(0, 1).numpy()
theirs = RBFInterpolator(driving.numpy(), source.numpy(), kernel="thin_plate_spline", degree=1)
report(
    pixels_that_look_somewhere=len(places),
    meets_every_point=torch.allclose(apply_tps(spline, driving), source, atol=1e-12),
    agrees_with_scipy_at_all_pixels=np.allclose(theirs(places), flow.flatten(0, 1), atol=1e-9),
)

# %% tags=["s2g-figure"]
from s2glib.viz import draw_carried_grid, draw_flow

fig, panels = plt.subplots(1, 2, figsize=(8, 3.8), sharey=True)
draw_carried_grid(draw_picture(panels[0], look_up(flow).numpy()), flow.numpy())
draw_control_points(panels[0], driving.numpy(), source.numpy())
draw_flow(panels[1], flow.numpy(), every=32)
panels[0].set(title="the bent picture")
panels[1].set(title="where each pixel looks", ylabel="")
figure(
    fig,
    "Head, elbows and hips are where they should be. The lines were straight in the source. "
    "Right: the backward flow; its arrows run against the movement.",
)

# %% [markdown]
# The wish is granted. But look at the clock: it moved, too, and black corners show where the picture had
# nothing to look at. A plate is stiff, so five points bend the whole room. MDD therefore mixes *twenty* such
# splines with a map that does nothing, each where it fits (notebook 03).
#
# ## 8. What costs energy?
#
# **Predict first**, then run the cell below.

# %%
ask("02-p2")

# %%
from s2glib.warping import bending_energy

turned = driving.flip(-1) * torch.tensor([-1.0, 1.0], dtype=torch.float64)
report(
    our_bend=bending_energy(spline),
    twice_as_far=bending_energy(fit_tps(driving, driving + 2 * (source - driving))),
    a_quarter_turn_is_flat=bool(bending_energy(fit_tps(driving, turned)).abs() < 1e-9),
)

# %% [markdown]
# A turn is free, as is any affine map. Twice the pull costs four times the energy, as in a spring. The package
# computes it without an integral, from the weights: $16\pi \sum_{ij} w_i^\top w_j\, U(r_{ij})$. Is that really the
# integral of A1? And is it the smallest? Ask rivals that meet the same five points:

# %%
step = 0.02
wide = torch.arange(-4, 4 + step / 2, step, dtype=torch.float64)
field = torch.cartesian_prod(wide, wide).numpy()


def measured_energy(move):
    """The integral of A1 over a square of 8 x 8 image units, from differences."""
    values = torch.from_numpy(move(field)).view(len(wide), len(wide), 2)
    xx, yy = (values.diff(n=2, dim=axis) / step**2 for axis in (0, 1))
    xy = values.diff(dim=0).diff(dim=1) / step**2
    return ((xx**2).sum() + 2 * (xy**2).sum() + (yy**2).sum()) * step**2


rivals = {
    "cubic": RBFInterpolator(driving.numpy(), source.numpy(), kernel="cubic", degree=1),
    "bumps": RBFInterpolator(
        driving.numpy(), source.numpy(), kernel="gaussian", epsilon=1, degree=1
    ),
}
by_integral = measured_energy(theirs)
report(
    from_the_weights=bending_energy(spline),
    by_the_integral=by_integral,
    **{f"rival: {name}": measured_energy(rival) for name, rival in rivals.items()},
)

# %% [markdown]
# The integral comes close from below, since the plate goes on beyond the square. Both rivals
# meet the points as well, and bend more.
#
# ## 9. When points coincide: the ridge
#
# Keypoints come from a network. Nothing keeps two of them apart. **Predict first.**

# %%
ask("02-p3")

# %%
from s2glib import warping

clash = driving.clone()
clash[1] = clash[0]  # the elbow is driven onto the head
try:
    warping.fit_tps(clash, source)
except ValueError as error:
    print(error)
halfway = source[:2].mean(dim=0)
torn = warping.apply_tps(warping.fit_tps(clash, source, ridge=0.01), clash[:1])[0]
report(
    with_a_ridge_it_is_finite=bool(torn.isfinite().all()),
    pixels_from_halfway_between_the_two=127.5 * (torn - halfway).norm(),
)

# %% [markdown]
# (From here on we take the package's own functions, which refuse what has no answer.)
#
# The authors' code adds 0.01 to the whole diagonal of $L$, a **ridge**. Now $L$ has an inverse, and the two
# pulls on one place meet halfway. The price: the first rows of the system read $(K + \text{ridge})\, w + P A^\top = p^{\mathbf{S}}$, so
# each point is missed by *ridge times its push*.
#
# But the whole diagonal has zeros, too, those of the side conditions. The textbook leaves them alone; this
# is SciPy's `smoothing`. Compare the two:


# %% tags=["s2g-figure"]
def everywhere(ridge):
    """The spline with a ridge on the whole diagonal, as released."""
    fitted = warping.fit_tps(driving, source, ridge=ridge)
    return lambda points: warping.apply_tps(fitted, points)


def on_pushes(ridge):
    """The spline with a ridge on K only; SciPy's kernel is half of U."""
    fitted = RBFInterpolator(
        driving, source, smoothing=ridge / 2, kernel="thin_plate_spline", degree=1
    )
    return lambda points: torch.from_numpy(fitted(points.numpy()))


def largest_miss(move):
    """In pixels, over the five points."""
    return 127.5 * (move(driving) - source).norm(dim=1).max().item()


ridges = torch.logspace(-4, 0, 41).tolist()
kinds = {"whole diagonal": everywhere, "K only": on_pushes}
fig, (plot, *panels) = plt.subplots(1, 3, figsize=(11, 3.4), width_ratios=[1.3, 1, 1])
for (name, kind), panel, stroke in zip(kinds.items(), panels, ("-", "--"), strict=True):
    plot.loglog(ridges, [largest_miss(kind(ridge)) for ridge in ridges], stroke, label=name)
    bent = look_up(kind(1.0)(pixels.flatten(0, 1)).view_as(pixels))
    draw_control_points(draw_picture(panel, bent.numpy()), driving.numpy(), source.numpy())
    panel.set(title=f"ridge 1, {name}", yticks=[])
plot.axvline(0.01, color=PALETTE["black"], linestyle=":", label="as released")
plot.set(xlabel="ridge", ylabel="largest miss (pixels)")
plot.legend(fontsize=10)
figure(
    fig,
    "Small ridges do the same on the whole diagonal and on K. A large one on K makes the map nearly "
    "affine; on the whole diagonal it tears the picture apart.",
)
released = warping.fit_tps(driving, source, ridge=0.01)
misses = source - warping.apply_tps(released, driving)
report(
    miss_is_ridge_times_push=torch.allclose(misses, 0.01 * released.weights, atol=1e-9),
    **{
        "pixels missed at 0.01": largest_miss(everywhere(0.01)),
        "pixels missed at 1": largest_miss(everywhere(1.0)),
        "pixels missed at 1, K only": largest_miss(on_pushes(1.0)),
        "sum of the pushes at 0.01": released.weights.sum(0),
    },
)

# %% [markdown]
# The released 0.01 costs a seventh of a pixel here, which learned keypoints can make up for. On K only, a
# growing ridge smooths until the affine map of section 3 is left. On the whole diagonal it also holds back the
# affine part, and the pushes no longer sum to zero. Small is safe; large is not smooth but wrong.
#
# ## 10. Break it: an affine map from a thin region
#
# The rival of splines in MDD's ablation is **MRAA**. It sums up a region of the body, say a forearm, by the mean
# and the *covariance* of its pixels, and gets an affine map from these two. But an arm is thin. MDD found
# that predicted covariances turn *near-singular*, and that the pictures fill with ghosts [MDD E, Fig. E1].
#
# Watch it happen: let a network predict the forearm a little too thin.

# %% tags=["s2g-figure"]
from s2glib.viz import draw_heatmap
from s2glib.warping import Region, condition_number, fit_region_affine, region_heatmap

LONG, WIDE, ERROR = 0.16, 0.03, 0.025  # spread along and across the arm, image units
mean = torch.tensor([0.56, 0.33], dtype=torch.float64)
turn = torch.tensor([[-0.39, 0.92], [0.92, 0.39]], dtype=torch.float64)  # along and across


def arm(width):
    """The arm's region, if it spreads so far across."""
    spread = torch.tensor([LONG, width], dtype=torch.float64)
    return Region(mean, turn @ spread.square().diag() @ turn)


angles = torch.arange(6, dtype=torch.float64) * torch.pi / 3
outline = mean + 2 * torch.stack([angles.cos() * LONG, angles.sin() * WIDE], dim=1) @ turn


def region_strays(error):
    """How far the outline goes astray, in pixels, if the region is predicted too thin."""
    affine = fit_region_affine(arm(WIDE - error), arm(WIDE))
    return 127.5 * (warping.apply_affine(affine, outline) - outline).norm(dim=1).max().item()


def keypoint_strays(error):
    """The same for a spline through six keypoints, if one is as far off."""
    off = outline.clone()
    off[0] += error * turn[1]
    moved = warping.apply_tps(warping.fit_tps(off, outline), outline)
    return 127.5 * (moved - outline).norm(dim=1).max().item()


errors = np.linspace(0, ERROR, 26)
fig, (*panels, plot) = plt.subplots(1, 3, figsize=(11, 3.4), width_ratios=[1, 1, 1.3])
for panel, width in zip(panels, (WIDE, WIDE - ERROR), strict=True):
    draw_heatmap(panel, picture.numpy(), region_heatmap(arm(width), 256, 256).numpy())
    panel.set(
        title=f"width {width:.3f}", xlim=(0.1, 1), ylim=(0.8, -0.1), xticks=[0.5], yticks=[0.5]
    )
plot.plot(errors, [region_strays(e) for e in errors], label="region")
plot.plot(errors, [keypoint_strays(e) for e in errors], "--", label="keypoints")
plot.set(xlabel="error (image units)", ylabel="goes astray by (pixels)")
plot.legend()
figure(
    fig,
    "A forearm as a region: as it is, and predicted too thin, which makes it a needle. "
    "Right: what the same error does in a region's width and in one keypoint.",
)
report(
    condition_of_the_arm=condition_number(arm(WIDE).covariance),
    condition_of_the_needle=condition_number(arm(WIDE - ERROR).covariance),
    region_strays_by_pixels=region_strays(ERROR),
    keypoint_strays_by_pixels=keypoint_strays(ERROR),
)

# %% [markdown]
# The *condition number* is the largest variance over the smallest. The map divides by the predicted width, so it
# runs away as this nears zero. A spline does not divide by its points: what is wrong by 3 pixels goes astray by
# about 3 (unless two of them nearly meet, see section 9). And what is little for a network, 0.025, is most of an
# arm's width.
#
# ## 11. Bend it yourself
#
# The pad has our five points. First, does it do what we think?

# %%
from s2glib.widgets import TPSPad

pad = TPSPad(source, picture=picture)
at_rest = bending_energy(pad.spline)
for index, (x, y) in enumerate(driving.tolist()):
    pad.move(index, x, y)
report(
    flat_at_first=bool(at_rest.abs() < 1e-12),
    same_spline_as_ours=torch.allclose(pad.spline.weights, spline.weights, atol=1e-9),
)

# %% tags=["s2g-figure"]
pad.reset()
pad.move(0, 0.05, -0.2)  # push the head down
fig, axes = plt.subplots(figsize=(4, 3.6))
pad.draw(axes)
figure(
    fig,
    "The pad as it looks when the head is pushed down. "
    "See how far above the head the picture still moves.",
)
report(bending_energy=bending_energy(pad.spline))

# %% [markdown]
# Now drag the numbered handles; or press Tab to choose one and the arrow keys to move it.

# %% tags=["s2g-demo"]
pad.reset()
pad

# %% [markdown]
# Three things to try:
#
# <details><summary>1. Move all five handles to the right, equally far. What bends?</summary>
#
# Nothing: while you are on the way the lines bend, but as soon as all five agree they are straight again.
# </details>
#
# <details><summary>2. Drag the head down to the hips. Can you fold the speaker?</summary>
#
# Yes. Between head and hips the picture turns over, and some of it is seen twice. A spline
# is smooth, but nothing keeps it from folding.
# </details>
#
# <details><summary>3. Drag one handle onto another. Then run <code>pad.ridge = 0.01</code> in a new cell and do it again.</summary>
#
# Without a ridge the picture goes wild before the two meet, and where they meet the pad says that there is no
# plate. With it, the place shows a point between the two, and the rest stays calm.
# </details>
#
# ## 12. Twenty splines at once
#
# MDD needs 20 splines for each frame. `fit_tps` solves them together: leading axes are a batch. For whole
# pictures there is `tps_grid`. It knows that pixels stand in rows and columns, so that a squared distance is a
# part for the column plus a part for the row.

# %%
from time import process_time
from timeit import repeat

many = 2 * torch.rand(2, 20, 5, 2, dtype=torch.float64) - 1
splines = warping.fit_tps(*many)
jobs = {
    "grid": lambda: warping.tps_grid(splines, 256, 256),
    "points": lambda: warping.apply_tps(splines, pixels.flatten(0, 1)),
}
spent = {
    name: min(repeat(job, number=1, repeat=3, timer=process_time)) for name, job in jobs.items()
}
report(
    grids=jobs["grid"]().shape,
    same_places=torch.allclose(jobs["grid"]().flatten(1, 2), jobs["points"](), atol=1e-9),
    the_grid_is_faster_than_single_points=spent["grid"] < spent["points"],
)

# %% [markdown]
# ## 13. Paper check
#
# One more number: the paper multiplies $A$ with $(x, y, 1)$ in A2, but gives $P$ the columns $1, x, y$. Take
# both literally:

# %%
A, w = spline.affine.mT, spline.weights
bends = radial_basis((driving[:, None] - driving).square().sum(-1)) @ w
printed = torch.cat([driving, ones], dim=1) @ A.mT + bends
mended = torch.cat([ones, driving], dim=1) @ A.mT + bends
report(
    miss_as_printed_in_pixels=127.5 * (printed - source).norm(dim=1).max(),
    meets_all_points_with_the_one_in_front=torch.allclose(mended, source),
)

# %% [markdown]
# | claim [MDD A, E] | what we computed | verdict |
# |---|---|---|
# | $\mathcal{T}$ meets all points [A1] | it does, to rounding; with the released ridge of 0.01 it misses by 0.15 pixels | holds; the released code only nearly |
# | nothing bends less [A1] | 2.26; two rivals 3.06 and 3.49 | holds against these |
# | $\Delta^2 U \propto \delta$ [A3, A4] | a spike of $16\pi$ | holds |
# | $A\,[p; 1]$ [A2] with $P = [1, x, y]$ | 221 pixels off | **does not fit**: one of the two orders must change |
# | $L^{-1} Y$ [A5] | no inverse if points coincide or lie on one line | needs a ridge or well-placed points; the text names neither |
# | near-singular $\Sigma$ spoils heatmaps and flow [E] | condition 28 becomes 1020; 79 pixels astray instead of 3 | plausible; we showed the cause, not their network |
#
# ## 14. Check yourself

# %%
ask("02-q1")

# %%
ask("02-q2")

# %%
ask("02-q3")

# %%
ask("02-q4")

# %% [markdown]
# And one without an answer: where on *your* body would you put five keypoints, if they had to explain every
# gesture?
#
# ## Summary
#
# - Warps look backward: each new pixel asks where it comes from, and no hole is left.
# - A thin-plate spline is an affine map plus one bend for each point; nothing that meets the points bends less.
# - Fitting it is one linear system: meet the points, and neither lift nor tilt the plate.
# - Affine maps cost no energy; pulls cost their square.
# - A small ridge saves the day when points coincide, and misses each point by ridge times push.
# - Points are safer handles than the covariance of a thin region.
#
# **Limits.** We chose the keypoints by hand; MDD learns them (notebook 03). One spline bends everything, the room
# too. It cannot show what the source hides, such as the inside of a closed hand (notebook 04). And it may fold.
#
# **Back:** [01 Motion and sound](01_motion_and_sound.ipynb). **Next:** notebook 03 mixes many warps, and learns
# where their points should be.
