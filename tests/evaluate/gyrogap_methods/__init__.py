"""Methods on the open benchmark gyrogap: each reads a data set and writes one answer per case.

    python -m tests.evaluate.gyrogap_methods.diagnose DATA ANSWERS      `gyrodrift diagnose`

An answer that is there is not made again, so that an interrupted run goes on.
"""
