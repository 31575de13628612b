# ---
# jupyter:
#   s2g: {"id": "03", "minutes": 76, "needs": ["02"], "goals": ["say how motion and looks are kept apart without labels", "mix many warps into one flow", "read an occlusion mask and say what is painted", "write the losses that find keypoints, and say what each asks for", "say why thin regions make bad handles", "judge keypoints and films where the truth is known"], "papers": {"MDD": ["B.1", "B.5", "E", "Fig. E1"]}, "demos": ["mask mixer"], "data": ["shipped"], "budget_s": 25, "exercises": ["03-1", "03-2", "03-3", "03-4"], "questions": ["03-p1", "03-p2", "03-p3", "03-q1", "03-q2", "03-q3"], "reached": {"say how motion and looks are kept apart without labels": ["03-p1", "03-q3"], "mix many warps into one flow": ["03-1", "03-2", "03-p2", "mask mixer"], "read an occlusion mask and say what is painted": ["03-3", "03-q1"], "write the losses that find keypoints, and say what each asks for": ["03-4", "03-q2"], "say why thin regions make bad handles": ["03-p3"], "judge keypoints and films where the truth is known": ["03-q3"]}}
# ---

# %% [markdown]
# # Decoupling motion from looks: how can a network find what moves, if nobody tells it?
#
# | | |
# |---|---|
# | After this you can | say how motion and looks are kept apart without labels; mix many warps into one flow; read an occlusion mask; write the three losses; say why thin regions make bad handles; judge keypoints where the truth is known |
# | You need | [02 Thin-plate splines](02_thin_plate_splines.ipynb) |
# | Time | 45 minutes, and 31 for the exercises |
# | Papers | MDD B.1 (Eqs. B6-B9), B.5, E and Fig. E1 |
# | Data | films of shipped clips, which the networks have never seen |

# %% tags=["s2g-setup"]
import matplotlib.pyplot as plt
import numpy as np
import torch

from s2glib.teaching import PALETTE, ask, check, figure, report, setup, show_solution

setup("03")

# %% [markdown]
# ## 1. Two things in every picture
#
# A film shows how somebody looks and how they move, both at once. Speech says much about the second and
# nothing about the first. **Predict** how large each is.

# %%
ask("03-p1")

# %% tags=["s2g-figure"]
from s2glib.corpus import KEYPOINT_NAMES, Part, appearances, render_video
from s2glib.data import load_clip
from s2glib.viz import draw_films

clip = load_clip("s04-voice_13-anger-t2")
LOOKS = {name: appearances(name)[0] for name in ("voice_01", "voice_03", "voice_05", "voice_13")}
FPS = 10  # the paper has 25; fewer save time
WRISTS = [KEYPOINT_NAMES.index(f"{side}_wrist") for side in ("left", "right")]


def pictures(video):
    """Frames as floats, (frames, 3, height, width)."""
    return torch.from_numpy(video.frames).movedim(-1, 1).float() / 255


video = render_video(clip, LOOKS["voice_13"], size=64, fps=FPS)
film = pictures(video)
double = pictures(render_video(clip, LOOKS["voice_05"], size=64, fps=FPS))  # the same motion
source, driving = film[:1], film[14:15]

fig, axes = plt.subplots(figsize=(5.8, 5))
draw_films(axes, {"one": film, "another": double}, FPS, (0, 1.4))
figure(
    fig,
    "Two moments of a gesture, by two speakers: the motion is the same, the looks are not.",
    exact=False,
)
report(
    another_pose=(driving - source).abs().mean(),
    another_speaker=(double[0] - source).abs().mean(),
    gestured_pixels_are_fewer_than_a_third=bool(
        ((driving - source).abs().amax(1) > 0.1).float().mean() < 1 / 3
    ),
)

# %% [markdown]
# So MDD splits the two. Its **motion decoupling module** gets two pictures of one film, a *source* $\mathbf{S}$ and a
# *driving* picture $\mathbf{D}$, and has to rebuild $\mathbf{D}$. The trick is what it may use:
#
# 1. A **keypoint predictor** finds $K \times N$ points in each of the two.
# 2. Each group of $N$ pairs gives a thin-plate spline: $K$ warps.
# 3. A **flow predictor** mixes them, pixel by pixel, and says which pixels the source cannot show.
# 4. A **synthesis network** bends the source, hides those pixels, and paints them.
#
# From $\mathbf{D}$ only points get through. They have no room for wallpaper, so all looks must come from
# $\mathbf{S}$. And if the points do not say where the arms are, $\mathbf{D}$ cannot be rebuilt. Nobody labels anything.
#
# ## 2. What it found, and what it was told
#
# Left, keypoints learned just so, in an hour and a half on one core. They wander with the speaker but spread over the whole
# body, and no warp learned to carry a forearm. So the model that we use from here on got a help that the paper's did
# not: our films know where shoulders, wrists and fingertips are. For one minute its predictor was shown points on eight **limbs**. Then
# it trained as the paper's does.

