"""Pictures of README and docs that `make pictures` draws.

python -m benchmark pictures moving-demo docs/demo-moving.svg     runs the demo's device and service for a minute
python -m benchmark pictures comparison docs/comparison.svg       reads the tables of docs/results
python -m benchmark pictures reports docs/reports                 opens every report in a browser; minutes
"""
