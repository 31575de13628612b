"""Questions of notebook 02: holes, bending, coinciding points, and what a spline is made of.

Paper:    MDD Sup. A, E
Notebook: notebooks/02_thin_plate_splines.ipynb
"""

from s2glib.teaching.questions.question import Option, Question

PREDICT = (
    Question(
        "02-p1",
        "You make a picture 1.5 times as large by carrying each pixel to its new place. What share "
        "of the new pixels gets no colour at all?",
        (
            Option(
                "None: no pixel is lost on the way.",
                "None is lost, but there are not enough of them: the same pixels now have 2.25 "
                "times the area to cover.",
            ),
            Option(
                "A few, along the edges.",
                "The edges are well covered: what was near them has left the picture. The holes "
                "are everywhere between the pixels.",
            ),
            Option(
                "More than half.",
                "An area of 2.25 gets the pixels of an area of 1. At most 1 / 2.25 = 44 % of the "
                "new pixels can be hit, so 56 % are holes.",
                right=True,
            ),
        ),
    ),
    Question(
        "02-p2",
        "Turn all five points by 90 degrees about the middle. How much bending energy does the "
        "spline have that follows them?",
        (
            Option(
                "None.",
                "A turn is affine: the plates tilt, but stay flat. The energy counts second "
                "derivatives only, and those of a plane are zero.",
                right=True,
            ),
            Option(
                "As much as the spline before.",
                "The size of a movement does not matter, only whether it bends. Here all points "
                "move together.",
            ),
            Option(
                "A lot, since every point moves far.",
                "Every point moves far, but a flat, tilted plate goes through all of them. It "
                "takes no force to tilt a plate.",
            ),
        ),
    ),
    Question(
        "02-p3",
        "Drive two points to the same place, though they come from different ones. What does the "
        "exact spline do?",
        (
            Option(
                "It shows the mean of the two.",
                "That is what it should do, and what a ridge does. But an exact spline promises "
                "both values at once.",
            ),
            Option(
                "There is none.",
                "One place cannot show two points of the source. Two rows of L are equal, so it "
                "has no inverse.",
                right=True,
            ),
            Option(
                "It takes the later point.",
                "A program that overwrites would. In a linear system all points count alike, and "
                "here they contradict each other.",
            ),
        ),
    ),
)

CHECK = (
    Question(
        "02-q1",
        "MDD's spline has 5 keypoint pairs. How many numbers describe its map?",
        (
            Option(
                "6",
                "That is the affine part alone: 3 numbers for x and 3 for y. The bends are "
                "missing.",
            ),
            Option(
                "10",
                "These are the weights: 5 for x, 5 for y. Without the affine part no plate could "
                "be flat.",
            ),
            Option(
                "16",
                "Five weights and three affine numbers, each for x and y: 2 x 8. The centers are "
                "the driving points, known beforehand.",
                right=True,
            ),
        ),
    ),
    Question(
        "02-q2",
        "You want to know where the nose of the source picture is seen in the warped one. Which "
        "spline tells it, nearly?",
        (
            Option(
                "fit_tps(source, driving)",
                "It leads forward. Only nearly, because the inverse of a spline is no spline: "
                "between the points the two differ a little.",
                right=True,
            ),
            Option(
                "fit_tps(driving, source)",
                "That leads backward, from a pixel of the warped picture to the source. Here you "
                "start in the source.",
            ),
            Option(
                "None, a spline has no way back.",
                "Swap the roles of the points, and another spline leads back. It meets the control "
                "points exactly.",
            ),
        ),
    ),
    Question(
        "02-q3",
        "One of five points moves by 0.1. Which pixels change the place where they look?",
        (
            Option(
                "Those within 0.1 of the point.",
                "U does not fall to zero with distance. It even grows.",
            ),
            Option(
                "Nearly all of them.",
                "A plate is stiff: push at one point, and all of it bends. So MDD mixes 20 splines "
                "and a map that leaves the background alone.",
                right=True,
            ),
            Option(
                "Those between it and the next points.",
                "That is so for straight pieces, as in a mesh of triangles. A plate has no pieces.",
            ),
        ),
    ),
    Question(
        "02-q4",
        "Why does an error in a region's covariance do more harm than one in a keypoint?",
        (
            Option(
                "A covariance has more numbers.",
                "Three numbers against two for one keypoint, and a spline has many keypoints. "
                "Counting does not explain it.",
            ),
            Option(
                "Its numbers are larger than a keypoint's.",
                "They are much smaller, being squares of widths. That is a part of the trouble: "
                "little is needed to reach zero.",
            ),
            Option(
                "The map divides by a width near zero.",
                "A thin arm, a slightly too thin prediction, and the ratio of the widths runs "
                "away. An error in a keypoint is never divided.",
                right=True,
            ),
        ),
    ),
)

QUESTIONS = (*PREDICT, *CHECK)