# %% tags=["s2g-figure"]
from s2glib.checkpoint import load_checkpoint
from s2glib.folders import data_folder
from s2glib.papers.mddiffusion import PAPER_DECOUPLING, KeypointPredictor, MDDiffusion
from s2glib.recipes.mddiffusion_decoupling import LESSONS
from s2glib.recipes.mddiffusion_unlabelled import LESSON as UNTOLD
from s2glib.viz import draw_keypoint_groups, draw_picture

shipped = data_folder() / "checkpoints"
model = MDDiffusion.load(shipped).decoupler
untold = load_checkpoint(shipped / "mddiffusion-unlabelled.safetensors", KeypointPredictor)
with torch.no_grad():
    made, wandering = model(source, driving), untold(driving)
flow = made.flow


def bare(panels, titles):
    """Panels without axes, with titles."""
    for axes, title in zip(np.ravel(panels), titles, strict=True):
        axes.set_axis_off()
        axes.set(title=title, xlim=(-1.02, 1.02), ylim=(1.02, -1.02))


fig, panels = plt.subplots(1, 5, figsize=(14, 3.1))
pairs = (driving, wandering), (source, made.source_keypoints), (driving, made.driving_keypoints)
for axes, (image, points) in zip(panels, pairs, strict=False):
    draw_keypoint_groups(axes, image[0].numpy(), points[0].numpy())
for axes, image in zip(panels[3:], (made.synthesis.image, driving), strict=True):
    draw_picture(axes, image[0].numpy())
titles = ("driving, never told", "source", "driving", "driving, rebuilt", "for comparison")
bare(panels, titles)
figure(
    fig,
    "Real keypoints on a film that the networks have not seen; a colour and shape is a group of five. "
    "Fourth: what was made of the source and the moved points.",
    exact=False,
)
config = model.config


def nearest(points, frame):
    """Pixels from each wrist to the nearest keypoint."""
    wrists = torch.from_numpy(video.keypoints[frame][WRISTS]).float()
    return 31.5 * torch.cdist(wrists, points.flatten(0, 1)).amin(1)


report(
    numbers_in_the_driving_picture=driving.numel(),
    numbers_that_pass=made.driving_keypoints.numel(),
    in_the_papers_size=(
        3 * PAPER_DECOUPLING.size**2,
        2 * PAPER_DECOUPLING.transforms * config.points,
    ),
    steps_of_training_never_told_and_told=(UNTOLD.course.steps, LESSONS["teaching"].course.steps),
    told_points_are_nearer_to_the_wrists=bool(
        nearest(made.driving_keypoints[0], 14).mean() < nearest(wandering[0], 14).mean()
    ),
    a_hand_is_so_many_pixels_wide=round(float(np.sqrt(video.hand_mask.sum((1, 2)).mean() / 2))),
)

# %% [markdown]
# The paper has 256 pixels and $K = 20$ groups of $N = 5$; this one has 64 pixels and $K = 8$, so that it trains on a
# laptop: upper arm, forearm and hand of both sides, trunk and head.
#
# ## 3. Eight warps, each alone
#
# Each group does what you did in notebook 02: five pairs, one spline. Mind the ridge. It pulls the whole warp to zero, and
# zero is the middle of the picture: groups that are close together bend even a picture at rest. So ours fits
# how far points *move*, $\mathbf{x}_S - \mathbf{x}_D$, and adds that to the place. Then the ridge pulls to no motion at all.

# %% tags=["s2g-figure"]
from s2glib.warping import apply_tps, coordinate_grid, fit_tps, warp_features, warp_image

pixels = coordinate_grid(32, 32)  # the flow has half as many pixels
now, before = made.driving_keypoints, made.source_keypoints
moves = apply_tps(fit_tps(now, before - now, ridge=config.ridge), pixels.flatten(0, 1))
warps = pixels + moves.unflatten(2, (32, 32))
at_rest = apply_tps(fit_tps(now, now, ridge=0.01), pixels.flatten(0, 1))  # as released
fig, panels = plt.subplots(1, 5, figsize=(11, 2.6))
LIMBS = {"upper arm": 0, "forearm": 1, "head": 7}
for k, axes in zip(LIMBS.values(), panels[1:-1], strict=True):
    draw_picture(axes, warp_features(source, warps[:, k])[0].numpy())
    axes.plot(*made.driving_keypoints[0, k].T, ".", color=PALETTE["vermilion"])
draw_picture(panels[0], source[0].numpy())
draw_picture(panels[-1], driving[0].numpy())
bare(panels, ("source", *(f"{limb} alone" for limb in LIMBS), "driving"))
figure(
    fig,
    "The source as the splines of three groups of its left show it. Dots are the five driving points. "
    "Each warp moves everything; none is right everywhere.",
    exact=False,
)
report(
    warps_of_the_background_and_eight_groups=flow.warps.shape,
    same_as_the_package=torch.allclose(warps, flow.warps[:, 1:], atol=1e-4),
    the_background_stands_still=bool((flow.warps[0, 0] == pixels).all()),
    the_released_ridge_bends_a_picture_at_rest=bool(
        (at_rest.unflatten(2, (32, 32)) - pixels).abs().max() > 0.1
    ),
)

