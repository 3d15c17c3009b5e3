"""Methods on the open benchmark gyrogap: each reads a data set and writes one answer per case.

    python -m benchmark evaluate.gyrogap_methods METHOD DATA ANSWERS
    python -m benchmark evaluate.gyrogap_methods.table DATA NAME=ANSWERS ...

    diagnose.py     `gyrodrift diagnose`, the command line alone
    reader.py       no recording, only `simulator.yaml`
    lasso.py        linear regressors, stability selection; needs scikit-learn
    boosting.py     gradient-boosted trees on features; needs scikit-learn and the file of training.py
    sysid.py        mujoco.sysid with all parameters free; needs mujoco-core[sysid]
    npe.py          neural posterior estimation; needs sbi and the file of training.py
    training.py     cases of other seeds
    cases.py, rate_error.py    what the methods share
    table.py        the table of benchmark/gyrogap.md

The packages of other methods are no dependencies of this project: install them into an environment of their own.
"""
