# ---
# jupyter:
#   s2g: {"id": "06", "minutes": 73, "needs": ["01", "05"], "goals": ["bring speech and given motion to the pace of tokens", "say what a gate does", "give every token a place of its own", "say what a style normalisation takes away", "choose which tokens are hidden in training", "decode step by step and say why"], "papers": {"PT": ["A.2"]}, "demos": ["unmasking stepper"], "data": ["shipped"], "budget_s": 25, "exercises": ["06-1", "06-2", "06-3"], "questions": ["06-p1", "06-p2", "06-p3", "06-q1", "06-q2", "06-q3", "06-q4"], "reached": {"bring speech and given motion to the pace of tokens": ["06-p1"], "say what a gate does": ["06-1"], "give every token a place of its own": ["06-p2"], "say what a style normalisation takes away": ["06-2", "06-q1"], "choose which tokens are hidden in training": ["06-q2"], "decode step by step and say why": ["06-3", "06-p3", "06-q3", "06-q4", "unmasking stepper"]}}
# ---

# %% [markdown]
# # Predicting masked tokens: how does one write 88 words that fit together?
#
# | | |
# |---|---|
# | After this you can | bring speech and given motion to the pace of tokens; say what a gate does; give every token a place of its own; say what a style normalisation takes away; choose which tokens are hidden in training; decode step by step and say why |
# | You need | [01 Motion and sound](01_motion_and_sound.ipynb), [05 Product codes](05_product_codes.ipynb) |
# | Time | 45 minutes, and 28 for the exercises |
# | Papers | PT A.2 |
# | Data | clips that come with the workbook; no network was trained on them |

# %% tags=["s2g-setup"]
import matplotlib.pyplot as plt
import numpy as np
import torch

from s2glib.teaching import PALETTE, ask, check, figure, report, setup, show_solution

setup("06")

# %% [markdown]
# ## 1. A cloze text of 88 words
#
# In notebook 05 a gesture of 176 frames became 22 x 4 codes. Now speech has to write them. A language model would write one after the
# other, each knowing only those before. ProbTalk's **Predictor** plays a cloze instead: it sees speech, perhaps some motion that is *given*,
# and a table of tokens of which some are **hidden**. For every hidden place it says how likely each of the 128 codes is. A hidden token holds one number more, 128, the *mask*.
#
# From here on a *token* is one code: 22 moments times 4 groups, 88 tokens. The four of a moment share its 8 frames.

# %% tags=["s2g-figure"]
from s2glib.body import mannequin
from s2glib.corpus import SPEAKERS
from s2glib.data import clips, load_clip
from s2glib.folders import data_folder
from s2glib.papers.probtalk import PARTS, ProbTalk, hide_tokens
from s2glib.viz import draw_features

probtalk = ProbTalk.load(data_folder() / "checkpoints")
pqvae, predictor = probtalk.pqvae, probtalk.predictor
FRAMES, CODES, MASK = pqvae.config.frames, pqvae.config.codes, predictor.mask
PACE = pqvae.config.window / 30  # seconds of a token
everything = torch.ones(FRAMES, len(PARTS), dtype=torch.bool)


def asked_of(clip):
    """Speech, motion and speaker of a clip's first 176 frames, as the networks see them."""
    speaker = SPEAKERS.index(clip.speaker)
    return probtalk.ask(clip.waveform, FRAMES, clip.motion, everything, speaker)


clip = load_clip("s04-voice_13-anger-t2")
asked = asked_of(clip)
with torch.no_grad():
    codes = pqvae.encode(asked.given)
chance = torch.Generator().manual_seed(6)
cloze = hide_tokens(codes, torch.tensor([0.6]), mask=MASK, generator=chance)

fig, panels = plt.subplots(2, 1, figsize=(9, 4), sharex=True)
draw_features(panels[0], asked.speech[0].numpy(), 30, "mel band")
panels[0].set(xlabel="")
table = np.ma.masked_equal(cloze[0].T.numpy() == MASK, False)
panels[1].imshow(
    table, extent=(0, 22 * PACE, 3.5, -0.5), aspect="auto", cmap="Greys", vmin=0, vmax=4
)
for (t, g), code in np.ndenumerate(cloze[0].numpy()):
    word = "?" if code == MASK else str(code)
    panels[1].text((t + 0.5) * PACE, g, word, ha="center", va="center", fontsize=9)
panels[1].set(xlabel="time (s)", ylabel="group", yticks=range(4))
figure(
    fig,
    "What the Predictor gets in training: speech, and the codes of the true motion with 60 % of them hidden. It has to fill in the question marks.",
    exact=False,
)
report(
    speech=asked.speech.shape,
    tokens_in_time_and_groups=codes.shape,
    hidden=(cloze == MASK).sum(),
    answers_to_each=CODES,
)

# %% [markdown]
# | letter | here | elsewhere |
# |---|---|---|
# | $t$, $g$ | time and group of a token | $t$ is a noise level in AM, MDD |
# | $T$ | steps of decoding | frames |
# | $r$ | share of the steps that are done | a distance in MDD A2 |
# | $N$ | tokens hidden at the start | |
# | $\tau$ | how much chance decides which tokens stay | |
# | $\ell$ | log-odds: what the network says of each code, before the softmax | |
# | $s$ | guidance: how much speech counts | |
#
# ## 2. Speech at the pace of tokens
#
# Speech has 30 vectors a second, moments come 3.75 times a second. The text's audio encoder is "3 temporal convolution layers (kernel size 4, stride 2, padding 1)": each halves time.

