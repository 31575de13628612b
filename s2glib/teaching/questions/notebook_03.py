"""Questions of notebook 03: motion and looks, mixed warps, masks, losses, and thin regions.

Paper:    MDD B.1, B.5, E
Notebook: notebooks/03_motion_decoupling.ipynb
"""

from s2glib.teaching.questions.question import Option, Question

PREDICT = (
    Question(
        "03-p1",
        "One speaker in two poses, and two speakers in the same pose. Which two pictures differ "
        "more, pixel by pixel?",
        (
            Option(
                "The two poses.",
                "Arms are what we look at, but they cover few pixels. Clothes, skin and wallpaper "
                "cover all the others.",
            ),
            Option(
                "The two speakers.",
                "Looks fill the whole picture, motion only a small part of it. Who learns pixels "
                "learns mostly wallpaper.",
                right=True,
            ),
            Option(
                "Both about equally.",
                "It would take a very wide gesture to change as many pixels as another wallpaper "
                "does.",
            ),
        ),
    ),
    Question(
        "03-p2",
        "Two warps disagree: one moves a stripe to the left, one to the right, both with weight "
        "1/2. You may mix the two pictures, or mix the two flows and look once. What do you see?",
        (
            Option(
                "Two pale stripes, and one full stripe.",
                "Mixed pictures show both answers, half transparent: a ghost. Mixed flows are one "
                "flow, and a flow shows each pixel one place.",
                right=True,
            ),
            Option(
                "The same: both are averages.",
                "A picture is not a linear function of where you look. An average of places is one "
                "place, an average of colours shows two.",
            ),
            Option(
                "One full stripe, and two pale stripes.",
                "It is the other way round: average the colours, and both stripes stay, each half "
                "as strong.",
            ),
        ),
    ),
    Question(
        "03-p3",
        "A region's spreads and five keypoints are predicted, every number with the same error. "
        "Now the region becomes 20 times thinner. What happens to the errors of its warp?",
        (
            Option(
                "They stay as they are.",
                "They would if numbers were only added. But the map divides by the predicted "
                "width.",
            ),
            Option(
                "They shrink with the region.",
                "The region shrinks, its error does not, and the map divides one by the other.",
            ),
            Option(
                "Some become many times larger.",
                "Whenever the error nearly eats up the width, the map divides by next to nothing. "
                "That is not often, but once a second is enough for a ghost.",
                right=True,
            ),
        ),
    ),
)

CHECK = (
    Question(
        "03-q1",
        "A pixel has the value 0 in the finest occlusion mask. Where does its colour come from?",
        (
            Option(
                "From the painter alone.",
                "1 means visible: keep the bent source. 0 means that the source has nothing to "
                "show there, so all of it is painted.",
                right=True,
            ),
            Option(
                "From the bent source alone.",
                "That is what 1 says. The name misleads: an occlusion mask marks what is not "
                "occluded.",
            ),
            Option(
                "From the background's map alone.",
                "The background has a weight map of its own, which says where to look. The mask "
                "says whether to believe what is seen there.",
            ),
        ),
    ),
    Question(
        "03-q2",
        "A lazy predictor puts its keypoints at the same places in every picture. Which of the "
        "three losses is content with that?",
        (
            Option(
                "The equivariance loss.",
                "It is the one that protests at once: bend the picture, and the keypoints must "
                "move. Lazy ones stay, and bent back they are elsewhere.",
            ),
            Option(
                "The warping loss.",
                "With points that never move, no warp moves anything. Features of the source then "
                "stay where the driving picture has others.",
            ),
            Option(
                "None of the three.",
                "Equivariance wants points that move with the picture. The two others want a flow "
                "that leads to the driving picture, and still points give none.",
                right=True,
            ),
        ),
    ),
    Question(
        "03-q3",
        "You drive a tall speaker's picture by the keypoints of a small one. What will go wrong?",
        (
            Option(
                "The looks of the small speaker shine through.",
                "They have no way in: of the driving film only keypoints pass.",
            ),
            Option(
                "The tall speaker gets the small one's build.",
                "Keypoints say where things are, and so how long arms are, too. Motion and looks "
                "are decoupled, motion and build are not.",
                right=True,
            ),
            Option(
                "Nothing, keypoints are pure motion.",
                "They are places in a picture. A place depends on the pose, but also on the "
                "body and on the camera.",
            ),
        ),
    ),
)

QUESTIONS = (*PREDICT, *CHECK)
