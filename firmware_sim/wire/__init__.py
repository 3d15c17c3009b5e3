"""Protocols of the device, one file per protocol.

They follow the protocol documents, not the decoders of the host: a shared codec would hide its own errors. Every module
with an `ENCODER` is a protocol, and `registry` finds it.
"""
