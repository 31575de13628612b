import matplotlib
import pytest
import torch
import traitlets
from matplotlib.figure import Figure
from stand_in import capsule_body, tone, waving_motion
from stand_in_probtalk import small_probtalk

from s2glib.body import Motion, joint, joint_positions
from s2glib.papers.probtalk import JOINTS_OF, PARTS
from s2glib.widgets import MaskPainter, Player
from s2glib.widgets.mask_painter import AFTER, BEFORE, FIELD

matplotlib.use("Agg")
FIELDS = 12  # 90 frames, the last field being a quarter of one
NONE, ALL = "0" * FIELDS, "1" * FIELDS


@pytest.fixture(scope="module")
def probtalk():
    return small_probtalk()


@pytest.fixture
def painter(probtalk):
    speakers = {"one": 0, "two": 5}
    return MaskPainter(probtalk, tone(), waving_motion(90), capsule_body(), speakers)


def news(painter, **change):
    """What the page sends."""
    timeline = painter.timeline
    timeline.heard = {
        "number": timeline.order["number"],
        "kept": timeline.kept,
        "pressed": timeline.pressed,
        **change,
    }


def test_it_begins_with_a_gap_that_was_filled(painter):
    assert painter.timeline.kept == ["111100001111"] * 4
    assert painter.stays
    mask = painter.context_mask
    assert mask.shape == (90, 4)
    assert mask[:32].all()
    assert not mask[32:64].any()
    assert mask[64:].all()


def test_a_field_is_a_token_of_one_part(painter):
    painter.paint([NONE, NONE, "000001000000", NONE])
    places = painter.context_mask.nonzero().tolist()
    assert places == [[frame, 2] for frame in range(5 * FIELD, 6 * FIELD)]


def test_what_is_kept_stays_and_all_else_is_made_by_probtalk(painter, probtalk):
    painter.paint([ALL, NONE, "111111000000", ALL])
    made = painter.make()
    known = waving_motion(90)
    expected = probtalk.generate(
        tone(),
        known=known,
        context_mask=painter.context_mask,
        speaker=0,
        generator=torch.Generator().manual_seed(2),
    )
    assert torch.equal(made.poses, expected.poses)
    same = made.poses == known.poses
    for part, kept in zip(PARTS, painter.context_mask.T, strict=True):
        assert torch.equal(same[:, list(JOINTS_OF[part])].all(-1).all(-1), kept)


def test_the_player_shows_both_with_their_sound(painter):
    painter.paint([ALL, NONE, ALL, ALL])
    painter.make()
    pair = {BEFORE: waving_motion(90), AFTER: painter.motion}
    expected = Player(pair, tone(), capsule_body())
    assert painter.player.motion == expected.motion
    assert painter.player.sound == expected.sound


def test_every_take_is_another_one(painter):
    painter.paint([NONE] * 4)
    assert not torch.equal(painter.make().poses, painter.make().poses)


def test_another_speaker_makes_another_motion(painter, probtalk):
    painter.paint([NONE] * 4)
    painter.speaker.value = 5
    expected = probtalk.generate(tone(), speaker=5, generator=torch.Generator().manual_seed(2))
    assert torch.equal(painter.make().poses, expected.poses)


def test_if_all_is_kept_it_is_the_original(painter):
    painter.paint([ALL] * 4)
    assert torch.equal(painter.make().poses, waving_motion(90).poses)
    assert "100% is kept, bit for bit. The wrists go up to 0 cm" in painter.told.value


def test_the_share_and_the_way_of_the_wrists_are_told(painter):
    painter.paint([ALL, NONE, NONE, ALL])
    made = painter.make()
    wrists = [joint("left_wrist"), joint("right_wrist")]
    pair = (joint_positions(each, capsule_body())[:, wrists] for each in (made, waving_motion(90)))
    far = torch.stack(tuple(pair)).diff(dim=0).norm(dim=-1).max()
    said = f"Take 2: 50% is kept, bit for bit. The wrists go up to {100 * far:.0f} cm"
    assert said in painter.told.value
    assert 'role="status"' in painter.told.value


def test_a_kept_joint_that_moved_would_be_seen(painter):
    painter.paint([ALL, NONE, NONE, NONE])
    made = painter.make()
    poses = made.poses.clone()
    poses[40, joint("jaw"), 0] += 1e-6
    painter.motion = Motion(poses, made.trans, made.expression, made.fps)
    assert not painter.stays


