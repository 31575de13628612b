"""Questions of notebook 05: no slope, dead codes, how many names, and which quantiser when.

Paper:    PT A.1
Notebook: notebooks/05_product_codes.ipynb
"""

from s2glib.teaching.questions.question import Option, Question

PREDICT = (
    Question(
        "05-p1",
        "A number is replaced by the nearest entry of a table, and a loss looks at the result. "
        "What is the slope of that loss as a function of the number?",
        (
            Option(
                "The same as without the table.",
                "That is what we shall pretend. But nudge the number a little, and the nearest "
                "entry stays the same: nothing changes.",
            ),
            Option(
                "It is largest near an entry.",
                "Near an entry nothing happens at all. Halfway between two the value jumps.",
            ),
            Option(
                "Zero, nearly everywhere.",
                "The result is a staircase: flat steps, and jumps that have no slope. An encoder "
                "before it would learn nothing.",
                right=True,
            ),
        ),
    ),
    Question(
        "05-p2",
        "Sixteen codes begin near the middle, the data lie in a ring around it. Each code moves to "
        "the mean of what chose it. How many codes will be in use?",
        (
            Option(
                "Only some, for good.",
                "Codes that are nearest to nothing have no mean to move to, so they stay where "
                "they are, and the others move further away from them.",
                right=True,
            ),
            Option(
                "All of them, after a while.",
                "One might hope so. But a code that nothing chose has nothing to follow, and no "
                "later batch will choose it either.",
            ),
            Option(
                "One.",
                "The first batch already has several winners: those that look out in different "
                "directions.",
            ),
        ),
    ),
    Question(
        "05-p3",
        "Four codebooks have 128 entries each, and every token takes one code from each. How many "
        "different tokens are there?",
        (
            Option(
                "512: four times 128.",
                "That is how many entries are stored. But a token is a combination of four.",
            ),
            Option(
                "Over 200 million.",
                "128 x 128 x 128 x 128, or 2 to the power 28: each of the four choices is free. "
                "Only 512 entries are stored.",
                right=True,
            ),
            Option(
                "16 384",
                "That is 128 squared, the number for two codebooks. There are four.",
            ),
        ),
    ),
)

CHECK = (
    Question(
        "05-q1",
        "What happens without the commitment loss, if the codes follow by moving averages?",
        (
            Option(
                "The codes stop moving.",
                "They move without any loss: each goes to the mean of what chose it.",
            ),
            Option(
                "No gradient reaches the encoder any more.",
                "The decoder's loss still does, straight through. But it says nothing about how "
                "far a latent is from its code.",
            ),
            Option(
                "Latents may run away from their codes.",
                "Straight through, the decoder's gradient pulls at latents as if nothing were "
                "rounded. Only this loss ties them to the codes.",
                right=True,
            ),
        ),
    ),
    Question(
        "05-q2",
        "A codebook of 128 has a perplexity of 64. What do you know?",
        (
            Option(
                "64 codes are dead.",
                "They may be, if the other 64 occur alike. But all 128 may occur, some of them "
                "rarely.",
            ),
            Option(
                "The codes carry 6 bits, not 7.",
                "Perplexity is 2 to the entropy in bits: 64 = 2 to the power 6. How the shares are "
                "spread, it does not say.",
                right=True,
            ),
            Option(
                "Half of all the tokens are wrong.",
                "Perplexity compares with nothing. It only asks how evenly the codes are chosen.",
            ),
        ),
    ),
    Question(
        "05-q3",
        "When does a product quantiser lose most against one codebook with as many bits?",
        (
            Option(
                "When its groups depend on each other.",
                "The grid of combinations then has cells where no data are, and names are spent on "
                "them. The encoder can learn to avoid that.",
                right=True,
            ),
            Option(
                "When there are few data.",
                "Then the one large codebook suffers more: it has more entries to learn.",
            ),
            Option(
                "When its groups are independent of each other.",
                "That is its best case. A grid then has data everywhere.",
            ),
        ),
    ),
    Question(
        "05-q4",
        "Training is stopped after step 100 and resumed, but the number of steps was not saved. "
        "What goes wrong with bias-corrected averages (decay 0.99)?",
        (
            Option(
                "Nothing, it is a number for the log.",
                "The totals are divided by 1 - decay^step. With step 1 that is 0.01 instead of "
                "0.63.",
            ),
            Option(
                "Cluster sizes look 63 times too large.",
                "They are divided by 0.01 instead of by 0.63. The means hardly change, but for "
                "a long time no code counts as dead.",
                right=True,
            ),
            Option(
                "All codes begin anew.",
                "The sums and the sizes were saved, so the codes are where they were.",
            ),
        ),
    ),
)

QUESTIONS = (*PREDICT, *CHECK)
