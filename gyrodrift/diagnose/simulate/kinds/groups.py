"""Effects that are easily taken for each other, and how to record so that they part."""

from gyrodrift.diagnose.simulate.candidate import CandidateGroup

SCALE = CandidateGroup("scale", "record with host times, and an index pulse on the encoder")
CLOCK = CandidateGroup("clock")
SLOW_BIAS = CandidateGroup(
    "slow bias", "heat and cool within one session, and switch the power off and on between sessions"
)
STOCHASTIC_BIAS = CandidateGroup("stochastic bias", "record longer stills, an hour or more")
LAG = CandidateGroup("lag", "play a chirp or multisine up to half the sample rate, and a minute at rest")
EVEN_IN_RATE = CandidateGroup("even in rate", "turn at several speeds in both directions")
ONCE_PER_TURN = CandidateGroup("once per turn", "make whole turns at two very different speeds")
TIMES = CandidateGroup("times", "keep the raw bytes with their arrival times")
COARSE_VALUES = CandidateGroup("coarse values", "play a slow ramp through zero, and rest")
OUTLIERS = CandidateGroup("outliers", "record longer, until a few more of them have come")
REVERSAL = CandidateGroup("reversal", "reverse sharply and often, at several speeds")
