"""`python -m benchmark crash`."""

import sys

from crash.command import main

sys.exit(main())
