"""Run a method: `python -m benchmark evaluate.gyrogap_methods METHOD DATA ANSWERS [--training FILE]`."""

import argparse
from importlib import import_module
from pathlib import Path

from evaluate.gyrogap_methods.cases import answer_all

METHODS = ("diagnose", "lasso", "boosting", "sysid", "npe", "reader")
LEARNING = ("boosting", "npe")


def main() -> None:
    """Answer all cases of a data set; `diagnose` goes on from the answers that are there."""
    parser = argparse.ArgumentParser(prog="python -m benchmark evaluate.gyrogap_methods", description=__doc__)
    parser.add_argument("method", choices=METHODS)
    parser.add_argument("data", type=Path)
    parser.add_argument("answers", type=Path)
    parser.add_argument("--training", type=Path, help="file of training.py, for methods that learn")
    arguments = parser.parse_args()
    module = import_module(f"evaluate.gyrogap_methods.{arguments.method}")
    if arguments.method == "diagnose":
        module.main(arguments.data, arguments.answers)
        return
    method = module.trained(arguments.training) if arguments.method in LEARNING else module.answer
    answer_all(arguments.data, arguments.answers, method)


if __name__ == "__main__":
    main()
