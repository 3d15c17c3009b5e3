"""Pictures of the README as SVG: the demo that moves, and the comparison chart. `make pictures` draws them.

python -m tests.pictures moving-demo docs/demo-moving.svg     runs the demo's device and service for a minute
python -m tests.pictures comparison docs/comparison.svg       reads the tables of docs/results.md
"""