# %%
from s2glib.papers.probtalk import PAPER_PREDICTOR, Predictor
from s2glib.papers.probtalk.pqvae import Resample


def shapes(layers, track, kind):
    """Channels and frames after every layer of a kind."""
    for layer in layers:
        track = layer(track)
        if isinstance(layer, kind):
            yield tuple(track.shape[1:])


with torch.device("meta"):  # the paper's size; shapes only, no memory
    paper = Predictor(PAPER_PREDICTOR)
    halved = list(shapes(paper.audio, torch.empty(1, 768, FRAMES), Resample))
with torch.no_grad():
    spoiled = asked.speech.repeat(FRAMES, 1, 1)
    spoiled[range(FRAMES), range(FRAMES)] = torch.nan  # one frame in each copy
    hears = predictor.audio(spoiled.mT)[..., 11].isnan().any(-1)
heard = hears.nonzero()[:, 0]
report(
    channels_and_frames_after_each_layer=halved,
    frames_that_moment_11_hears=len(heard),
    from_and_to=(heard[0], heard[-1]),
    its_own_frames=(8 * 11, 8 * 12 - 1),
    seconds=len(heard) / 30,
)

# %% [markdown]
# A moment hears its own 8 frames and 7 on either side: .73 seconds, hardly a word. All that is longer must come from attention, in section 5. (The released code has a projection
# before the three layers, and a bare convolution beside each.)
#
# ## 3. What is given, and a gate for it
#
# Some motion may be given: the last second of the window before, or a hand that shall stay as it is. **Predict first.**

# %%
ask("06-p1")

# %% [markdown]
# Given motion comes with holes, and an ordinary convolution mixes what is given with the zeros of what is not. The text takes "10 gated convolution layers". A gated one makes two tracks: $a$, what there is to say, and $b$, whether to say it:
#
# $$\tanh(a) \cdot \sigma(b)$$
#
# ### Exercise 06-1: a gate
#
# ●○○ · 6 minutes · [PT A.2]
#
# `both` is what a convolution has made, (..., channels, time): the first half of the channels is $a$, the second $b$.
#
# As always, you may skip an exercise: the notebook then goes on with the package's function.


# %% tags=["s2g-exercise"]
def gated(both):
    """What passes the gate: (..., channels / 2, time)."""
    ...  # your code


# %% tags=["s2g-solution"]
def gated(both):
    """What passes the gate: (..., channels / 2, time)."""
    a, b = both.chunk(2, dim=-2)
    return a.tanh() * b.sigmoid()


# %% tags=["s2g-check", "nbval-ignore-output"]
gated = check("06-1", gated)

# %% [markdown]
# Stuck? Open a hint. The solution is the package's own code.

# %% tags=["s2g-source"]
show_solution("06-1")

# %% [markdown]
# Let us build one by hand. An elbow is given for two seconds. Both tracks look at 7 frames: $a$ takes the mean of the elbow, $b$ the share of frames that are given, and
# shuts unless nearly all are.

# %% tags=["s2g-figure"]
frame = torch.arange(120, dtype=torch.float64)
given = (frame >= 30) & (frame < 90)
elbow = 0.7 + 0.25 * (frame / 6).sin()


def mean_of_7(track):
    """The mean of a frame and three on either side."""
    return torch.nn.functional.avg_pool1d(track[None, None], 7, 1, 3)[0, 0]


plain = mean_of_7(elbow * given)
b = 24 * mean_of_7(given.double()) - 21
passed = gated(torch.stack([plain, b]))[0]
fig, axes = plt.subplots(figsize=(7, 3.2))
axes.plot(frame / 30, elbow, ":", color=PALETTE["black"], label="true elbow")
axes.plot(frame / 30, plain, label="convolution")
axes.plot(frame / 30, passed, label="gated convolution")
axes.axvspan(1, 3, color=PALETTE["sky"], alpha=0.2, label="given")
axes.set(xlabel="time (s)", ylabel="angle (rad); gated: tanh of it")
axes.legend(fontsize=10, loc="lower center")
figure(
    fig,
    "At the borders a plain convolution reports an elbow that is half bent; it is only half known. The gate is shut there. Inside, it lies lower because it is the tanh of the angle.",
)
border = given.logical_not() & (mean_of_7(given.double()) > 0)
report(
    largest_beside_what_is_given=(plain[border].max(), passed[border].max()),
    gate_inside_and_outside=(b[60].sigmoid(), b[0].sigmoid()),
)

# %% [markdown]
# Such gates need not be built: training finds $a$ and $b$ of its own. (A layer mixes what passes and adds its input beside the gate: a gate decides what is *added*.) The ten layers see the motion and the mask:

# %%
from s2glib.layers import GatedConv

layers = [layer for layer in paper.context if isinstance(layer, GatedConv)]
with torch.device("meta"):
    context = torch.empty(1, PAPER_PREDICTOR.motion + PAPER_PREDICTOR.context_parts, FRAMES)
    after = list(shapes(paper.context, context, GatedConv))
