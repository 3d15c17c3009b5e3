"""`python -m benchmark blind`."""

import sys

from blind.command import main

sys.exit(main())
