"""Protocols of the device, one file per protocol.

Written from the protocols, not from the host's decoders: a codec that both ends share would hide its own bugs. Every
module here that has an `ENCODER` is a protocol; `registry` finds it.
"""
