"""How the speakers look: thirty people with two outfits each, a third one, and a stranger.

Everything that the renderer can vary stands in the tables of this page. A person's skin, hair and
build stay; clothes and room change with the outfit.

Paper:    MDD 4.1 (speakers and their clothes in PATS)
Notebook: notebooks/03_motion_decoupling.ipynb
"""

from dataclasses import dataclass
from typing import NamedTuple

from s2glib.corpus.script import SPEAKERS

Color = tuple[int, int, int]

SKINS: dict[str, Color] = {
    "ivory": (248, 218, 198),
    "rose": (240, 200, 178),
    "sand": (229, 184, 148),
    "olive": (208, 160, 118),
    "amber": (187, 132, 92),
    "bronze": (152, 101, 70),
    "umber": (118, 76, 54),
    "ebony": (86, 56, 44),
}
HAIRS: dict[str, Color] = {
    "black": (34, 30, 34),
    "espresso": (62, 42, 34),
    "chestnut": (104, 64, 40),
    "copper": (168, 86, 40),
    "honey": (190, 142, 78),
    "blond": (222, 186, 116),
    "silver": (186, 186, 190),
    "plum": (110, 52, 84),
    "teal": (38, 116, 120),
}


class Person(NamedTuple):
    """What stays when someone changes clothes."""

    skin: str
    hair: str
    hair_style: str  # short parted crop curls bald bob long bun tail scarf
    glasses: bool = False
    beard: bool = False
    build: float = 1.0  # width of the trunk


class Outfit(NamedTuple):
    """What somebody wears, and two colours of it."""

    cloth: Color
    accent: Color
    pattern: str  # stripes checks dots plain pinstripes argyle
    neckline: str  # crew vee shirt roll jacket
    rolled_sleeves: bool = False


class Room(NamedTuple):
    """Where the camera stands: the colour of the wall, and what is on it."""

    wall: Color
    scene: str  # shelf window pictures board plant


PEOPLE: dict[str, Person] = {
    "voice_01": Person("sand", "espresso", "short"),
    "voice_02": Person("umber", "black", "crop", beard=True, build=1.06),
    "voice_03": Person("ivory", "copper", "parted", glasses=True),
    "voice_04": Person("olive", "black", "short", beard=True),
    "voice_05": Person("bronze", "black", "long"),
    "voice_06": Person("rose", "blond", "bob", build=0.94),
    "voice_07": Person("ebony", "black", "curls", build=0.95),
    "voice_08": Person("sand", "plum", "scarf", build=0.96),
    "voice_09": Person("rose", "silver", "bald", glasses=True, build=1.08),
    "voice_10": Person("amber", "espresso", "curls", beard=True),
    "voice_11": Person("sand", "black", "parted", build=0.95),
    "voice_12": Person("umber", "espresso", "bun", glasses=True),
    "voice_13": Person("ivory", "chestnut", "tail", build=0.93),
    "voice_14": Person("olive", "black", "bob", glasses=True, build=0.94),
    "voice_15": Person("bronze", "black", "crop", build=1.08),
    "voice_16": Person("rose", "honey", "curls", build=1.02),
    "voice_17": Person("ebony", "black", "bald", beard=True, build=1.06),
    "voice_18": Person("amber", "teal", "scarf", glasses=True),
    "voice_19": Person("ivory", "blond", "short", beard=True, build=1.05),
    "voice_20": Person("umber", "black", "short", glasses=True),
    "voice_21": Person("rose", "copper", "curls", build=0.96),
    "voice_22": Person("olive", "chestnut", "parted", beard=True),
    "voice_23": Person("sand", "silver", "bun", glasses=True, build=1.04),
    "voice_24": Person("amber", "black", "short", build=0.88),
    "voice_25": Person("bronze", "chestnut", "tail"),
    "voice_26": Person("ivory", "black", "parted", glasses=True),
    "voice_27": Person("sand", "silver", "crop", beard=True, build=1.04),
    "voice_28": Person("ebony", "plum", "bun", build=0.95),
    "voice_29": Person("amber", "black", "crop", glasses=True, build=1.1),
    "voice_30": Person("rose", "chestnut", "curls", beard=True, glasses=True),
}
OUTFITS: tuple[Outfit, ...] = (
    Outfit((58, 84, 156), (232, 230, 222), "stripes", "crew"),
    Outfit((172, 62, 58), (240, 202, 128), "checks", "shirt"),
    Outfit((56, 118, 86), (222, 232, 196), "dots", "vee"),
    Outfit((70, 74, 88), (206, 214, 228), "pinstripes", "jacket"),
    Outfit((214, 158, 60), (120, 66, 44), "stripes", "roll"),
    Outfit((112, 74, 140), (226, 198, 230), "argyle", "vee"),
    Outfit((212, 220, 230), (62, 92, 140), "pinstripes", "shirt", rolled_sleeves=True),
    Outfit((38, 122, 136), (238, 214, 150), "dots", "crew"),
    Outfit((124, 54, 72), (226, 172, 160), "plain", "jacket"),
    Outfit((96, 130, 70), (48, 66, 50), "checks", "shirt", rolled_sleeves=True),
    Outfit((48, 54, 74), (216, 96, 78), "stripes", "crew"),
    Outfit((206, 112, 92), (250, 228, 206), "dots", "roll"),
    Outfit((92, 142, 190), (250, 246, 232), "checks", "shirt"),
    Outfit((150, 104, 66), (236, 216, 178), "argyle", "vee"),
    Outfit((44, 88, 76), (206, 190, 120), "plain", "jacket"),
)
ROOMS: tuple[Room, ...] = (
    Room((184, 198, 194), "shelf"),
    Room((214, 200, 176), "pictures"),
    Room((172, 184, 210), "window"),
    Room((206, 188, 196), "plant"),
    Room((190, 206, 178), "board"),
    Room((222, 212, 202), "shelf"),
    Room((164, 190, 200), "pictures"),
)


@dataclass(frozen=True)
class Appearance:
    """One look of one person: everything the renderer needs besides the motion."""

    name: str
    person: Person
    outfit: Outfit
    room: Room


def _appearance(speaker: str, wardrobe: int) -> Appearance:
    number = SPEAKERS.index(speaker)
    outfit = OUTFITS[(number + 4 * wardrobe + number // len(OUTFITS)) % len(OUTFITS)]
    room = ROOMS[(number + 3 * wardrobe) % len(ROOMS)]
    return Appearance(f"{speaker}/{'abc'[wardrobe]}", PEOPLE[speaker], outfit, room)


def appearances(speaker: str) -> tuple[Appearance, Appearance]:
    """The two looks of a speaker that models may train on.

    Raises:
        ValueError: if the script has no such speaker.
    """
    if speaker not in PEOPLE:
        raise ValueError(f"speakers are voice_01 to voice_{len(PEOPLE)}, got {speaker!r}")
    return _appearance(speaker, 0), _appearance(speaker, 1)


HELD_OUT = _appearance("voice_01", 2)
"""A third look of voice_01. No model trains on it: a known person in unknown clothes."""

PORTRAIT = Appearance(
    "portrait",
    Person("bronze", "honey", "long", glasses=True),
    Outfit((196, 74, 122), (250, 222, 120), "argyle", "roll"),
    Room((150, 170, 156), "window"),
)
"""Somebody no model trains on: neither the person, nor the clothes, nor the wall."""
