from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pytest
import torch
from stand_in import capsule_body

from s2glib.body import joint, joint_positions
from s2glib.papers.probtalk import PQVAE, TEACHING_PQVAE
from s2glib.widgets import CodebookExplorer, Player
from s2glib.widgets.codebook_explorer import AFTER, BEFORE

SMALL = replace(TEACHING_PQVAE, widths=(8, 8, 12, 16), straight=0, latent=16, codes=6)


@pytest.fixture(scope="module")
def model():
    torch.manual_seed(0)
    model = PQVAE(SMALL)
    model.quantizer.codebooks.mul_(9)  # so that codes differ visibly
    return model.eval()


@pytest.fixture(scope="module")
def codes():
    return torch.randint(6, (5, 4), generator=torch.Generator().manual_seed(1))


@pytest.fixture
def explorer(model, codes):
    return CodebookExplorer(model, codes, capsule_body())


def other(codes, token, group):
    """A code that does not stand there."""
    return (int(codes[token, group]) + 1) % 6


def test_it_begins_with_the_clip_as_it_was_coded(explorer, codes):
    assert explorer.code.value == codes[0, 0]
    assert torch.equal(explorer.edited, codes)
    assert set(explorer.moved.values()) == {0.0}
    assert f"the clip's own code, {int(codes[0, 0])}" in explorer.told.value


def test_both_motions_are_what_the_model_decodes(explorer, model, codes):
    explorer.choose(token=2, group=3, code=other(codes, 2, 3))
    edited = codes.clone()
    edited[2, 3] = other(codes, 2, 3)
    for name, row in {BEFORE: codes, AFTER: edited}.items():
        with torch.no_grad():
            features = model.decode(row[None])[0]
        motion = explorer.motions[name]
        assert torch.equal(motion.poses, model.features.to_poses(features))
        assert torch.equal(motion.expression, model.features.to_expression(features))


def test_the_player_shows_both_from_where_the_token_begins(explorer, codes):
    explorer.choose(token=3, group=1, code=other(codes, 3, 1))
    expected = Player(explorer.motions, None, capsule_body())
    assert explorer.player.motion == expected.motion
    assert explorer.player.frame == 3 * 8


def test_another_place_begins_with_the_code_that_stands_there(explorer, codes):
    explorer.choose(token=3, group=1, code=other(codes, 3, 1))
    explorer.group.value = 2
    assert explorer.code.value == codes[3, 2]
    assert torch.equal(explorer.edited, codes)
    assert explorer.player.motion == Player(explorer.motions, None, capsule_body()).motion


def test_how_far_it_moves_the_body_is_said_in_centimetres(explorer, codes):
    explorer.choose(token=2, group=0, code=other(codes, 2, 0))
    before, after = (joint_positions(m, capsule_body()) for m in explorer.motions.values())
    wrist = joint("left_wrist")
    expected = (after - before)[:, wrist].norm(dim=-1).max().item()
    assert explorer.moved["left_wrist"] == pytest.approx(expected)
    most = max(explorer.moved, key=explorer.moved.get)
    said = f"<b>{most.replace('_', ' ')}</b>, by {100 * explorer.moved[most]:.1f} cm"
    assert said in explorer.told.value
    assert 'role="status"' in explorer.told.value


def test_uses_of_a_code_in_the_clip_are_counted_in_its_group(explorer, codes):
    code = other(codes, 2, 0)
    explorer.choose(token=2, group=0, code=code)
    assert f"uses this code {int((codes[:, 0] == code).sum())} times" in explorer.told.value


def test_without_a_kernel_both_bodies_are_drawn(explorer, codes):
    explorer.choose(token=2, group=0, code=other(codes, 2, 0))
    fig, axes = plt.subplots()
    assert explorer.draw(axes) is axes
    assert [label.get_text() for label in axes.get_xticklabels()] == [BEFORE, AFTER]
    assert axes.get_xlabel() == "token 2, group 0"
    widths = [
        np.ptp(np.concatenate([path.vertices[:, 0] for path in surface.get_paths()]))
        for surface in axes.collections
    ]
    assert len(widths) == len(set(widths)) == 2
    plt.close(fig)


def test_the_given_codes_stay_as_they_are(explorer, codes):
    before = codes.clone()
    explorer.choose(token=1, group=1, code=other(codes, 1, 1))
    assert torch.equal(codes, before)


def test_its_words_never_change(explorer, codes):
    before = repr(explorer)
    explorer.choose(token=1, group=1, code=other(codes, 1, 1))
    assert repr(explorer) == before
    assert before.startswith("CodebookExplorer")


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize(
    ("model_of", "codes_of", "error", "words"),
    [
        (lambda model: model.decoder, lambda codes: codes, TypeError, "must be a PQVAE"),
        (lambda model: model, lambda codes: codes.float(), TypeError, "integer codes"),
        (lambda model: model, lambda codes: codes[:, :3], ValueError, "4 codes on the last axis"),
        (lambda model: model, lambda codes: codes + 6, ValueError, r"0\.\.5"),
    ],
)
def test_what_does_not_fit_is_told(model, codes, model_of, codes_of, error, words):
    with pytest.raises(error, match=words):
        CodebookExplorer(model_of(model), codes_of(codes), capsule_body())
