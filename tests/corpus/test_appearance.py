import numpy as np
import pytest

from s2glib.corpus.appearance import (
    HAIRS,
    HELD_OUT,
    OUTFITS,
    PEOPLE,
    PORTRAIT,
    SKINS,
    appearances,
)
from s2glib.corpus.script import SPEAKERS

TRAINED = [look for speaker in SPEAKERS for look in appearances(speaker)]


def test_every_speaker_of_the_script_has_a_face():
    assert tuple(PEOPLE) == SPEAKERS
    assert {person.skin for person in PEOPLE.values()} <= set(SKINS)
    assert {person.hair for person in PEOPLE.values()} <= set(HAIRS)


def test_no_two_people_look_alike():
    assert len(set(PEOPLE.values())) == len(PEOPLE)
    assert PORTRAIT.person not in PEOPLE.values()


@pytest.mark.parametrize("speaker", SPEAKERS)
def test_a_speaker_changes_clothes_and_room_but_stays_the_same_person(speaker):
    first, second = appearances(speaker)
    assert first.person == second.person == PEOPLE[speaker]
    assert first.outfit != second.outfit
    assert first.room != second.room


def test_the_held_out_looks_are_never_trained_on():
    names = {look.name for look in TRAINED}
    assert len(names) == 2 * len(SPEAKERS)
    assert {HELD_OUT.name, PORTRAIT.name}.isdisjoint(names)
    mine = [look for look in TRAINED if look.person == HELD_OUT.person]
    assert all(HELD_OUT.outfit != look.outfit and HELD_OUT.room != look.room for look in mine)
    assert PORTRAIT.outfit not in OUTFITS


def test_bare_skin_is_told_from_cloth():
    for look in TRAINED:
        distance = np.subtract(SKINS[look.person.skin], look.outfit.cloth)
        assert np.abs(distance).max() > 20, look.name


def test_an_unknown_speaker_is_refused():
    with pytest.raises(ValueError, match="voice_01 to voice_30"):
        appearances("voice_31")
