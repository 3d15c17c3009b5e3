"""The blind check of `gyrodrift diagnose`: whether it names the effect that somebody else put into the data.

    python -m benchmark blind run --out .blind/bench --seed 5 --rows none_own,loop --count 20
    python -m benchmark blind score .blind/bench                  open the seals, print the table, list the misses
    python -m benchmark blind show CASE --out .blind/bench        open one seal; the opening is logged too

The parts, in the order in which a case meets them:

    rows/          cases over devices as people own them, from the generator, `gyrodrift simulate` and real recordings
    prepare.py     labels are sealed; their hashes are published before any run
    run.py         the command line of gyrodrift, handed nothing but sessions, a rig and what is withheld
    gap.py         what it said
    judge.py       whether that was right
    score.py, bench_rows.py   shares of what came out right
    table.py       the table

Seals, physics and catalogue of effects are those of the open benchmark gyrogap. The cases here go beyond it: rigs
that are adopted, real recordings, a next recording, withheld effects. And the judge reads all of `gap.json`.

A set's folder holds `plan.json` (public: which runs there are), `hashes.json`, `seals/`, `results/` and `openings.log`.
The plan says what is withheld from a run. The runs in which only the true effect may be fitted, the oracle of the
shrink, come last, after an opening. A folder grows: more rows and cases are sealed beside those that are there.
"""