# %% [markdown]
# ## 4. Which warp where?
#
# The flow predictor looks at the nine copies and at where the keypoints went. For each pixel it gives each warp a
# score. A softmax makes **weight maps** of the scores:
#
# $$m_k(p) = \frac{e^{s_k(p)}}{\sum_{j=0}^{K} e^{s_j(p)}}, \qquad \tilde{\mathcal{T}}(p) = \sum_{k=0}^{K} m_k(p)\, \mathcal{T}_k(p)$$
#
# Here $p$ is a pixel, and $\mathcal{T}_k(p)$ the place where warp $k$ looks. Number 0 is the background, which stands still.
#
# ### Exercise 03-1: from scores to weights
#
# ●○○ · 4 minutes · [MDD B.5]
#
# The warps are axis -3, a batch may stand in front. Leave `dropout` alone: section 7 is about it.


# %% tags=["s2g-exercise"]
def weight_maps(logits, *, dropout=0.0, generator=None):
    """Scores (..., k, height, width) to weights of the same shape."""
    ...  # your code


# %% tags=["s2g-solution"]
def weight_maps(logits, *, dropout=0.0, generator=None):
    """Scores (..., k, height, width) to weights of the same shape."""
    return logits.softmax(dim=-3)


# %% tags=["s2g-check", "nbval-ignore-output"]
weight_maps = check("03-1", weight_maps)

# %% [markdown]
# Stuck? Open a hint. The solution is the package's own code.

# %% tags=["s2g-source"]
show_solution("03-1")

# %% [markdown]
# ### Exercise 03-2: many warps, one flow
#
# ●○○ · 5 minutes · [MDD B.5]
#
# The right-hand formula. Warps are places to look at, (..., k, height, width, 2).


# %% tags=["s2g-exercise"]
def combine_flows(flows, weights):
    """The weighted mean of k warps at every pixel: (..., height, width, 2)."""
    ...  # your code


# %% tags=["s2g-solution"]
def combine_flows(flows, weights):
    """The weighted mean of k warps at every pixel: (..., height, width, 2)."""
    return (weights[..., None] * flows).sum(-4)


# %% tags=["s2g-check", "nbval-ignore-output"]
combine_flows = check("03-2", combine_flows)

# %% tags=["s2g-source"]
show_solution("03-2")

# %% [markdown]
# Why mix flows, not pictures? **Predict**, for a stripe and two warps that disagree.

# %%
ask("03-p2")

# %% tags=["s2g-figure"]
stripe = torch.full((1, 3, 64, 64), 0.9)
stripe[..., 28:36] = torch.tensor([0.0, 0.45, 0.7]).view(3, 1, 1)
aside, places = torch.tensor([0.4, 0.0]), coordinate_grid(64, 64)
two = torch.stack([places - aside, places + aside])[None]
half = torch.full((1, 2, 64, 64), 0.5)
mixed_pictures = sum(warp_image(stripe, two[:, k], padding="border") for k in range(2)) / 2
mixed_flows = warp_image(stripe, combine_flows(two, half))

fig, panels = plt.subplots(1, 3, figsize=(8, 2.9))
for axes, image in zip(panels, (stripe, mixed_pictures, mixed_flows), strict=True):
    draw_picture(axes, image[0].numpy())
bare(panels, ("source", "pictures mixed", "flows mixed"))
figure(
    fig,
    "One warp moves the stripe to the right, the other to the left. Mixed pictures are a ghost.",
)
report(
    darkest_in_mixed_pictures=mixed_pictures[0, 0, 32].min(),
    darkest_in_mixed_flows=mixed_flows[0, 0, 32].min(),
)

# %% tags=["s2g-figure"]
from s2glib.viz import draw_carried_grid, draw_moving_flow, draw_weight_maps
from s2glib.warping import resize_flow, tps_grid

scores = flow.contributions.log()  # up to a constant at each pixel, which a softmax forgets
weights = weight_maps(scores)
grid = combine_flows(flow.warps, weights)

fig, panels = plt.subplots(1, 4, figsize=(12, 3.3))
draw_weight_maps(panels[0], weights[0].numpy())
draw_picture(panels[1], weights[0, :1].expand(3, -1, -1).numpy())
draw_moving_flow(panels[2], driving[0].numpy(), grid[0].numpy())
draw_carried_grid(draw_picture(panels[3], warp_features(source, grid)[0].numpy()), grid[0].numpy())
bare(panels, ("weights of the groups", "of the background", "the flow", "the bent source"))
figure(
    fig,
    "Left: the groups' colours, mixed as their warps are; white is background. Then the background's "
    "own weight, the flow (arrows lead to where a pixel looks), and what it makes of the source.",
    exact=False,
)
report(
    weights_sum_to_one=torch.allclose(weights.sum(1), torch.ones(1, 32, 32)),
    same_flow_as_the_package=torch.allclose(grid, flow.sampling_grid, atol=1e-4),
    corners_belong_to_the_background=bool((weights[0, 0, 0, [0, -1]] > 0.9).all()),
)

