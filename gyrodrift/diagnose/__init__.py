"""Where a simulated rig and real recordings part, which effect it is, and how far adding it closes the gap."""

from gyrodrift.callable_package import make_callable

make_callable(__name__)
