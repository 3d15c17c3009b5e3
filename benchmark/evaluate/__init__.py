"""How good the results are over many random cases, beside the figures that were committed last: `make evaluate`.

    python -m benchmark evaluate                          every part, as many cases as the committed figures have
    python -m benchmark evaluate diagnose --count 20      one part, with more cases
    python -m benchmark evaluate --update                 write the figures into last.json, to be committed

Every figure has a 95 % interval: Wilson's for a share, a bootstrap for a mean. Cases are drawn from a fixed seed. The
same code gives the same figures, so a difference from last.json comes from the code (or from rounding in libraries).

    figures.py            a share and a mean, with their intervals
    last.py               last.json; which figures became worse by more than the margin
    parts.py              the parts by name
    diagnose_part.py      `gyrodrift diagnose` on cases of benchmark/blind
    gyrogap_part.py       `gyrodrift diagnose` on a sample of the open benchmark; gyrogap_methods/ has other methods
    simulators_part.py    `gyrodrift diagnose` between sessions of MuJoCo and Bullet, and its exports
    unseen_cases.py       the same between sessions of Drake and pymunk, for the same part; baseline.py runs both
    real_causes_part.py   `gyrodrift diagnose` on real recordings whose cause is known (real_causes.py lists them)
    hard_cases_part.py    restlevel on the hard cases of the simulator
    everyday_part.py      restlevel beside other filters on everyday motions (everyday_motions.py)
"""
