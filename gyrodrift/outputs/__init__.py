"""Outputs: corrected samples to whoever listens on a socket, in a process of their own beside the service.

They know nothing of link, filter and service: samples, events and the service's state reach them through a socket,
and nothing of a client's ever goes the other way.
"""
