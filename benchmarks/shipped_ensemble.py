"""Differences of an ensemble from the reference of docs/accuracy.md, in its standard errors.

skin ensemble quarter-ring --seeds 1-8 -o runs/balanced
python benchmarks/shipped_ensemble.py runs/balanced/quarter-ring.csv.gz
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

import numpy as np
from lammps_skin.analysis.observables import read_table
from lammps_skin.study.tradeoff.bias import biases

DATA = Path(__file__).resolve().parents[1] / "docs" / "data"
BEFORE = "balanced-skin-0.25"  # the variant whose errors are taken


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "table", type=Path, nargs="?", default=DATA / "balanced-quarter-ring.csv.gz"
    )
    table = read_table(parser.parse_args().table)
    seeds = {int(seed): table[table["seed"] == seed] for seed in np.unique(table["seed"])}
    with (DATA / "tradeoff-quarter-ring-ensemble.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["variant"] == BEFORE]
    windows = sorted({tuple(map(float, row["window"].split("-"))) for row in rows})
    means = {
        (bias.name, "{:g}-{:g}".format(*bias.window)): bias.reference
        for bias in biases(seeds, seeds, windows)
    }
    print("| statistic | times | difference | in errors |\n| --- | --- | --- | --- |")
    for row in rows:
        difference = means[row["name"], row["window"]] - float(row["reference"])
        errors = difference / float(row["error"])
        print(f"| {row['name']} | {row['window']} | {difference:.2g} | {errors:.2g} |")


if __name__ == "__main__":
    main()
