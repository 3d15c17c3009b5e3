"""`python -m tests.evaluate`: the folder of the tests is put where pytest looks for their modules too."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from evaluate.command import main

if __name__ == "__main__":
    sys.exit(main())
