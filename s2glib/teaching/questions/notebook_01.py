"""Questions of notebook 01: turns, an arm, windows, onsets, strokes, and what a clip holds.

Paper:    MDD B.5, AM B.5, AM G, PT A.2
Notebook: notebooks/01_motion_and_sound.ipynb
"""

from s2glib.teaching.questions.question import Option, Question

PREDICT = (
    Question(
        "01-p1",
        "A joint turns about z, one degree a step, all the way round. Each step is written as "
        "axis-angle. What does its third number do?",
        (
            Option(
                "It grows steadily from 0 to 2 pi.",
                "It would have to remember how the joint got there. But 190 degrees one way is the "
                "same pose as 170 degrees the other way, and the shorter turn is written down.",
            ),
            Option(
                "It grows to pi, then jumps to -pi.",
                "Past half a turn the other way round is shorter. The pose hardly changes, but the "
                "number changes by 2 pi. A network, being smooth, would say something in between, "
                "which is neither.",
                right=True,
            ),
            Option(
                "It goes up and down like a wave, without any jump.",
                "That is what the entries of the matrix do: they are sines and cosines. The third "
                "number here is the angle itself.",
            ),
        ),
    ),
    Question(
        "01-p2",
        "An arm lies along x: 0.30 m to the elbow, then 0.25 m to the hand. Turn the shoulder by "
        "+90 degrees about z, and the elbow by another +90. Where is the hand, in x and y?",
        (
            Option(
                "(0.30, 0.25)",
                "There the upper arm still lies along x, and only the elbow has turned. The "
                "shoulder takes the whole arm with it.",
            ),
            Option(
                "(0, 0.55)",
                "There the arm is straight: only the shoulder has turned. The elbow bends the "
                "forearm by another 90 degrees.",
            ),
            Option(
                "(0.25, 0.30)",
                "There the elbow has turned back, by -90. It turns on by +90, so the forearm goes "
                "from y to -x.",
            ),
            Option(
                "(-0.25, 0.30)",
                "The shoulder turns the upper arm to y, so the elbow is at (0, 0.30). The elbow "
                "turns the forearm once more, from y to -x.",
                right=True,
            ),
        ),
    ),
    Question(
        "01-p3",
        "Ten seconds of sound, windows of 25 ms, a new one every 10 ms. How many whole windows fit "
        "in?",
        (
            Option(
                "998",
                "A window starts every 10 ms, but the last ones would hang over the end: only "
                "those that start within the first 9.975 s are whole.",
                right=True,
            ),
            Option(
                "1000",
                "So many windows start. Those that start at 9.98 s and 9.99 s find less than 25 ms "
                "of sound left.",
            ),
            Option(
                "400",
                "So many fit end to end. But a window starts before the one in front of it is "
                "over, so they overlap.",
            ),
        ),
    ),
    Question(
        "01-p4",
        "In the figure every stressed vowel has an onset close by. Does this show that onsets mark "
        "the stress?",
        (
            Option(
                "Yes. If it were chance, some vowels would have none.",
                "Not if onsets are almost everywhere. First count how often a random moment has "
                "an onset just as close.",
            ),
            Option(
                "No. A single sentence is too short to show anything.",
                "More sentences would not help. What is missing is a comparison: moments without "
                "any stress.",
            ),
            Option(
                "Not yet. Random moments may do as well.",
                "There are several onsets a second, so most moments have one close by, stressed "
                "or not. The next cell counts them.",
                right=True,
            ),
        ),
    ),
    Question(
        "01-p5",
        "Average the speed of the wrists over all clips, with every stressed vowel at time zero. "
        "What will the curve do at zero, as the vowel begins?",
        (
            Option(
                "It is low: there the hands arrive.",
                "A stroke is a throw and a stop. The stop falls on the vowel; the throw shows as a "
                "peak a little earlier.",
                right=True,
            ),
            Option(
                "It is high: the hands strike along with the vowel.",
                "They strike a little earlier. When the vowel begins they are already there, and "
                "a hand that arrives is slow.",
            ),
            Option(
                "It is flat: in our clip, the hands often missed the lines.",
                "Single strokes miss, some early and some late. An average keeps what they have in "
                "common.",
            ),
        ),
    ),
)

CHECK = (
    Question(
        "01-q1",
        "A clip has poses of shape (143, 55, 3), at 30 frames a second. How long is it?",
        (
            Option(
                "1.83 s",
                "That is 55 / 30. The second number counts the joints; time is the first.",
            ),
            Option(
                "4.77 s",
                "143 frames / 30 frames a second = 4.77 s.",
                right=True,
            ),
            Option(
                "5.72 s",
                "That is 143 / 25. MDD has 25 frames a second; this clip has 30.",
            ),
        ),
    ),
    Question(
        "01-q2",
        "Somebody sends you a dance as a BVH file. Can you find out whether a hand ever touches "
        "the belly?",
        (
            Option(
                "Yes: forward kinematics tells where the hand is.",
                "It tells where the joint of the wrist is. But nothing in the file tells where "
                "the belly ends.",
            ),
            Option(
                "Yes, if there are enough frames in it.",
                "More frames tell more about time. What is missing in every frame is the surface "
                "of the body.",
            ),
            Option(
                "No: the file knows bones and angles, but no girth.",
                "A slim and a stout dancer may have the very same file. Only a surface tells them "
                "apart.",
                right=True,
            ),
        ),
    ),
    Question(
        "01-q3",
        "You double the length of the forearm. Which arrays of the clip change?",
        (
            Option(
                "None.",
                "Bone lengths belong to the body; the clip holds angles. Only the places that you "
                "compute from both will change.",
                right=True,
            ),
            Option(
                "The poses of the elbow and the wrist.",
                "A pose says how far a joint is turned, not how far away the next one is. The same "
                "angles move any arm.",
            ),
            Option(
                "The place of the pelvis.",
                "The walk starts at the pelvis and comes to the arm later. A longer arm moves only "
                "what hangs on it.",
            ),
        ),
    ),
    Question(
        "01-q4",
        "Sound at 48 kHz, motion at 30 frames a second: which hop gives one window a frame?",
        (
            Option(
                "533 samples",
                "That is nearly right at 16 kHz, where a frame lasts 533.3 samples. At 48 kHz it "
                "lasts three times as many.",
            ),
            Option(
                "There is none, because the division leaves a rest.",
                "At 16 kHz it does. But 48000 / 30 leaves none.",
            ),
            Option(
                "1600 samples",
                "48000 / 30 = 1600, a whole number. So sound and motion stay together for ever.",
                right=True,
            ),
        ),
    ),
    Question(
        "01-q5",
        "A network moves the hands as fast as people do, but at random moments. What will show it?",
        (
            Option(
                "The mean speed of the wrists.",
                "That is as high as people's. A mean over the whole clip says how much the hands "
                "move, not when.",
            ),
            Option(
                "The speed of the wrists around stressed vowels.",
                "Averaged over clips it would be as flat as the line around random moments.",
                right=True,
            ),
            Option(
                "The number of onsets.",
                "Onsets belong to the sound. Whatever the hands do, the sound stays as it is.",
            ),
        ),
    ),
)

QUESTIONS = (*PREDICT, *CHECK)