# %% [markdown]
# ### Mix it yourself
#
# The mixer holds our two pictures. Each slider raises or lowers one warp's score everywhere.

# %% tags=["s2g-figure"]
from s2glib.widgets import MaskMixer

mixer = MaskMixer(source, driving, made)
as_the_network, bent = mixer.error, mixer.picture
mixer.set(0, -8)
fig, axes = plt.subplots(figsize=(6.6, 3.4))
mixer.draw(axes)
figure(
    fig,
    "The mixer with the background's warp turned off: the shelf moves with the speaker. Orange in the "
    "small pictures: where a warp counts.",
    exact=False,
)
report(
    begins_as_the_network=torch.allclose(bent, made.synthesis.warped[0], atol=1e-3),
    without_the_background_it_is_worse=mixer.error > as_the_network,
)

# %% tags=["s2g-demo"]
mixer.reset()
mixer

# %% [markdown]
# <details><summary>Try: let one warp count alone, then the next. Is any of them right for both hands?</summary>
#
# Hardly. Two hands that go different ways want two warps.
# </details>
#
# <details><summary>Try: beat the network's error.</summary>
#
# A slider moves a warp's score everywhere by the same, so you can hardly gain: the network has chosen for each pixel.
# </details>
#
# ## 5. What the source does not show
#
# Bend the source as you like: what was behind an arm stays unknown. So the network also predicts **occlusion
# masks**, one for each size of feature map. Mind the name: **1 means visible**, keep the bent source; 0
# means paint anew.
#
# ### Exercise 03-3: bend and hide
#
# ●●○ · 10 minutes · [MDD B.5]
#
# `features` are maps of the source, coarse to fine; `flow.occlusion_masks` are masks of the same sizes, in the
# same order. Look up each map by `flow.sampling_grid`, then hide. `resize_flow(grid, height, width)` and
# `warp_image(maps, grid)` help.


# %% tags=["s2g-exercise"]
def warp_and_mask(features, flow):
    """Maps of several sizes, bent by the flow, occluded places set to zero: a list."""
    ...  # your code


# %% tags=["s2g-solution"]
def warp_and_mask(features, flow):
    """Maps of several sizes, bent by the flow, occluded places set to zero: a list."""
    kept = []
    for maps, mask in zip(features, flow.occlusion_masks, strict=True):
        bent = warp_image(maps, resize_flow(flow.sampling_grid, *maps.shape[-2:]))
        kept.append(bent * mask)
    return kept


# %% tags=["s2g-check", "nbval-ignore-output"]
warp_and_mask = check("03-3", warp_and_mask)

# %% tags=["s2g-source"]
show_solution("03-3")

# %%
visible = flow.occlusion_masks[-1]
finest = flow._replace(occlusion_masks=[visible])
(kept,) = warp_and_mask([source], finest)  # a picture is a feature map, too
painted = made.synthesis.image - kept
own_maps = warp_and_mask(made.synthesis.features, flow)
report(
    maps_of_the_source=[tuple(maps.shape[1:]) for maps in own_maps],
    most_pixels_are_kept=bool(visible.mean() > 0.5),
)

# %% [markdown]
# The coarse masks hide features, which have wide views, not pixels: do not read them as pictures.

# %% tags=["s2g-figure"]
from s2glib.viz import draw_occlusion

shown = (made.synthesis.warped, kept, painted, kept + painted)
fig, panels = plt.subplots(2, 4, figsize=(11, 5.6))
for axes, mask in zip(panels[0], flow.occlusion_masks, strict=True):
    draw_occlusion(axes, driving[0].numpy(), mask[0, 0].numpy())
for axes, image in zip(panels[1], shown, strict=True):
    draw_picture(axes, image[0].numpy())
sizes = [f"mask, {mask.shape[-1]} pixels" for mask in flow.occlusion_masks]
bare(panels, (*sizes, "bent", "bent and hidden", "painted", "together"))
figure(
    fig,
    "Above: vermilion hides, what shows is kept. Below: the bent source, what the finest mask leaves of "
    "it, what the network paints, and the sum of the two.",
    exact=False,
)

# %% [markdown]
# ## 6. Three losses, no labels
#
# ### Perceptual: is it the driving picture?
#
# Pixels are poor judges: a hand that is 3 pixels off costs as much as one that is 30 off. MDD compares VGG-19's
# feature maps, at four sizes [MDD B6]. VGG was trained on photographs and its weights are a download, so our networks
# learned by something humbler: **colours and edges of a pyramid** of smaller pictures. It shares the form of B6, a
# sum over maps and sizes, not VGG's eye. How far does each size see?

# %% tags=["s2g-figure"]
from s2glib.layers import PyramidFeatures

features = PyramidFeatures()
steps = range(0, 17)
hand = torch.zeros(8, 3, 64, 64)
for start in range(8):  # at eight places, since small copies see only every few pixels
    hand[start, :, 30:34, 16 + start : 20 + start] = 1.0
