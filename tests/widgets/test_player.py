import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stand_in import capsule_body, tone, waving_motion

from s2glib.widgets import Player

BODY = capsule_body()
SILENT = Player(waving_motion(), None, BODY)


@pytest.fixture
def player(motion, waveform):
    return Player(motion, waveform, BODY)


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 89))
def test_the_time_of_a_frame_leads_back_to_it(frame):
    SILENT.seek(frame / 30)
    assert SILENT.frame == frame
    assert SILENT.time == frame / 30


@settings(deadline=None, max_examples=30)
@given(st.lists(st.integers(-1000, 1000), min_size=1, max_size=50))
def test_a_burst_of_frames_ends_inside_the_motion(frames):
    for frame in frames:
        SILENT.seek(frame / 30)
    assert SILENT.frame == min(max(frames[-1], 0), 89)


def test_a_time_past_the_end_is_the_last_frame(player):
    player.seek(1e6)
    assert player.frame == 89


def test_another_motion_of_the_same_sound_sends_no_mesh_and_no_sound(player, waveform):
    sent = messages_of(player)
    player.show(waving_motion(reach=2.0), waveform)
    assert [set(message) for message in sent] == [{"motion"}]


def test_a_clip_is_swapped_in_one_message(player):
    sent = messages_of(player)
    player.show({"a": waving_motion(30), "b": waving_motion(40)}, tone(2, pitch=330))
    assert [set(message) for message in sent] == [{"motion", "sound", "order"}]


def test_a_burst_of_swaps_while_playing_leaves_the_last_clip(player, motion, waveform):
    last = Player(waving_motion(12), None, BODY)
    player.play()
    for frames in range(2, 13):
        player.show(waving_motion(frames), tone(frames / 30) if frames % 2 else None)
    assert (player.motion, player.sound) == (last.motion, last.sound)
    assert player.playing


def test_a_shorter_motion_of_the_same_sound_moves_the_frame_inside():
    player = Player(waving_motion(), None, BODY)
    player.seek(80 / 30)
    player.show(waving_motion(10), None)
    assert player.frame == 9


def test_another_sound_starts_from_the_beginning(player):
    player.seek(80 / 30)
    player.show(waving_motion(), tone(3, pitch=330))
    assert player.frame == 0


def test_news_from_before_an_order_is_not_believed(player):
    player.seek(2.0)
    player.heard = {"frame": (0, 5), "playing": (0, True)}
    assert (player.frame, player.playing) == (60, True)
    player.heard = {"frame": (1, 66), "playing": (0, False)}
    assert (player.frame, player.playing) == (66, False)


def test_news_is_not_sent_back_as_an_order(player):
    sent = messages_of(player)
    player.heard = {"frame": (0, 5), "playing": (0, True)}
    assert all("order" not in message for message in sent)
    assert player.frame == 5


def test_one_of_several_motions_is_seen_alone_by_name(motion):
    player = Player({"source": motion, "edited": motion}, None, BODY)
    player.view = "edited"
    with pytest.raises(ValueError, match="no motion is called 'other'"):
        player.view = "other"
    assert player.view == "edited"


def test_a_view_of_a_motion_that_is_gone_shows_all_again(motion):
    player = Player({"source": motion, "edited": motion}, None, BODY)
    player.view = "edited"
    player.show({"true target": motion}, None)
    assert player.view == ""


def test_its_words_never_change(player, waveform):
    before = repr(player)
    player.show(waving_motion(12), waveform)
    assert repr(player) == before
    assert len(before) < 110


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize("wrong", ["motion", "waveform", "body"])
def test_something_else_is_refused_by_name(motion, waveform, wrong):
    arguments = {"motion": motion, "waveform": waveform, "body": BODY, wrong: "a string"}
    with pytest.raises(TypeError, match=f"{wrong}.* got str"):
        Player(**arguments)


def test_no_motion_is_refused():
    with pytest.raises(ValueError, match="there is no motion"):
        Player({}, None, BODY)


def messages_of(player):
    """Every state that the player sends to the page from now on."""
    sent = []
    player.send_state = lambda key=None: sent.append(
        player.get_state(key) if not isinstance(key, str) else {key: getattr(player, key)}
    )
    return sent
