"""Questions of notebook 06: what is given, places, one pass and several, masks in training.

Paper:    PT A.2
Notebook: notebooks/06_masked_prediction.ipynb
"""

from s2glib.teaching.questions.question import Option, Question

PREDICT = (
    Question(
        "06-p1",
        "Frames that are not given are set to 0. Features are standardised, so that 0 is also "
        "their mean. How can the network tell a frame that is not given from one at the mean?",
        (
            Option(
                "By one more number for each frame.",
                "The mask goes in beside the motion: 1 where it is given, 0 where it is not. "
                "Without it the two would look the same.",
                right=True,
            ),
            Option(
                "A real frame never is exactly at the mean.",
                "True, but a pose near the mean would look nearly like one that is not given, and "
                "networks are smooth.",
            ),
            Option(
                "It cannot, and it does not matter.",
                "It matters: a frame that is given must be met, one that is not may be anything.",
            ),
        ),
    ),
    Question(
        "06-p2",
        "Tokens lie in a table of 22 times and 4 groups. The place of a token is the wave of its "
        "time plus the same kind of wave of its group. Can two tokens have the same place?",
        (
            Option(
                "No: 88 tokens, 88 different sums.",
                "The vectors are long enough for that. But a sum does not know which of its "
                "terms came first.",
            ),
            Option(
                "Yes, such as token 1 of group 2 and token 2 of group 1.",
                "Both get the wave of 1 plus the wave of 2. Six such pairs exist.",
                right=True,
            ),
            Option(
                "Yes, all tokens of one time.",
                "Their groups differ, and so do the waves that are added for these.",
            ),
        ),
    ),
    Question(
        "06-p3",
        "Two tokens always agree: both say left or both say right, each half of the time. A "
        "perfect network draws both in one pass. How often do they disagree?",
        (
            Option(
                "Never, since the network is perfect.",
                "It is perfect: for each place it gives one half to left and one half to right. "
                "But the two are then drawn without knowing of each other.",
            ),
            Option(
                "In a quarter of all draws.",
                "That is how often both say left. There are two ways to disagree, and each has a "
                "quarter.",
            ),
            Option(
                "In half of all draws.",
                "Each is drawn by itself, as two coins are. If the second could see the first, "
                "they would always agree.",
                right=True,
            ),
        ),
    ),
)

CHECK = (
    Question(
        "06-q1",
        "The speech adds the same vector to what is added to every token of a clip: an angry clip. "
        "Which style normalisation takes that away?",
        (
            Option(
                "The one over channels (layer norm).",
                "It takes the mean over the channels of each token. A vector with different "
                "numbers in its channels survives that.",
            ),
            Option(
                "The one over time (instance norm).",
                "What all tokens share is the mean of each channel over time, and just that is "
                "removed.",
                right=True,
            ),
            Option(
                "Both of them.",
                "Only one of the two looks along time. The other one never compares two tokens.",
            ),
        ),
    ),
    Question(
        "06-q2",
        "The curriculum ends with all tokens hidden, for every clip. What is the network no longer "
        "trained for then?",
        (
            Option(
                "To hear the speech.",
                "Speech is all that is left to it then: it is trained for nothing else.",
            ),
            Option(
                "To begin a decoding.",
                "The first step has all tokens hidden: just what it trains for at the end.",
            ),
            Option(
                "To finish a decoding.",
                "Seven of eight steps see tokens that are known already. The curriculum showed "
                "ever fewer of them, and never more than half.",
                right=True,
            ),
        ),
    ),
    Question(
        "06-q3",
        "What does the Gumbel noise change, which is added to the log-probabilities after the "
        "codes are drawn?",
        (
            Option(
                "Which of the drawn codes stay.",
                "The codes themselves are drawn before, without it. The noise decides who counts "
                "as sure, less and less as the steps go on.",
                right=True,
            ),
            Option(
                "Which codes are drawn.",
                "They are drawn before, by the probabilities alone. (There is a trick that draws "
                "with Gumbel noise, but it is not used here.)",
            ),
            Option(
                "How many tokens become known.",
                "That is the schedule's affair: 86 hidden, then 81, whatever the noise.",
            ),
        ),
    ),
    Question(
        "06-q4",
        "A decoder of eight steps is asked for 88 steps instead. How does it work then?",
        (
            Option(
                "The result is the same, only later.",
                "In each step fewer tokens are drawn together, so more of them can see each other. "
                "That changes the result.",
            ),
            Option(
                "One token at a time.",
                "At least one becomes known in each step. So every token sees all that were chosen "
                "before it, at eleven times the cost.",
                right=True,
            ),
            Option(
                "It stops early, having no tokens left.",
                "88 tokens last for 88 steps, one in each: the schedule takes care of that.",
            ),
        ),
    ),
)

QUESTIONS = (*PREDICT, *CHECK)
