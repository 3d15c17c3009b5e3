"""A simulated gyro on a turntable with an encoder: the other end of the serial link.

It imports nothing from gyrodrift. Device and host share the wire protocols, and `strict_yaml`; tests check both against
the same golden frames.
"""
