"""The set `bench`: whether a diagnosis holds on any bench. Rows of cases, each over devices as people own them.

    case.py         a case of a row: what is sealed, and which folders it is written to
    table.py        the rows: how many cases each has, and who draws them
    simulated.py    cases from `gyrodrift simulate`, diagnosed against the rig that they come from
    generated.py    cases from the generator
    wrong_size.py   the rig has the effect, at another size than the sessions
    recordings.py   real recordings in two sets: those of last month and those of today
    tampering.py    effects put into recordings, in forms of their own
    baseline.py     cases from both

A case is a folder: `sessions/` and `rig.yaml`, and as the row has it `baseline/` (what `--baseline` gets), `without/`
(sessions of the same device without the effect) or `again/` (new sessions, for the rig that the diagnosis wrote).
A case is found by seed, row and number; what is drawn for one row or number moves no other.
"""
