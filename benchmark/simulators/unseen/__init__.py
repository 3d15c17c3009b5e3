"""34 cases in Drake and pymunk: other benches, motions, sample rates and forms of flaws than those beside this folder.

They are to measure `diagnose` alone: constants of it are not chosen with them.
"""