def test_what_was_made_is_judged_by_the_painting_it_was_made_from(painter):
    painter.paint([ALL, NONE, NONE, NONE])
    painter.make()
    painter.paint([ALL] * 4)
    assert painter.stays
    news(painter, kept=[NONE, ALL, NONE, NONE])
    assert painter.stays


def test_fields_painted_in_the_page_are_heard_and_make_nothing_yet(painter):
    before = painter.motion
    news(painter, kept=[ALL, NONE, NONE, NONE])
    assert painter.timeline.kept == [ALL, NONE, NONE, NONE]
    assert painter.motion is before


def test_the_button_makes_what_is_painted_and_is_answered(painter):
    news(painter, kept=[NONE, ALL, NONE, NONE], pressed=1)
    assert painter.timeline.done == 1
    assert torch.equal(painter.context_mask.any(0), torch.tensor([False, True, False, False]))
    assert painter.stays
    assert "Take 2: 25%" in painter.told.value


def test_news_from_before_an_order_is_not_believed_but_the_button_is(painter):
    painter.paint([ALL, NONE, NONE, NONE])
    news(painter, number=0, kept=[NONE] * 4, pressed=1)
    assert painter.timeline.kept == [ALL, NONE, NONE, NONE]
    assert painter.timeline.done == 1


def test_a_burst_of_paintings_makes_one_motion_when_asked(painter):
    for k in range(200):
        news(painter, kept=["01"[k % 2] * FIELDS] * 4)
    assert "Take 1" in painter.told.value
    news(painter, pressed=1)
    news(painter, kept=[NONE] * 4)
    assert "Take 2" in painter.told.value


def test_the_button_is_offered_again_after_a_fault(painter, monkeypatch):
    def fail():
        raise RuntimeError("no")

    monkeypatch.setattr(painter, "make", fail)
    with pytest.raises(RuntimeError, match="no"):
        news(painter, pressed=1)
    assert painter.timeline.done == 1


@pytest.mark.parametrize("frames", [70, 89, 91, 110])
def test_a_motion_may_end_before_the_speech_or_after_it(probtalk, frames):
    painter = MaskPainter(probtalk, tone(), waving_motion(frames), capsule_body(), {"one": 0})
    painter.paint(["1" * len(painter.timeline.kept[0])] * 4)
    assert painter.make().frames == len(painter.context_mask) == 90
    assert int(painter.context_mask.all(-1).sum()) == min(frames, 90)
    assert painter.stays


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize(
    "kept", [[ALL] * 3, [ALL[1:]] * 4, ["2" * FIELDS] * 4, [ALL, ALL, ALL, ALL[1:]]]
)
def test_what_is_no_painting_is_refused(painter, kept):
    with pytest.raises(ValueError, match="4 rows of 12 zeros and ones"):
        painter.paint(kept)


@pytest.mark.usefixtures("without_type_hook")
def test_what_makes_no_motion_is_refused(probtalk):
    rest = tone(), waving_motion(90), capsule_body()
    with pytest.raises(TypeError, match="must be a ProbTalk, got PQVAE"):
        MaskPainter(probtalk.pqvae, *rest, {"one": 0})
    with pytest.raises(TypeError, match="speech comes as a Waveform, got NoneType"):
        MaskPainter(probtalk, None, *rest[1:], {"one": 0})
    with pytest.raises(TypeError, match="known must be a Motion, got Tensor"):
        MaskPainter(probtalk, tone(), rest[1].poses, rest[2], {"one": 0})
    with pytest.raises(ValueError, match="numbered 0 to 23"):
        MaskPainter(probtalk, *rest, {"one": 24})


def test_python_and_page_never_write_the_same_trait(painter):
    with pytest.raises(traitlets.TraitError):
        painter.timeline.kept = [NONE] * 4
    before = painter.timeline.heard
    painter.paint([NONE] * 4)
    assert painter.timeline.heard == before


def test_drawn_it_shows_the_rows(painter):
    axes = Figure().add_subplot()
    assert painter.draw(axes) is axes
    names = [label.get_text() for label in axes.get_yticklabels()]
    assert names == ["face", "body", "left hand", "right hand"]
    assert axes.get_xlim() == (0, 3)


def test_its_words_never_change(painter):
    before = repr(painter)
    painter.paint([NONE] * 4)
    assert repr(painter) == before
    assert before.startswith("MaskPainter")