report(
    numbers_of_a_frame=context.shape[1],
    kernels=[layer.conv.kernel_size[0] for layer in layers],
    strides=[layer.conv.stride[0] for layer in layers],
    frames_after_each=[frames for _, frames in after],
    width_at_the_end=after[-1][0],
)

# %% [markdown]
# The authors' mask is one number a frame: known or not. Ours has four, for face, body and both hands, so that a hand alone can be given.
#
# ## 4. Where is a token?
#
# Attention does not know the order of what it looks at; tokens have to carry their place. Ours have two: time and group. The authors add the usual wave of each,
# counted from 1. **Predict.**

# %%
ask("06-p2")

# %% tags=["s2g-figure"]
from s2glib.layers import sinusoidal_embedding

time, group = torch.arange(1, 23), torch.arange(1, 5)
fixed = sinusoidal_embedding(time, 128)[:, None] + sinusoidal_embedding(group, 128)
masks = torch.stack([table.weight[MASK] for table in predictor.embed]).detach()


def apart(places, t=4, g=2):
    """How far all places are from that of one token."""
    return (places - places[t - 1, g - 1]).norm(dim=-1)


fig, panels = plt.subplots(2, 1, figsize=(8, 3.8), sharex=True)
for axes, places, title in zip(
    panels, (fixed, fixed + masks), ("two waves", "with the mask of the group"), strict=True
):
    axes.imshow(
        apart(places).T.numpy(),
        extent=(0.5, 22.5, 4.5, 0.5),
        aspect="auto",
        cmap="Blues_r",
        vmin=0,
        vmax=16,
    )
    axes.plot(4, 2, "o", color=PALETTE["vermilion"])
    axes.plot(2, 4, "x", color=PALETTE["vermilion"])
    axes.set(title=title, ylabel="group", yticks=group.tolist())
panels[1].set(xlabel="time (tokens)", xticks=range(2, 23, 4))
figure(
    fig,
    "Distance of every token's place from that of time 4, group 2 (dot); dark is near. Above, time 2, group 4 (cross) has the very same place. Below, each group adds the vector of its own mask: no twins.",
    exact=False,
)


def twins(places):
    """Pairs of tokens that share a place."""
    flat = places.flatten(0, 1)
    return int(((flat[:, None] - flat).norm(dim=-1) < 1e-3).triu(1).sum())


report(pairs_with_one_place=twins(fixed), with_a_mask_for_each_group=twins(fixed + masks))

# %% [markdown]
# Sums do not know the order of their terms, so swap $t$ and $g$, and nothing changes. If nothing but its place tells a
# hidden token who it is, twins must get the same odds:

# %%
from dataclasses import replace

torch.manual_seed(0)
small = replace(predictor.config, layers=2, aligned=False, own_codes=False)
with torch.no_grad():
    memory = torch.randn(1, 22, small.width)
    speaker = torch.tensor([0])
    hidden = torch.full((1, 22, 4), MASK)
    odds = Predictor(small).eval().predict(memory, speaker, hidden)[0]
    better = replace(small, own_codes=True)
    other = Predictor(better).eval().predict(memory, speaker, hidden)[0]
report(
    twins_get_the_same_odds=torch.allclose(odds[3, 1], odds[1, 3], atol=1e-4),
    neighbours_get_the_same_odds=torch.allclose(odds[3, 1], odds[4, 1], atol=1e-4),
    with_own_codes_twins_do=torch.allclose(other[3, 1], other[1, 3], atol=1e-4),
)

# %% [markdown]
# Only 12 of 88 tokens have a twin, all within the first four moments. Once codes are known there, these help to tell them apart. So the paper's Predictor works.
#
# Its groups share more than places. A token goes in as a learned vector of its code, one for each of the 128 codes and one for the mask; a last layer turns what comes out into 128 log-odds. The code has one set of vectors and one last layer for all groups. But code 5 of
# the first group has nothing to do with code 5 of the second. In ours every group has its own, its own mask too, and so no twins.
#
# ## 5. Six blocks
#
# Each block has three parts. *Self-attention*: all 88 tokens look at each other, also at later ones. *Cross-attention*: each looks at the **memory**, 22 vectors of speech and given motion. A *linear layer* (two, with
# a ReLU between) works on each token alone. What a part makes is normalised by style and added to the token; the sum passes an ordinary layer norm.


# %%
def millions(*networks):
    """Parameters."""
    return sum(p.numel() for network in networks for p in network.parameters()) / 1e6


changed = cloze.clone()
changed[0, 21, 3] = 7  # the very last token
with torch.no_grad():
    memory = predictor.listen(asked.speech, asked.given, everything[None])
    first, second = (predictor.predict(memory, asked.speaker, c)[0, 0, 0] for c in (cloze, changed))
report(
    paper_millions=millions(paper),
    of_these_speech_and_motion=millions(paper.audio, paper.context),
    of_these_six_blocks=millions(paper.decoder),
    ours_millions=millions(predictor),
    our_blocks=predictor.config.layers,
    the_last_token_has_a_say_in_the_first=not torch.equal(first, second),
)

# %% tags=["s2g-figure"]
nothing = torch.zeros_like(everything)
seen = {}


def note(layer, inputs):
    """Ask an attention whom its tokens look at."""
    _, seen[layer] = torch.nn.MultiheadAttention.forward(layer, *inputs)


