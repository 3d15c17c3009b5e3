"""`python -m benchmark robustness`."""

import sys

from robustness.command import main

sys.exit(main())
