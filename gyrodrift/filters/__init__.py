"""The filters, and the one registry by which everything else finds them.

`filter` says what a filter is; a filter is its recursion and one record; `registry` knows them all.
"""