watched = [block.cross_attention for block in predictor.decoder.layers]
hooks = [layer.register_forward_pre_hook(note) for layer in watched]
with torch.no_grad():
    memory = predictor.listen(asked.speech, 0 * asked.given, nothing[None])
    _ = predictor.predict(memory, asked.speaker, predictor.hidden(memory))
for hook in hooks:
    hook.remove()

fig, panels = plt.subplots(1, len(watched), figsize=(10, 3.6), sharey=True)
for number, (axes, layer) in enumerate(zip(panels, watched, strict=True), start=1):
    looks = seen[layer][0].unflatten(0, (22, 4)).mean(1)  # over groups
    axes.imshow(looks.numpy(), extent=(0, 22 * PACE, 22 * PACE, 0), cmap="Blues", aspect="auto")
    axes.set(title=f"block {number}", xlabel="speech, time (s)")
panels[0].set(ylabel="token, time (s)")
figure(
    fig,
    "Where tokens look in the speech, in each of our blocks, mean of heads and groups; dark is much. On the diagonal, a token would hear its own time.",
    exact=False,
)
report(
    looks_of_a_token_sum_to_one=all(
        torch.allclose(each.sum(-1), torch.ones(88), atol=1e-4) for each in seen.values()
    )
)

# %% [markdown]
# Ours has one more help than the paper's: a token begins with the memory of its own time added (`aligned`), so that attention need not first learn to find the diagonal.
#
# ## 6. Style: what is taken away
#
# Every speaker has a vector of style. The text names an **AdaIN** layer: *adaptive instance normalisation* takes each channel over time, removes its mean and spread,
# and gives it those that the style asks for:
#
# $$\frac{x_{t} - \mu}{\sqrt{\sigma^2 + 10^{-5}}}\,(1 + \text{scale}) + \text{shift}, \qquad \mu, \sigma^2: \text{mean and variance over } t, \text{ for each channel}$$
#
# ### Exercise 06-2: another style
#
# ●●○ · 10 minutes · [PT A.2]
#
# `tokens` (batch, n, width), n being time (in the Predictor all 88 tokens); `scale` and `shift` (batch, width). The variance is the mean of squares, divided by n.


# %% tags=["s2g-exercise"]
def adaptive_instance_norm(tokens, scale, shift):
    """Tokens with another mean and spread over time."""
    ...  # your code


# %% tags=["s2g-solution"]
def adaptive_instance_norm(tokens, scale, shift):
    """Tokens with another mean and spread over time."""
    still = tokens - tokens.mean(dim=1, keepdim=True)
    spread = (still.square().mean(dim=1, keepdim=True) + 1e-5).sqrt()
    return still / spread * (1 + scale[:, None]) + shift[:, None]


# %% tags=["s2g-check", "nbval-ignore-output"]
adaptive_instance_norm = check("06-2", adaptive_instance_norm)

# %% tags=["s2g-source"]
show_solution("06-2")

# %% [markdown]
# The released code does something else: a *layer* norm, over the channels of each token, then scale and shift, and a gate that begins at zero. Same formula, another axis. What does each take away?

# %%
torch.manual_seed(0)
tokens = 0.6 * torch.randn(1, 22, 12, dtype=torch.float64)
angry = tokens + 2.0 * (torch.arange(12) < 3)  # in all tokens, three channels are raised
loud = tokens * torch.where(torch.arange(22) < 11, 1.0, 3.0)[:, None]  # the second half is strong


def over_time(x):
    """AdaIN without a style."""
    return adaptive_instance_norm(x, torch.zeros(1, 12), torch.zeros(1, 12))


def over_channels(x):
    """The released code's normalisation, without a style."""
    return torch.nn.functional.layer_norm(x, (12,))


def forgets(norm, x):
    """Whether the change leaves no trace."""
    return torch.allclose(norm(x), norm(tokens), atol=1e-3)


one = tokens.clone()
one[0, 5] += torch.randn(12)
report(
    over_time_forgets_what_all_tokens_share=forgets(over_time, angry),
    over_channels_forgets_it=forgets(over_channels, angry),
    over_time_forgets_how_strong_a_token_is=forgets(over_time, loud),
    over_channels_forgets_it_too=forgets(over_channels, loud),
    one_token_changes_so_many_over_time=int((over_time(one) != over_time(tokens)).any(-1).sum()),
    and_over_channels=int((over_channels(one) != over_channels(tokens)).any(-1).sum()),
)

# %% tags=["s2g-figure"]
NORMS = {"as they are": torch.clone, "over time": over_time, "over channels": over_channels}
fig, panels = plt.subplots(2, 3, figsize=(9.5, 4.4), sharex=True, sharey=True)
for line, (what, x) in zip(panels, {"raised": angry, "strong": loud}.items(), strict=True):
    for axes, (name, norm) in zip(line, NORMS.items(), strict=True):
        axes.imshow(
            norm(x)[0].T.numpy(), aspect="auto", cmap="RdBu", vmin=-3, vmax=3, origin="lower"
        )
        axes.set(title=f"{what}, {name}", xlabel="token", ylabel="channel")
        axes.label_outer()
figure(
    fig,
    "Above, three channels are raised in all tokens: gone after a normalisation over time. Below, half of the tokens are strong: gone after one over channels. Blue is high, red low.",
)

