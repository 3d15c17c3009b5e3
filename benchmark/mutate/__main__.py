"""`python -m benchmark mutate`."""

import sys

from mutate.command import main

sys.exit(main())
