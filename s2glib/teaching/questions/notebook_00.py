"""Questions of notebook 00: the set-up, a swap, its measure, and the map.

Paper:    AM A, Fig. A.4
Notebook: notebooks/00_start_here.ipynb
"""

from s2glib.teaching.questions.question import Option, Question

QUESTIONS = (
    Question(
        "00-q1",
        "One of the lines above says DOES NOT WORK. What do you do first?",
        (
            Option(
                "Run what that line says, then restart the notebook.",
                "Each line knows its own cure. After a restart, run the cell again to see "
                "whether it helped.",
                right=True,
            ),
            Option(
                "Go on, because the other lines say that their parts work.",
                "A part that is missing comes back later as an error in the middle of a lesson, "
                "where its cause is hard to see.",
            ),
            Option(
                "Search the internet for the message.",
                "You would find cures for other people's computers. The cure for yours stands at "
                "the end of the line.",
            ),
        ),
    ),
    Question(
        "00-p1",
        "The network gestures one angry sentence twice, the second time with the emotion latent of "
        "sadness. How will the second motion differ?",
        (
            Option(
                "It takes longer, because sad people speak slowly.",
                "Nobody speaks sadly here. Both bodies follow the same angry sound, so both "
                "motions last as long as the sound.",
            ),
            Option(
                "Not at all: the sound is the same, and so is the noise.",
                "The network does not gesture from the sound. It gestures from the latents, "
                "and one of the three has changed.",
            ),
            Option(
                "In posture and in the hands; it lasts as long.",
                "The latent of the emotion guides every step from the noise to the motion, "
                "so the body changes. The sound stays, and with it the length.",
                right=True,
            ),
        ),
    ),
    Question(
        "00-p2",
        "Order the eight emotions from slow to fast hands: once in the corpus, once after swaps. "
        "How alike will the two orders be?",
        (
            Option(
                "The same, because the network learned from the corpus.",
                "It learned, but it copies no clip: it makes new motions, and not all emotions "
                "come out as they were. The figure shows where.",
            ),
            Option(
                "Similar, with some emotions out of place.",
                "The network learned a good part of what sets the emotions apart, not all of it. "
                "How much is a question for a number.",
                right=True,
            ),
            Option(
                "Unrelated, because every motion starts from random noise.",
                "The noise decides details. The latent of the emotion steers away from it, and it "
                "does so in every swap.",
            ),
        ),
    ),
    Question(
        "00-q2",
        "You want to build the part of AMUSE that takes content, emotion and style apart. Which "
        "notebooks does the map send you to?",
        (
            Option(
                "02 and 03",
                "They stand in the same column, but in the row of S2G-MDDiffusion. There a "
                "picture is written as moving keypoints.",
            ),
            Option(
                "08 and 09",
                "They stand below the second step in the row of AMUSE. Read the map like this: "
                "find the row of the system, then the step.",
                right=True,
            ),
            Option(
                "10 and 13",
                "They come one step later: there the latents are used to make a motion out of "
                "noise.",
            ),
        ),
    ),
)