# %% [markdown]
# So over time, what a whole clip has in common is lost: an anger that the speech adds to every token. Over channels, the strength of single tokens is. The loss is not final: only what a part of a block *adds* is normalised by style; what is in the token already stays, up to
# the layer norm that follows each sum. The gate of the code is a second choice: at first, nothing passes, and a block is but the layer norms after its sums.

# %%
from s2glib.papers.probtalk import StyleLayer


def style_counts(style_norm):
    """Whether two speakers differ before any training."""
    torch.manual_seed(0)
    block = StyleLayer(12, 3, 24, style_dim=6, style_norm=style_norm).eval()
    x, y = torch.randn(1, 22, 12), torch.randn(1, 22, 12)
    first, second = (block(x, y, torch.randn(1, 6)) for _ in range(2))
    return not torch.equal(first, second)


with torch.no_grad():
    hidden = predictor.hidden(memory)
    own = predictor.predict(memory, asked.speaker, hidden)
    another = predictor.predict(memory, (asked.speaker + 1) % 24, hidden)
report(
    style_counts_before_training=(style_counts("adain"), style_counts("adaln")),
    normalisations_in_the_papers_six_blocks=sum(
        len(block.styles) for block in paper.decoder.layers
    ),
    our_trained_one_knows_speakers=not torch.allclose(own, another, atol=0.01),
)

# %% [markdown]
# "Followed by an AdaIN layer" may mean one a block, or one after each part. The code has three a block, and so have we. In the paper's size we take the text's form, over time, three a block; in ours the code's.
#
# ## 7. Which tokens to hide
#
# In training we hide tokens of true motion and ask for them. How many? The released code has a *curriculum*: half of them until half of the epochs are over, then ever more, all at the end. **MaskGIT**, from which this way of
# decoding is taken, draws another share for every clip: the cosine of a random angle.

# %% tags=["s2g-figure"]
from s2glib.papers.probtalk import masked_share, random_shares, remask_counts
from s2glib.recipes.probtalk_predictor import LESSONS

progress = np.linspace(0, 1, 400)
shares = random_shares(400, torch.Generator().manual_seed(0))
decoding = [share / 88 for share in (88, *remask_counts(88, 8)[:-1])]
fig, panels = plt.subplots(1, 2, figsize=(9, 3.2), sharey=True)
panels[0].plot(progress, [masked_share(p) for p in progress], color=PALETTE["blue"])
panels[0].set(title="curriculum", xlabel="training done", ylabel="share hidden")
panels[1].plot(progress, shares, ".", markersize=3, color=PALETTE["blue"])
panels[1].set(title="MaskGIT", xlabel="training done")
for axes in panels:
    for share in decoding:
        axes.axhline(share, color=PALETTE["vermilion"], linewidth=0.8, linestyle=":")
figure(
    fig,
    "How many tokens are hidden in training. Dotted: the eight shares that a decoding in eight steps meets.",
)
report(
    shares_that_decoding_meets=decoding,
    the_curriculum_meets_at_last=masked_share(1.0),
    in_the_papers_recipe_and_ours=[LESSONS[size].hidden for size in ("paper", "teaching")],
    MaskGIT_hides_less_than_half_in_about_a_third=bool(0.25 < (shares < 0.5).float().mean() < 0.42),
)

# %% [markdown]
# A curriculum ends with all hidden, and has never practised the last steps, with few hidden. (And its loss counts all 88 tokens, those that are shown too: to copy is no art.) Ours follows MaskGIT.
#
# What is known helps. Here is the cross-entropy of hidden tokens, with the clip's own speech and with another clip's. Blind guessing among 128 has $\ln 128 = 4.85$.

# %% tags=["s2g-figure"]
from s2glib.papers.probtalk import Asked

many = [asked_of(load_clip(name)) for name in clips()[::4]]
many = Asked(*(torch.cat(tracks) for tracks in zip(*many, strict=True)))
with torch.no_grad():
    true = pqvae.encode(many.given)


def listen(speech):
    """The memory of many clips, nothing being given."""
    return predictor.listen(speech, 0 * many.given, nothing.expand(len(speech), -1, -1))


@torch.no_grad()
def surprise(memory, share):
    """Mean cross-entropy of the tokens that are hidden, in nats."""
    chance = torch.Generator().manual_seed(1)
    shown = hide_tokens(true, torch.full((len(true),), share), mask=MASK, generator=chance)
    odds = predictor.predict(memory, many.speaker, shown)
    missed = torch.nn.functional.cross_entropy(odds.movedim(-1, 1), true, reduction="none")
    return missed[shown == MASK].mean().item()


with torch.no_grad():
    memories = {"own speech": listen(many.speech), "another's": listen(many.speech.roll(1, 0))}
curves = {name: [surprise(each, share) for share in decoding] for name, each in memories.items()}
fig, axes = plt.subplots(figsize=(5.6, 3.4))
for (name, curve), stroke in zip(curves.items(), ("o-", "s--"), strict=True):
    axes.plot([100 * share for share in decoding], curve, stroke, label=name)
axes.axhline(np.log(CODES), color=PALETTE["black"], linestyle=":", label="blind guessing")
axes.set(xlabel="tokens hidden (%)", ylabel="cross-entropy (nats)")
axes.invert_xaxis()
axes.legend(fontsize=10)
figure(
    fig,
    "How surprised the Predictor is by true tokens of unseen clips, the more of the others it knows.",
    exact=False,
)
report(
    clips=len(true),
    better_than_blind=curves["own speech"][0] < np.log(CODES),
    what_is_known_helps=curves["own speech"][-1] < curves["own speech"][0],
    own_speech_helps=curves["own speech"][0] < curves["another's"][0],
)

