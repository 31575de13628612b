"""Questions of notebook 04: what a hand costs, what L1 paints in doubt, and who sees how far.

Paper:    MDD B.3
Notebook: notebooks/04_repairing_pixels.ipynb
"""

from s2glib.teaching.questions.question import Option, Question

PREDICT = (
    Question(
        "04-p1",
        "A hand weighs 5, the visible part of the picture weighs 1. How many times as much as a "
        "wrong pixel of the wall does a wrong pixel of a hand cost?",
        (
            Option(
                "5 times",
                "That would be so if all terms were divided by the same area. But each is divided "
                "by its own, and a hand is small.",
            ),
            Option(
                "About 20 times",
                "More: what counts is the ratio of the areas, and nearly the whole picture is "
                "visible, but hands are a fiftieth of it.",
            ),
            Option(
                "Hundreds of times",
                "5 for the weight, times some fifty: a small area shares the same weight among "
                "fewer pixels. The weight of 5 is the smaller part of it.",
                right=True,
            ),
        ),
    ),
    Question(
        "04-p2",
        "You must paint one picture, not knowing which frame of the film it will be compared with. "
        "Which one has the smallest L1 error on average?",
        (
            Option(
                "The median of each pixel.",
                "A sum of absolute distances is smallest at the median. Where a hand is seen less "
                "than half of the time, the median shows what is behind it.",
                right=True,
            ),
            Option(
                "Any sharp frame of the film.",
                "If its hands are not where they should be, it pays twice: for the hand that is "
                "missing, and for the one that is too many.",
            ),
            Option(
                "The mean of all frames.",
                "It shows every hand as a faint ghost. That is best for squared errors; for "
                "absolute ones it still is too much hand where there mostly is none.",
            ),
        ),
    ),
    Question(
        "04-p3",
        "Each block halves the picture, with a convolution of 4 x 4. How wide is the square of "
        "pixels that one number sees after eight of them?",
        (
            Option(
                "32 pixels",
                "4 times 8 would be right if no block halved the picture. Behind a halving, every "
                "step is worth two.",
            ),
            Option(
                "766 pixels",
                "3 x 2^8 - 2. A step at the eighth block is 128 pixels of the picture, and it "
                "takes four of them.",
                right=True,
            ),
            Option(
                "256 pixels",
                "The picture shrinks 256 times, but the squares overlap: each convolution looks at "
                "four numbers and moves by two.",
            ),
        ),
    ),
)

CHECK = (
    Question(
        "04-q1",
        "The authors' hand mask is a box, half as large again as the hand in it. What does that do "
        "to the cost of each pixel of the hand?",
        (
            Option(
                "It stays as it was.",
                "The weight of the whole term stays. It is divided by the area of the mask, and so "
                "shared among more pixels.",
            ),
            Option(
                "It falls by a third.",
                "The term is divided by the area, so each pixel gets a smaller share; the rest "
                "goes to wall and clothes in the corners of the box.",
                right=True,
            ),
            Option(
                "It grows by a half.",
                "There are more pixels in the mask, but the term is their mean, not their sum.",
            ),
        ),
    ),
    Question(
        "04-q2",
        "You shuffle the places of a feature map, the same way in all channels. What becomes of "
        "its Gram matrix?",
        (
            Option(
                "Nothing.",
                "It is a sum over places, and a sum does not mind the order. So it knows which "
                "channels go together, but not where.",
                right=True,
            ),
            Option(
                "Its rows are shuffled.",
                "Rows and columns are channels. These stay where they are; only places change.",
            ),
            Option(
                "It becomes diagonal.",
                "That would need channels which have nothing to do with each other. All channels "
                "move together here, so they stay as alike as before.",
            ),
        ),
    ),
    Question(
        "04-q3",
        "A critic scores patches of 93 pixels, in a picture of 256. Which fault can it not see?",
        (
            Option(
                "A hand with a blurred edge",
                "That is its best case: an edge lies well within a patch.",
            ),
            Option(
                "A face without eyes",
                "A face has about 50 pixels here, so one patch sees all of it.",
            ),
            Option(
                "Two left hands, far apart",
                "Each of them looks real, and no patch sees both. Whether the whole fits together "
                "must come from the other terms.",
                right=True,
            ),
        ),
    ),
    Question(
        "04-q4",
        "The released code shows `merge(prediction, refined, visible)`. Which repair gets lost?",
        (
            Option(
                "That of a face marked as visible",
                "Where the mask is 1 the decoupler's own pixel is shown, however wrong, though the "
                "loss made the network repair it.",
                right=True,
            ),
            Option(
                "That of all that is occluded",
                "This is what merging keeps: where the mask is 0, the refined pixel is shown.",
            ),
            Option(
                "None, it only blends",
                "It does blend, with the mask as share. A share of 1 for the prediction leaves "
                "nothing of the repair.",
            ),
        ),
    ),
)

QUESTIONS = (*PREDICT, *CHECK)
