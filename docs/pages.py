"""What the pages need beside the command `skin` and the benchmarks; docs/pages.mk calls it.

python docs/pages.py reduce docs/figures/cells-t600.png
python docs/pages.py moments runs/wound docs/figures/wound.png 290 300 350
python docs/pages.py screenshot runs/report.html docs/figures/report.png
python docs/pages.py papilla docs/start.md runs
python docs/pages.py columns runs/studies/wound/courses.parquet docs/data/studies/wound coverage
python docs/pages.py effects sensitivity docs/data/studies/sensitivity a.png zeta,skewness
python docs/pages.py join docs/data/stability-others.csv runs/one/demo.csv runs/one/one-stem.csv
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

from matplotlib.figure import Figure
from PIL import Image

COLOURS = 256


def reduce(path: str) -> None:
    """Write a picture again with few colours, as a smaller file."""
    with Image.open(path) as picture:
        reduced = picture.convert("RGB").quantize(COLOURS, Image.Quantize.MAXCOVERAGE, kmeans=3)
    reduced.save(path, optimize=True)


def moments(run: str, path: str, *times: str) -> None:
    """Draw a run in three dimensions at some times, side by side."""
    from lammps_skin.figures.look import Look
    from lammps_skin.figures.moments import read_moments
    from lammps_skin.figures.snapshot import draw_view, kinds_of, legend, save

    shown = read_moments(run, [float(time) for time in times])
    kinds = kinds_of(shown[0].scene, None)
    figure = Figure(figsize=(4.1 * len(shown), 4.0), layout="constrained")
    for axes, moment in zip(figure.subplots(1, len(shown)), shown, strict=True):
        draw_view(axes, moment, kinds, Look(size=400))
    legend(figure, shown[-1], kinds)
    save(figure, path)
    reduce(path)


def screenshot(page: str, path: str) -> None:
    """Take a picture of a page in Chromium."""
    flags = ("--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
             "--disable-background-networking", "--hide-scrollbars", "--window-size=1366,1180",
             "--virtual-time-budget=20000")  # fmt: skip
    address = Path(page).resolve().as_uri()
    subprocess.run(["chromium", *flags, f"--screenshot={path}", address], check=True)


def papilla(page: str, folder: str) -> None:
    """Write the scene papilla.toml of a page, and the heights that its Python code makes."""
    section = Path(page).read_text("utf-8").split("## A pre-formed papilla")[1]
    code, scene = (
        re.findall(rf"^```{language}\n(.*?)^```$", section, re.MULTILINE | re.DOTALL)[0]
        for language in ("python", "toml")
    )
    os.chdir(folder)
    exec(code, {})
    Path("papilla.toml").write_text(scene, "utf-8")


def columns(path: str, folder: str, *names: str) -> None:
    """Write a table of a study again as a smaller file: some columns of numbers, 4 digits."""
    from pyarrow import parquet

    table = parquet.read_table(path).to_pandas()
    of_row = [name for name in ("point", "seed", "window", "time") if name in table]
    kept = table[[*of_row, *names]].copy()
    for name in names:
        kept[name] = [float(f"{value:.4g}") for value in kept[name]]
    Path(folder).mkdir(parents=True, exist_ok=True)
    kept.to_parquet(Path(folder) / Path(path).name, compression="zstd", index=False)


def effects(study: str, folder: str, path: str, names: str) -> None:
    """Draw the sensitivity of columns of a study of Morris, and print it as a table."""
    from lammps_skin.figures.snapshot import save
    from lammps_skin.study.studies.design import Design
    from lammps_skin.study.studies.sensitivity import draw, effects, sensitivities
    from lammps_skin.study.studies.tables import read_courses

    design = Design.load(Path(study))
    sample, labels = design.sample, [point.label for point in design.points]
    assert sample
    courses = read_courses(Path(folder))
    found = sensitivities(sample, labels, courses, names.split(","), design.windows[-1])
    save(draw(sample, found), path)
    print("\n".join(effects(sample, found)))


def join(path: str, *tables: str) -> None:
    """Write the rows of tables of scenes below each other, with a first column for the scene."""
    lines = []
    for table in map(Path, tables):
        head, *rows = table.read_text("utf-8").splitlines()
        lines += [f"{table.stem},{row}" for row in rows]
    Path(path).write_text("\n".join([f"scene,{head}", *lines]) + "\n", "utf-8")


if __name__ == "__main__":
    known = (reduce, moments, screenshot, papilla, columns, effects, join)
    made = {one.__name__: one for one in known}
    made[sys.argv[1]](*sys.argv[2:])