# %% [markdown]
# ## 8. One pass, or eight
#
# All tokens could be drawn in a single pass. **Predict** what that does.

# %%
ask("06-p3")

# %%
from s2glib.papers.probtalk.masking import decode


def alike(codes):
    """Perfect log-odds of two tokens that agree: what is hidden follows what is known."""
    known = codes[..., 0, :].amin(-1, keepdim=True)  # the mask, 2, is the largest number
    share = torch.stack([(known == 0).float(), (known == 1).float()], dim=-1)
    return torch.where(known[..., None] == 2, 0.5, share)[:, None].expand(-1, 1, 2, 2).log()


def disagree(steps):
    """How often two tokens end up different, in 1000 decodings."""
    start = torch.full((1000, 1, 2), 2)
    chance = torch.Generator().manual_seed(0)
    *_, last = decode(alike, start, mask=2, steps=steps, generator=chance)
    return (last.codes[..., 0] != last.codes[..., 1]).float().mean()


report(
    one_pass_fails_in_about_half=bool(abs(disagree(1) - 0.5) < 0.05),
    two_passes_fail=disagree(2),
)

# %% [markdown]
# In a pass each token is drawn for itself, as if the others were not being drawn, too. So decode in $T$ steps. In each, draw *all* that is hidden, keep the surest, and **hide the rest again**. After
# step $k$, with $r = k / T$, so many of the $N$ tokens that were hidden at the start are hidden:
#
# $$\lfloor N \cos(r \pi / 2) \rfloor, \text{ but at least one less than before}$$
#
# ### Exercise 06-3: how many are hidden again
#
# ●●○ · 12 minutes · [PT A.2]
#
# A list with a number for each step; the last is 0. Never below 0, even if the steps outnumber the tokens.


# %% tags=["s2g-exercise"]
def remask_counts(tokens, steps):
    """How many of `tokens` are hidden after each step: a list of whole numbers."""
    ...  # your code


# %% tags=["s2g-solution"]
def remask_counts(tokens, steps):
    """How many of `tokens` are hidden after each step: a list of whole numbers."""
    counts, hidden = [], tokens
    for step in range(1, steps + 1):
        cosine = int(np.floor(tokens * np.cos(step / steps * np.pi / 2)))
        hidden = max(0, min(cosine, hidden - 1))
        counts.append(hidden)
    return counts


# %% tags=["s2g-check", "nbval-ignore-output"]
remask_counts = check("06-3", remask_counts)

# %% tags=["s2g-source"]
show_solution("06-3")

# %%
report(
    eight_steps=remask_counts(88, 8),
    four_steps=remask_counts(88, 4),
    become_known=[-n for n in np.diff([88, *remask_counts(88, 8)])],
)

# %% [markdown]
# Two tokens at first, 17 at last: as more is known, more can be trusted at once. Which ones stay is decided by **confidence**: the log-probability of what was drawn, plus noise that fades,
#
# $$\log p + \tau\,(1 - r)\,\gamma, \qquad \tau = 4.5, \quad \gamma = -\log(-\log u) \text{ with } u \text{ between 0 and 1.}$$
#
# The noise $\gamma$ (**Gumbel noise**) is drawn anew for every token. Here is the whole algorithm.


# %%
@torch.no_grad()
def decoded(memory, speaker, steps, chance, noise=4.5):
    """The tokens after every step, by hand."""
    codes, states = predictor.hidden(memory), []
    for step, count in enumerate(remask_counts(88, steps), start=1):
        log_p = predictor.predict(memory, speaker, codes).log_softmax(-1)
        drawn = torch.multinomial(log_p.exp().flatten(0, 2), 1, generator=chance).view_as(codes)
        gumbel = -(-torch.rand(codes.shape, generator=chance).clamp_min(1e-20).log()).log()
        sure = log_p.gather(-1, drawn[..., None])[..., 0] + noise * (1 - step / steps) * gumbel
        sure[codes != MASK] = torch.inf  # what is known stays
        codes = torch.where(codes == MASK, drawn, codes)
        unsure = sure.flatten(1).argsort(dim=1)[:, :count]
        codes = codes.flatten(1).scatter(1, unsure, MASK).view_as(codes)
        states.append(codes)
    return states


def seed(number):
    """The same chance every time."""
    return torch.Generator().manual_seed(number)


by_hand = decoded(memory, asked.speaker, 8, seed(1))
package = predictor.decode(memory, asked.speaker, steps=8, generator=seed(1))
report(
    hidden_after_each_step=[int((codes == MASK).sum()) for codes in by_hand],
    same_as_the_package=all(
        torch.equal(mine, theirs.codes) for mine, theirs in zip(by_hand, package, strict=True)
    ),
)

# %% [markdown]
# What do more steps buy? Ask the Predictor itself: hide an eighth of the tokens that came out, and see how likely they are, given the rest; then the next eighth. Tokens that fit together are likely.
#
# Without noise the surest always win. See the square. Rare tokens then have little chance to stay early.

# %% tags=["s2g-figure"]
some = slice(0, 8)
heard = memories["own speech"][some]


