"""Questions of notebook 07: jumps at borders, where a loss acts, and what it means to keep a part.

Paper:    PT A.3, Eqs. 8-10
Notebook: notebooks/07_refiner.ipynb
"""

from s2glib.teaching.questions.question import Option, Question

PREDICT = (
    Question(
        "07-p1",
        "The codes put a wrist 2 cm away from where it is. True frames are pasted into the decoded "
        "motion, 30 a second. By how much is the velocity of the wrist wrong where they meet?",
        (
            Option(
                "By 2 cm/s, which nobody sees.",
                "The 2 cm are not crossed in a second but from one frame to the next, in a "
                "thirtieth of it.",
            ),
            Option(
                "By 60 cm/s.",
                "2 cm in 1/30 s: as fast as a lively gesture, for one frame. Eyes are made to see "
                "that.",
                right=True,
            ),
            Option(
                "Not at all: both are motion.",
                "Before the border and after it, yes. From the last frame of one to the first of "
                "the other it has to make up for the error.",
            ),
        ),
    ),
    Question(
        "07-p2",
        "Where I = 1 the Refiner's input is the true motion, elsewhere it comes from codes. "
        "The first term of Eq. 10 compares output and truth where I = 1. "
        "What gradient does it send to the other frames of the output?",
        (
            Option(
                "None at all.",
                "No number of these frames occurs in the term. It asks for a copy of what the "
                "input already holds.",
                right=True,
            ),
            Option(
                "A small one, through attention.",
                "Attention mixes frames on the way to the output, and so the weights are shared. "
                "But the term does not look at these frames of the output.",
            ),
            Option(
                "The same as to all others.",
                "That would be so without a mask. With it, they are multiplied by 0.",
            ),
        ),
    ),
    Question(
        "07-p3",
        "We keep both hands of a clip, that is, the turns of all finger joints, and have the body "
        "made anew. Where are the hands in the new motion?",
        (
            Option(
                "In the same places; new arms must reach them.",
                "Kept is what the joints turn by, not where they are in space. Arms know nothing "
                "of places.",
            ),
            Option(
                "In the same places; the arms stay, too.",
                "Shoulders, elbows and wrists belong to the body here, and that is made anew.",
            ),
            Option(
                "Elsewhere, but in the same shapes.",
                "Finger turns are relative to the wrist, and the wrists go with the new arms: the "
                "fist stays a fist and travels.",
                right=True,
            ),
        ),
    ),
)

CHECK = (
    Question(
        "07-q1",
        "Train with Eq. 10 as it is printed. What do frames from codes still hear of the truth?",
        (
            Option(
                "Their places, through the first term.",
                "The first term is blind to them: they are masked out.",
            ),
            Option(
                "Their velocities, through the second term.",
                "It has no mask. But of their place only the steps at the two borders tell, and in "
                "clips where nothing is known, nothing.",
                right=True,
            ),
            Option(
                "Nothing at all.",
                "The second term has no mask, and a network's weights serve all frames.",
            ),
        ),
    ),
    Question(
        "07-q2",
        "A Refiner gives the true motion, but 2 cm too high in every frame. "
        "What are the velocity term, and the jump after known frames were put back?",
        (
            Option(
                "Both are zero.",
                "The first is. But known frames are put back where they belong, 2 cm below their "
                "neighbours.",
            ),
            Option(
                "Both are large.",
                "Velocities are right everywhere before known frames are put back: the term sees "
                "no error at all.",
            ),
            Option(
                "Zero, and 2 cm.",
                "The term was computed before known frames were put back. Put them back first, and "
                "it sees the jump.",
                right=True,
            ),
        ),
    ),
    Question(
        "07-q3",
        "Why one mean for jaw, body, hands and expression each, instead of one over all numbers?",
        (
            Option(
                "The jaw would hardly count.",
                "It has 6 of the numbers, the hands have 180. With one mean for each part, a "
                "number of the jaw weighs 30 times as much.",
                right=True,
            ),
            Option(
                "Parts have different units.",
                "They would, but all numbers were standardised before.",
            ),
            Option(
                "Masks may differ from part to part.",
                "They may, but one mean over all unknown numbers would cope with that.",
            ),
        ),
    ),
)

QUESTIONS = (*PREDICT, *CHECK)
