"""The blind check of `gyrodrift diagnose`: whether it names the effect that somebody else put into the data.

    python -m benchmark blind run --set final --out .blind/final    seal the labels, generate, diagnose; goes on
    python -m benchmark blind score .blind/final                    open the seals, print the table, list the misses
    python -m benchmark blind run --set bench --out .blind/bench --seed 5 --rows none_own,loop --count 20
    python -m benchmark blind show CASE --out .blind/final            open one seal; the opening is logged too

The parts, in the order in which a case meets them:

    recipes.py     cases of the sets smoke, development and final
    rows/          cases over devices as people own them, from the generator, `gyrodrift simulate` and real recordings
    sets.py        all sets: smoke, development and final by recipes, bench by rows
    seals.py       labels with a salt, in files of their own; their hashes are published before any run
    run.py         the command line of gyrodrift, handed nothing but sessions, a rig and what is withheld
    gap.py         what it said
    judge.py       whether that was right
    score.py, bench_rows.py   shares of what came out right
    table.py       the table

Physics and catalogue of effects are those of the open benchmark, benchmark/gyrogap. It knows nothing of the simulator
or of the diagnosis. The cases here go beyond it: `gyrodrift simulate`, real recordings, second runs.

A set's folder holds `plan.json` (public: which runs there are), `hashes.json`, `seals/`, `results/` and `openings.log`.
The plan says what is withheld from a run. Runs on data without any gap have something withheld too, so that it tells
nothing. The runs in which only the true effect may be fitted, the oracle of the shrink, come last, after an opening.
A folder of the set bench grows: more rows and cases are sealed beside those that are there.
"""