@torch.no_grad()
def fit(codes):
    """Mean log-probability of a token, given seven eighths of the others."""
    part = torch.randperm(88, generator=seed(2)).view(22, 4) % 8
    found = []
    for number in range(8):
        shown = torch.where(part == number, MASK, codes)
        odds = predictor.predict(heard, many.speaker[some], shown).log_softmax(-1)
        found.append(odds.gather(-1, codes[..., None])[:, part == number])
    return torch.cat(found, dim=1).mean().item()


def last_tokens(steps, number=1, noise=4.5):
    """Where a decoding ends."""
    return decoded(heard, many.speaker[some], steps, seed(number), noise)[-1]


STEPS = 1, 2, 4, 8, 16
ends = {steps: last_tokens(steps) for steps in STEPS}
greedy = last_tokens(8, noise=0.0)
fits = [fit(ends[steps]) for steps in STEPS]
fig, axes = plt.subplots(figsize=(5.6, 3.4))
axes.plot(STEPS, fits, "o-", label="decoded")
axes.plot(8, fit(greedy), "s", label="without noise")
axes.axhline(fit(true[some]), color=PALETTE["black"], linestyle=":", label="true tokens")
axes.set_xscale("log", base=2)
axes.set_xticks(STEPS, list(map(str, STEPS)))
axes.minorticks_off()
axes.set(xlabel="steps (passes of the network)", ylabel="mean log-probability")
axes.legend(fontsize=10)
figure(
    fig,
    "How well the tokens of eight clips fit together, by the Predictor's own judgement. The price of steps is time: one pass each.",
    exact=False,
)
report(eight_steps_fit_better_than_one=fits[3] > fits[0])

# %% [markdown]
# ## 9. Listening harder
#
# The Predictor knows two things: what this speech asks for, and what gestures are like anyway. The second is easier to learn, and may drown the first. So in training one clip in ten was **not heard**: its speech was zeros. Now we can ask twice, and go on from the answer
# without speech, through the answer with it, and beyond:
#
# $$\ell = \ell_\text{unheard} + s\,(\ell_\text{heard} - \ell_\text{unheard})$$
#
# $\ell$ are **log-odds**, the numbers before the softmax, and $s$ is the **guidance**: 1 is none. It is [MDD Eq. B16], there for diffusion. The price is a second pass in every step. (Zeros are not silence: they are
# the mean of our log-mels.)
#
# What does speech decide? Above all *when*: hands turn on stressed vowels. After training, motion was sampled for 542 clips that no network was trained on, with five strengths of guidance. The record of the training says how well gestures kept time: the **beat margin**, by how
# much movements and stresses meet more often than by chance (1 is what real motion has; notebook 01 counts such meetings). And it says how fast the wrists were.

# %% tags=["s2g-figure"]
from s2glib.folders import runs_folder
from s2glib.recipes.predictor_scores import GUIDANCES, MARGINS, SPEED
from s2glib.recipes.records import recorded_figures

(record,) = recorded_figures(runs_folder(), "probtalk-predictor")


def recorded(name):
    """A figure for each guidance."""
    return np.array([record[f"{name}, guidance {s:g}"] for s in GUIDANCES])


margin, speed = sum(map(recorded, MARGINS)) / len(MARGINS), recorded(SPEED)
GUIDANCE = predictor.config.guidance
fig, axes = plt.subplots(figsize=(3.8, 2.2))
axes.plot(GUIDANCES, speed, "s--", label="wrist speed")
axes.plot(GUIDANCES, margin, "o-", label="beat margin")
axes.axhline(1, color=PALETTE["black"], linestyle=":")
axes.set(xlabel="guidance", ylabel="sampled / real", ylim=(0, 1.5))
axes.legend(fontsize=9)
figure(
    fig,
    "What guidance does: gestures keep time better, and wrists get faster. Dotted: real motion.",
)
chosen = GUIDANCES.index(GUIDANCE)
report(
    guidance_of_ours=GUIDANCE,
    unheard_in_training=LESSONS["teaching"].unheard,
    beat_margin_without_and_with=[margin[0], margin[chosen]],
    wrist_speed_without_and_with=[speed[0], speed[chosen]],
    gestures_keep_time_better=bool(margin[chosen] > margin[0]),
)

# %% [markdown]
# *When* was also a lesson of its own (ours): from each of the 22 vectors of the memory, a linear layer had to say in which of its 8 frames a stressed vowel begins. That layer is thrown away after training. Guidance is not free: hands also get faster. So
# the recipe took the best beats among those with wrists at most a fifth too fast.
#
# ## 10. Step by step
#
# Now watch one. While tokens are hidden, the body moves as the mean of what the Predictor expects: less at first than in the end.

# %% tags=["s2g-figure"]
from s2glib.viz import draw_tokens
from s2glib.widgets import UnmaskingStepper

body = mannequin()
stepper = UnmaskingStepper(probtalk, clip.waveform, body, speaker=int(asked.speaker))
fig, panels = plt.subplots(4, 2, figsize=(10, 6), sharex=True, sharey=True)
for number, axes in enumerate(panels.T.flat, start=1):
    stepper.go(number)
    state = stepper.state
    tables = state.log_p.numpy(), state.new.numpy()
    draw_tokens(axes, *tables, codes=CODES, seconds=PACE).set(title=f"after step {number}")
    axes.label_outer()
