"""`python -m tests.pictures NAME FILE.svg`: the folder of the tests is put where pytest looks for their modules too."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from pictures import comparison_chart, moving_demo

PICTURES = {"moving-demo": moving_demo.picture, "comparison": comparison_chart.picture}

if __name__ == "__main__":
    name, path = sys.argv[1:]
    Path(path).write_text(PICTURES[name](), encoding="utf-8")
