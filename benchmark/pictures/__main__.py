"""`python -m benchmark pictures NAME PATH`."""

import sys
from pathlib import Path

from pictures import comparison_chart, moving_demo, report_pages

WRITERS = {"moving-demo": moving_demo.write, "comparison": comparison_chart.write, "reports": report_pages.write}

if __name__ == "__main__":
    name, path = sys.argv[1:]
    WRITERS[name](Path(path))
