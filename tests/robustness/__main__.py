"""`python -m tests.robustness`: the folder of the tests is put where pytest looks for their modules too."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from robustness.command import main

sys.exit(main())
