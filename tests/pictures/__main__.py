"""`python -m tests.pictures NAME PATH`: the folder of the tests is put where pytest looks for their modules too."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from pictures import comparison_chart, moving_demo, report_pages

WRITERS = {"moving-demo": moving_demo.write, "comparison": comparison_chart.write, "reports": report_pages.write}

if __name__ == "__main__":
    name, path = sys.argv[1:]
    WRITERS[name](Path(path))