figure(
    fig,
    "A decoding in eight steps. Grey tokens are hidden, framed ones new; the brighter a token, the likelier was its code when it was chosen.",
    exact=False,
)
with torch.no_grad():
    without_speech = predictor.listen(0 * asked.speech, 0 * asked.given, nothing[None])
guided = {"unheard": without_speech, "guidance": GUIDANCE, "generator": seed(1)}
*_, final = predictor.decode(memory, asked.speaker, **guided)
moving = [state.motion.poses[:, :22].std(0).mean() for state in stepper.states]
report(
    known_after_each_step=[int(state.known.sum()) for state in stepper.states],
    the_body_moves_more_in_the_end=bool(moving[-1] > moving[0]),
    ends_where_the_package_ends=torch.equal(stepper.states[-1].codes, final.codes[0]),
)

# %% tags=["s2g-demo"]
stepper.go(0)
stepper

# %% [markdown]
# Three things to try:
#
# <details><summary>1. Go through the steps. Which tokens come first?</summary>
#
# Not simply the surest: at first, noise is larger than most differences. Look whether the probabilities rise as more is known.
# </details>
#
# <details><summary>2. Set the steps to 1, and look at the hands.</summary>
#
# The four tokens of a moment were drawn without knowing of each other. You may see poses that do not belong together, and jerks.
# </details>
#
# <details><summary>3. Try other draws. What stays the same?</summary>
#
# Compare the tables code by code, then look at pauses and at stressed syllables: what speech decides should stay, the rest is drawn.
# </details>
#
# ## 11. One sentence, three gestures
#
# Speech does not say what the hands do; many gestures fit. So a sample is the honest answer, not a mean. The whole pipeline, with the Refiner of notebook 07:

# %% tags=["s2g-figure"]
from s2glib.body import joint, joint_positions
from s2glib.viz import draw_bodies

samples = {
    f"sample {number}": probtalk.generate(
        clip.waveform, speaker=int(asked.speaker), generator=seed(number)
    )
    for number in (1, 2, 3)
}
again = probtalk.generate(clip.waveform, speaker=int(asked.speaker), generator=seed(1))
fig, panels = plt.subplots(3, 1, figsize=(5.2, 5), sharex=True)
for axes, (name, motion) in zip(panels, samples.items(), strict=True):
    draw_bodies(axes, motion, body, (0.8, 1.8, 2.8)).set(title=name)
    axes.label_outer()
figure(fig, "Three gestures for the same words and voice, at the same three moments.", exact=False)
WRISTS = [joint("left_wrist"), joint("right_wrist")]
places = [joint_positions(motion, body)[:, WRISTS] for motion in samples.values()]
distances = [(places[k] - places[k - 1]).norm(dim=-1).mean() for k in range(3)]
report(
    frames=len(places[0]),
    wrists_differ_by_more_than_a_centimetre=bool(min(distances) > 0.01),
    the_same_chance_gives_the_same_motion=torch.equal(again.poses, samples["sample 1"].poses),
)

# %% tags=["s2g-media", "nbval-ignore-output"]
from s2glib.widgets import Player

Player({name: samples[name] for name in ("sample 1", "sample 2")}, clip.waveform, body)

# %% [markdown]
# ## 12. Paper check
#
# | claim [PT A.2] | what we computed | verdict |
# |---|---|---|
# | "3 temporal convolution layers" for speech | 176 frames become 22, those of the tokens | holds; the code adds a projection before and a convolution beside each |
# | "10 gated convolution layers" | three of them must have stride 2, or context and speech do not meet | the text leaves that out |
# | "six decoder blocks, each ... followed by an AdaIN layer" | normalised over time, what a whole clip shares is lost; the code normalises over channels, three times a block, behind a gate | **wording**: two different layers |
# | 2-D places (code) | 6 pairs of tokens share a place | **flaw**, a small one |
# | curriculum 0.5 to 1 (code) | decoding meets shares down to 0.19 | **mismatch**: what training ends with is only the first step |
# | loss on all tokens (code) | those that are shown need only be copied | harmless, but says little |
# | steps | eight fit together better than one | holds |
#
# ## 13. Check yourself

# %%
ask("06-q1")

# %%
ask("06-q2")

# %%
ask("06-q3")

# %%
ask("06-q4")

# %% [markdown]
# And one without an answer: in which order would *you* fill in a gesture, from the start, from the strokes, or from the hands?
#
# ## Summary
#
# - The Predictor fills in hidden tokens, from speech, given motion, and the tokens that are known.
# - Strided convolutions bring all to the pace of tokens; gates, and a mask that goes in as well, let the network tell holes from poses.
# - A token must carry its place, and a sum of two equal waves is not enough.
# - AdaIN forgets what all tokens share; a layer norm forgets how strong each one is.
# - Guidance asks with and without speech, and goes on beyond: gestures keep time better.
# - Decoding in steps lets tokens see each other: draw all, keep the surest, hide the rest again.
#
# **Limits.** A token once chosen is never taken back, even if later ones show it wrong. And ours keeps time less than half as well as real gestures do, with hands that are
# faster than real ones. `evaluate probtalk` prints by how much.
#
# **Back:** [05 Product codes](05_product_codes.ipynb). **Next:** notebook 07 refines the motion, and keeps what is known.
