"""Outputs: corrected samples for clients, in a process of their own beside the service.

They do not depend on link, filter and service. Samples, events and the state of the service reach them through a
socket. No client can send anything back, except the buttons of the live page, through the control socket.
"""
