"""A simulated gyro on a turntable with an encoder: the other end of the serial link.

It imports nothing of gyrodrift. Device and host meet only at the wire protocols, and golden frames in the tests,
checked from both ends, prove that they agree.
"""