maps = [features(hand.roll(step, dims=-1)) for step in steps]
curves = torch.tensor(
    [[(f - g).abs().mean() for f, g in zip(maps[0], m, strict=True)] for m in maps]
)

fig, axes = plt.subplots(figsize=(5.4, 3.2))
for level in range(4):
    colours = curves[:, 2 * level]
    axes.plot(steps, colours / colours.max(), label=f"{64 // 2**level} pixels")
axes.set(xlabel="a hand of 4 pixels is off by (pixels)", ylabel="loss / its largest")
axes.legend(fontsize=10)
figure(
    fig,
    "In the full picture the loss stops growing after 4 pixels; small copies still pull from afar.",
)
perceptual = sum(
    (f - g).abs().mean()
    for f, g in zip(features(driving), features(made.synthesis.image), strict=True)
)
report(maps=len(features(driving)), maps_with_VGG=4 * 5)

# %% [markdown]
# ### Equivariance: do points move with the picture?
#
# Bend a picture at random, by $\tilde{\mathcal{A}}$, and the keypoints must move with it [MDD B7]:
#
# $$\mathcal{L}_{eq} = \bigl\lvert E_{kp}(\tilde{\mathcal{A}}(\mathbf{S})) - \tilde{\mathcal{A}}(E_{kp}(\mathbf{S})) \bigr\rvert$$
#
# One letter, two meanings: the picture is bent *backward*, each new pixel looks up the spline, while the
# points go *forward*. As in the authors' code, we have the spline that leads back, so send the **new** points through it:
#
# $$\mathcal{L}_{eq} = \bigl\lvert E_{kp}(\mathbf{S}) - \texttt{bend}\bigl(E_{kp}(\text{bent picture})\bigr) \bigr\rvert$$
#
# ### Exercise 03-4: keypoints that move with the picture
#
# ●●● · 12 minutes · [MDD Eq. B7]
#
# Mean over all points, x and y. Fill what comes into view by reflection.


# %% tags=["s2g-exercise"]
def equivariance(predictor, image, keypoints, bend):
    """How far the keypoints of a bent picture, bent back, are from `keypoints` (batch, k, n, 2)."""
    ...  # your code


# %% tags=["s2g-solution"]
def equivariance(predictor, image, keypoints, bend):
    """How far the keypoints of a bent picture, bent back, are from `keypoints` (batch, k, n, 2)."""
    places = tps_grid(bend, *image.shape[-2:])
    bent = predictor(warp_image(image, places, padding="reflection"))
    back = apply_tps(bend, bent.flatten(1, 2))
    return (keypoints.flatten(1, 2) - back).abs().mean()


# %% tags=["s2g-check", "nbval-ignore-output"]
equivariance = check("03-4", equivariance)

# %% tags=["s2g-source"]
show_solution("03-4")

# %%
from s2glib.warping import ThinPlateSpline, gaussian_heatmap, random_tps, undo_tps


def centroids(image):
    """A perfect predictor for three blobs: the mean place of each colour, (batch, 1, 3, 2)."""
    places = coordinate_grid(*image.shape[-2:]).flatten(0, 1)
    return (image.flatten(2) / image.sum((2, 3))[..., None] @ places)[:, None]


centres = torch.tensor([[[-0.3, -0.2], [0.4, 0.0], [0.0, 0.4]]])
blobs = gaussian_heatmap(centres, 64, 64, variance=0.003)
turn = torch.tensor([[[0.1, 0.0], [0.9, 0.3], [-0.3, 0.9]]])  # offset, then what x and y add
bend = ThinPlateSpline(torch.zeros(1, 1, 2), torch.zeros(1, 1, 2), turn)
found = centroids(warp_image(blobs, tps_grid(bend, 64, 64)))
known = centroids(blobs)
report(
    perfect_points_bent_back=bool(equivariance(centroids, blobs, known, bend) < 1e-3),
    the_same_spline_as_printed=(found - apply_tps(bend, known[:, 0])).abs().mean(),
    its_inverse_as_printed=bool((found - undo_tps(bend, known[:, 0])).abs().mean() < 1e-3),
)

# %% [markdown]
# B7 holds if $\tilde{\mathcal{A}}$ of points is the inverse of what bends the picture. Read with one spline, it punishes a
# perfect predictor.
#
# ### Warping: does the flow alone explain it?
#
# A painter could leave the flow idle and paint all. So features of the source, bent, shall be those of the driving
# picture [MDD B8]:
#
# $$\mathcal{L}_{warp} = \sum_i \bigl\lvert \tilde{\mathcal{T}}^{-1}(E_i(\mathbf{S})) - E_i(\mathbf{D}) \bigr\rvert$$
#
# $E_i$ are the layers of the synthesis network's encoder; the masks of section 5 go over both sides. Compute all
# three by hand, and ask which networks each of them teaches:

# %%
from s2glib.papers.mddiffusion import decoupling_losses
from s2glib.recipes.mddiffusion_decoupling import warp_dropout

