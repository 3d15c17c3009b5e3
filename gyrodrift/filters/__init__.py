"""The filters and their registry.

`filter` defines the record of a filter; each filter has a recursion and a record; `registry` lists them.
"""
