"""`python -m benchmark evaluate`."""

import sys

from evaluate.command import main

if __name__ == "__main__":
    sys.exit(main())