bend = random_tps(1, generator=torch.Generator().manual_seed(0))
losses = decoupling_losses(model, source, driving, features, bend)
with torch.no_grad():
    here = [
        f * m for f, m in zip(model.synthesizer.encode(driving), flow.occlusion_masks, strict=True)
    ]

    def warping(flow):
        """B8, by a flow."""
        bent = warp_and_mask(made.synthesis.features, flow)
        return sum((f - g).abs().mean() for f, g in zip(here, bent, strict=True))

    by_hand = {
        "perceptual": perceptual,
        "equivariance": equivariance(model.keypoints, driving, made.driving_keypoints, bend),
        "warp": warping(flow),
    }
networks = {"keypoints": model.keypoints, "flow": model.flow, "synthesis": model.synthesizer}


def taught(loss):
    """The networks that a loss has a gradient for."""
    for name, network in networks.items():
        found = torch.autograd.grad(
            loss, list(network.parameters()), retain_graph=True, allow_unused=True
        )
        if any(gradient is not None for gradient in found):
            yield name


share = max(value / sum(by_hand.values()) for value in by_hand.values())
turned_round = flow._replace(sampling_grid=2 * pixels - flow.sampling_grid)
report(
    by_hand_as_in_the_package=all(
        torch.allclose(value, getattr(losses, name), rtol=1e-3) for name, value in by_hand.items()
    ),
    **{f"{name} teaches": ", ".join(taught(getattr(losses, name))) for name in by_hand},
    a_flow_turned_round_is_worse=bool(warping(turned_round) > warping(flow)),
    one_term_is_more_than_half_of_the_sum=bool(share > 0.5),
    weights_of_the_authors_code=LESSONS["paper"].weights,
    our_weights=LESSONS["teaching"].weights,
)

# %% [markdown]
# The text calls $\tilde{\mathcal{T}}^{-1}$ "the forward optical flow". The flow predictor gives the *backward* flow, and looking
# up $E_i(\mathbf{S})$ needs just that one; no inverse appears in the authors' code. What goes forward is the picture. (And
# $\mathbf{R}$ in the text is $\mathbf{S}$.)
#
# B9 is the plain sum of the three, though they have different units and numbers of maps, so one may drown the others. The
# authors' code multiplies each by 10. Our `warped` is one more term: B6 for the merely bent source, so that a painter
# cannot do the flow's work.
#
# ## 7. TPS dropout
#
# Early on, one group could move everything, and the others would never learn. So whole warps are left out by chance:
# score $-\infty$, weight 0. The others fill in. The background stays. (No other warp can stand in for a forearm's: ours, once
# they were told their limbs, all stayed.)

# %% tags=["s2g-figure"]
from s2glib import warping as warp_room

thinned = warp_room.weight_maps(scores, dropout=0.5, generator=torch.Generator().manual_seed(1))
gone = (thinned[0].amax((1, 2)) == 0).nonzero().flatten().tolist()

fig, panels = plt.subplots(1, 3, figsize=(11, 3.3), width_ratios=[1, 1, 1.2])
draw_weight_maps(panels[0], weights[0].numpy())
draw_weight_maps(panels[1], thinned[0].numpy())
bare(panels[:2], ("all warps", "some left out"))
progress = np.linspace(0, 0.3, 301)
panels[2].plot(100 * progress, [warp_dropout(p) for p in progress])
panels[2].set(xlabel="training done (%)", ylabel="share left out")
figure(
    fig,
    "Weight maps as before, and with half of the warps left out by chance; colours as in section 4. "
    "Right: how many are left out in the course of training.",
    exact=False,
)
report(
    left_out=gone,
    the_others_fill_in=torch.allclose(thinned.sum(1), torch.ones(1, 32, 32)),
    the_background_may_stay=0 not in gone,
)

# %% [markdown]
# ## 8. Break it: handles that are thin
#
# MDD's rival in Fig. E1, **MRAA**, has no keypoints but *regions*: a mean $\mu$ and a covariance $\Sigma$. Predicted from speech,
# $\Sigma$ tends to be *near-singular*, even if built from a Cholesky factor [MDD E]. **Predict** what that does.

# %%
ask("03-p3")

# %% tags=["s2g-figure"]
from s2glib.warping import (
    Region,
    apply_affine,
    cholesky_root,
    condition_number,
    fit_region_affine,
    region_of_heatmap,
    region_of_points,
)

LONG, OFF, DRAWS = 0.2, 0.01, 2000  # spread along the arm and error of each number, image units
chance = torch.Generator().manual_seed(0)
angles = torch.arange(5, dtype=torch.float64) * 2 * torch.pi / 5


def wrong_by(*shape):
    """Errors of predicted numbers."""
    return OFF * torch.randn(shape, generator=chance, dtype=torch.float64)


def astray(places, points):
    """How far the worst point goes astray, in pixels of 256; one prediction in 20 is worse."""
    return 127.5 * (places - points).norm(dim=-1).amax(-1).quantile(0.95).item()


