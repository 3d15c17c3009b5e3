"""`python -m tests.mutate`: the folder of the tests is put where pytest looks for their modules too."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from mutate.command import main

sys.exit(main())
