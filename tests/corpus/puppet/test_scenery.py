import numpy as np
import pytest

from s2glib.corpus.appearance import OUTFITS, ROOMS
from s2glib.corpus.puppet.drawing import Part
from s2glib.corpus.puppet.scenery import CLOTH_SIZE, backdrop, cloth_tile


@pytest.mark.parametrize(
    "outfit", OUTFITS, ids=lambda outfit: f"{outfit.pattern}-{outfit.neckline}"
)
def test_cloth_is_all_trunk_and_has_its_colour(outfit):
    tile = np.asarray(cloth_tile(outfit))
    assert tile.shape == (*CLOTH_SIZE[::-1], 4)
    assert (tile[..., 3] == Part.TRUNK).all()
    shares = [
        (np.abs(tile[..., :3] - np.array(c, float)).max(axis=-1) < 45).mean() for c in outfit[:2]
    ]
    assert shares[0] > 0.2
    assert (shares[1] > 0.03) == (outfit.pattern != "plain")


@pytest.mark.parametrize("room", ROOMS, ids=lambda room: room.scene)
def test_a_room_is_all_background_and_not_plain(room):
    picture = np.asarray(backdrop(room, 96))
    assert picture.shape == (96, 96, 4)
    assert (picture[..., 3] == Part.BACKGROUND).all()
    assert picture[..., :3].std(axis=(0, 1)).max() > 8


def test_a_room_looks_the_same_every_time():
    assert backdrop(ROOMS[0], 96).tobytes() == backdrop(ROOMS[0], 96).tobytes()