def handles(width):
    """The same points, moved by a region and by splines, all predicted with errors."""
    points = 2**0.5 * torch.stack([angles.cos() * LONG, angles.sin() * width], dim=1)
    true = region_of_points(points)
    root = cholesky_root(true.covariance) + wrong_by(DRAWS, 2, 2).tril()
    predicted = Region(true.mean + wrong_by(DRAWS, 2), root @ root.mT)
    off, many = points + wrong_by(DRAWS, 5, 2), points.expand(DRAWS, 5, 2)
    moved = (
        apply_affine(fit_region_affine(predicted, true), points),
        apply_tps(fit_tps(off, points), many),
        apply_tps(fit_tps(off, points, ridge=0.01), many),
    )
    return condition_number(true.covariance).item(), *(astray(each, points) for each in moved)


conditions, *curves = zip(*map(handles, np.geomspace(0.2, 0.01, 9)), strict=True)
names = ("region", "five keypoints", "with a ridge of 0.01")
fig, axes = plt.subplots(figsize=(6, 3.3))
for name, curve, stroke in zip(names, curves, ("o-", "s--", "^:"), strict=True):
    axes.loglog(conditions, curve, stroke, label=name)
axes.set(xlabel="condition number of the covariance", ylabel="astray by (pixels)")
axes.minorticks_off()
axes.set_yticks([4, 8, 16, 32], ["4", "8", "16", "32"])
axes.legend(fontsize=10)
figure(
    fig,
    "Every predicted number has an error of 1.3 pixels (of 256). The thinner the region (to the right), "
    "the wilder its map; keypoints on the same outline suffer less.",
)
arm = region_of_heatmap(torch.from_numpy(video.parts == Part.LEFT_ARM).double())
with torch.no_grad():
    groups = region_of_points(untold(film))
arms_condition = condition_number(arm.covariance).median()
report(
    **{
        f"{name}, round and thin": (curve[0], curve[-1])
        for name, curve in zip(names, curves, strict=True)
    },
    condition_of_the_left_arm=arms_condition,
    groups_found_without_labels_are_rounder=bool(
        condition_number(groups.covariance).median() < arms_condition
    ),
)

# %% [markdown]
# The map divides by the predicted width. When an error eats up the width, an arm is torn off: a ghost. Keypoints on the
# same outline suffer less, though the ridge that saves them when they coincide costs them something when they are thin.
# Above all, a group is not bound to the shape of an arm: those found without labels spread over the body. Our whole arms have
# condition 12, harmless in itself; what MDD blames is $\Sigma$ *predicted* thinner than it is.
#
# ## 9. Do the keypoints know where the hands are?
#
# Back to the keypoints that were never told anything. Do they know where the wrists are? Fit a linear map (ridge regression)
# from keypoints to wrists on some films, and see how much of the wrists' variance it explains on others, with another
# sentence. An untrained network is the yardstick: its outputs, too, depend on the picture.

# %% tags=["s2g-figure"]
from s2glib.data import clips


def filmed(names):
    """Pictures of many clips, and where both wrists are: x, y, x, y."""
    found = [load_clip(name) for name in names]
    videos = [render_video(each, LOOKS[each.speaker], size=64, fps=2.5) for each in found]
    wrists = np.concatenate([each.keypoints[:, WRISTS].reshape(-1, 4) for each in videos])
    return torch.cat(list(map(pictures, videos))), torch.from_numpy(wrists).double()


seen, wrists = filmed([name for name in clips() if not name.startswith("s04")][::3])
unseen, true = filmed([name for name in clips() if name.startswith("s04")][::3])


@torch.no_grad()
def read_wrists(network, frames):
    """The wrists in these pictures, by the linear map that fits the seen films best."""
    x, new = (network(some).flatten(1).double() for some in (seen, frames))
    mean, spread = x.mean(0), x.std(0)
    x, new = (x - mean) / spread, (new - mean) / spread
    penalty = 0.1 * len(x) * torch.eye(x.shape[1], dtype=x.dtype)
    slope = torch.linalg.solve(x.mT @ x + penalty, x.mT @ (wrists - wrists.mean(0)))
    return wrists.mean(0) + new @ slope


def explained(network):
    """R squared on the unseen films: 1 is perfect, 0 is as good as the mean."""
    missed = (read_wrists(network, unseen) - true).square().sum(0)
    return (1 - missed / (true - true.mean(0)).square().sum(0)).mean()


untrained = KeypointPredictor(untold.config).eval()
truth = video.keypoints[:, WRISTS].reshape(-1, 4)
fig, panels = plt.subplots(1, 2, figsize=(8, 2.7), sharex=True, sharey=True)
for axes, axis, name in zip(panels, (0, 1), ("x", "y"), strict=True):
    axes.plot(np.arange(len(film)) / FPS, truth[:, axis], label="true")
    for label, network in (("from keypoints", untold), ("untrained", untrained)):
        axes.plot(np.arange(len(film)) / FPS, read_wrists(network, film)[:, axis], label=label)
    axes.set(title=f"left wrist, {name}", xlabel="time (s)", ylabel="image units")
