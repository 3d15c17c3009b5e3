"""What the project survives, measured: a table for each kind of trouble.

    python -m benchmark robustness faults               every fault of the simulated device, and pairs of them
    python -m benchmark robustness soak --hours 24      a day of device time, as fast as it goes
    python -m benchmark robustness overload             too many samples, busy processors, stops, clocks that are set

The parts:

    strengths.py    each fault at three strengths, and pairs drawn at random
    identity.py     a number in every sample, so that it is known again behind the link
    scaled.py       device, pty and link in one process, with a clock that runs as fast as the samples do
    account.py      what was sent, lost, received and wrong, from the bytes on the wire alone
    campaign.py     the runs and their table
    soak.py, overload.py
"""