panels[0].legend(fontsize=10)
figure(
    fig,
    "Our film again: where the left wrist is, and where the keypoints put it. Mind "
    "that y goes down.",
    exact=False,
)
trained, chance_level = explained(untold), explained(untrained)
report(
    films_fitted_and_tested=(len(seen), len(unseen)),
    keypoints_explain_more_than_half=bool(trained > 0.5),
    at_least_a_fifth_more_than_an_untrained_network=bool(trained > chance_level + 0.2),
    keypoints_that_were_told_explain_more_still=bool(explained(model.keypoints) > trained),
)

# %% [markdown]
# ## 10. A film from one picture
#
# Now all together: keypoints of every frame of the film move one picture. If it is the film's own first frame, this is
# *self-reenactment*; if it is somebody else's, the other speaker does what the film shows. Here even that has a
# true answer: the same motion, filmed with the other's looks.

# %% tags=["s2g-figure"]
from s2glib.widgets import FilmPlayer

plain = MDDiffusion(model)  # without the repairs of notebook 04
still = render_video(load_clip("s01-voice_05-sadness-t2"), LOOKS["voice_05"], size=64, fps=0.1)
stranger = pictures(still)[0]
motion = plain.keypoints(film)
own, other = plain.animate(film[0], motion).frames, plain.animate(stranger, motion).frames

rows = {"film": film, "rebuilt": own, "another": other}
fig, axes = plt.subplots(figsize=(4.4, 4.1))
draw_films(axes, rows | {"truth": double}, FPS, (0, 1.4, 2.8, 4.2))
figure(
    fig,
    "The film; the same rebuilt from its first frame; another speaker, made of one picture of hers and "
    "the film's keypoints; and what she would really look like.",
    exact=False,
)
moves = film.var(0).mean(0)
moves = moves > moves.quantile(0.75)  # the quarter of the pixels that change most


def error(frames, true):
    """Mean absolute difference where something moves."""
    return (frames - true).abs()[..., moves].mean()


hands = torch.from_numpy(video.hand_mask)[:, None].expand_as(film)
report(
    frames=len(film),
    hands_are_rebuilt_better_than_by_a_still_picture=bool(
        (own - film).abs()[hands].mean() < (film[:1] - film).abs()[hands].mean()
    ),
    rebuilt_beats_the_still_picture=bool(error(own, film) < error(film[:1], film)),
    another_beats_the_still_picture=bool(error(other, double) < error(stranger, double)),
)

# %% tags=["s2g-media", "nbval-ignore-output"]
FilmPlayer({"film": film, "another": other.clamp(0, 1)}, FPS, clip.waveform)

# %% [markdown]
# ## 11. Paper check
#
# | claim [MDD B.1, B.5, E] | what we computed | verdict |
# |---|---|---|
# | keypoints need no labels [B.1] | wrists can be read from them, far better than from an untrained network; but in 9000 steps no warp of theirs carried a hand | holds for knowing; our hands needed labels |
# | VGG-19 in the perceptual loss [B6] | trained without: a pyramid of colours and edges | works without, on drawn pictures; photographs are untried |
# | $E_{kp}(\tilde{\mathcal{A}}(\mathbf{S})) = \tilde{\mathcal{A}}(E_{kp}(\mathbf{S}))$ [B7] | a perfect predictor misses by 0.18 image units if one spline bends both | **needs two directions** |
# | $\tilde{\mathcal{T}}^{-1}$ is the forward flow [B8] | looking up by the backward flow is right, turned round it is worse | **wording is misleading** |
# | unweighted sum [B9] | one term is more than half | balance is left to chance; the released code multiplies all by 10 |
# | near-singular $\Sigma$ [E] | errors of 1.3 pixels become 31 in a region of condition 400, 7 for keypoints (20 with the ridge) | plausible cause of the ghosts |
#
# ## 12. Check yourself

# %%
ask("03-q1")

# %%
ask("03-q2")

# %%
ask("03-q3")

# %% [markdown]
# And one without an answer: which motion of your own could no set of 40 points tell from another?
#
# ## Summary
#
# - To rebuild one picture from another through nothing but points, a network must put motion into the points.
# - Each group of points is a spline; weight maps mix $K$ of them and a background into one flow. Mix flows, not pictures.
# - Occlusion masks say what the source cannot show: 1 is visible, 0 is painted.
# - Three losses: is it the picture, do points move with it, does the flow explain it?
# - Regions of thin limbs give near-singular handles; learned point sets need not be thin.
#
# **Limits.** Points found without labels tell where hands are, but did not carry them: ours were shown eight limbs first.
# Hands that cross the body stay a blur, and fingers are nobody's limb. Keypoints carry the build of a speaker. What is hidden
# is painted: notebook 04 repairs what it can.
#
# **Back:** [02 Thin-plate splines](02_thin_plate_splines.ipynb). **Next:** notebook 04 mends hands and faces.
