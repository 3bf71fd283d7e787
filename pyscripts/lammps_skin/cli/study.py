"""``skin study``: from a question to an answer with error bars."""

from __future__ import annotations

import shlex
import sys
from collections import Counter
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from lammps_skin.cli.ensemble import FAILED, INTERRUPTED, run_members
from lammps_skin.cli.options import Jobs, Scheduler
from lammps_skin.cli.output import console, counted, duration, print_parts, print_table
from lammps_skin.errors import SceneError
from lammps_skin.model.remarks import remarks
from lammps_skin.model.scene_keys import near

if TYPE_CHECKING:
    from lammps_skin.analysis.observables import Table
    from lammps_skin.analysis.statistics import Mean
    from lammps_skin.study.ensemble import Member
    from lammps_skin.study.studies.runs import Study
    from lammps_skin.study.studies.sensitivity import Sensitivity


class RunByDefault(TyperGroup):
    """``skin study FILE`` is ``skin study run FILE``."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put the word in front of what names no subcommand."""
        if args and args[0] not in (*self.commands, "--help"):
            _check_word(args[0], self.commands)
            args = ["run", *args]
        rest: list[str] = super().parse_args(ctx, args)
        return rest


def _check_word(word: str, commands: Collection[str]) -> None:
    """Raise `SceneError` for a misspelt subcommand."""
    hint = near(word, commands)
    if hint and not Path(word).exists():
        from lammps_skin.study.studies.design import built_in

        if word not in built_in():
            raise SceneError(f"study {word!r}: neither a subcommand nor a study{hint}")


study = typer.Typer(cls=RunByDefault, no_args_is_help=True, rich_markup_mode=None)

File = Annotated[
    Path, typer.Argument(metavar="FILE", help="TOML file, or the name of a built-in study.")
]
Folder = Annotated[
    Path | None,
    typer.Option("-o", "--output", metavar="DIR", help="Folder [default: studies/NAME]."),
]
Quick = Annotated[
    bool, typer.Option("--quick", help="As the table `quick` of the file says: small and short.")
]
Columns = Annotated[
    str | None,
    typer.Option(metavar="NAMES", help="Observables, such as zeta,chi_H-chi_H_nd,'coverage>0.9'."),
]


@study.command()
def run(
    file: File,
    output: Folder = None,
    quick: Quick = False,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    share: Annotated[
        str | None,
        typer.Option(metavar="K/N", help="Run the K-th of N shares, without a scheduler."),
    ] = None,
    keep: Annotated[bool, typer.Option("--keep", help="Keep trajectories.")] = False,
) -> None:
    """Run what is missing of a study, and write its tables."""
    from lammps_skin.study.runner import run_share
    from lammps_skin.study.studies.tables import write_tables

    part = _share_of(share) if share is not None else None
    if part and (jobs or scheduler):
        option = "--jobs" if jobs else "--scheduler"
        raise SceneError(f"--share {share}: runs one after the other; {option} must not be given")
    asked = opened(file, output, quick)
    design = asked.design
    todo = asked.todo(part)
    console.print(
        f"{counted(len(design.points), 'point')} with {counted(len(design.seeds), 'seed')}: "
        f"{counted(len(asked.runs), 'run')}, {len(asked.runs) - len(asked.missing())} of them done"
    )
    for remark, label in {
        text: point.label for point in reversed(design.points) for text in remarks(point.scene)
    }.items():
        console.print(f"{label}: {remark}")
    if design.sample and design.sample.remark:
        console.print(design.sample.remark)
    asked.write_design()
    activity = asked.provenance
    if part is None:
        activity.begin()
    failures: dict[Member, str] = {}
    try:
        if part is not None:
            console.print(f"share {share}: {counted(len(todo), 'run')} to do")
            failures = run_share(todo, keep)
        elif todo:
            failures = run_members(todo, jobs, keep, scheduler)
    except KeyboardInterrupt:
        console.print("interrupted; the same command goes on with what is missing")
        raise typer.Exit(INTERRUPTED) from None
    finally:
        if part is None:
            for path in write_tables(asked, failures):
                console.print(str(path))
            activity.error = f"{counted(len(failures), 'run')} failed" if failures else ""
            activity.end()
    names = _names(asked)
    for one, text in failures.items():
        console.print(f"failed: {names.get(one.directory, one.directory.name)}: {text}")
    if failures:
        raise typer.Exit(FAILED)


@study.command()
def slurm(
    file: File,
    tasks: Annotated[
        int, typer.Option(min=1, max=10_000, help="Of the array, each with its share of the runs.")
    ] = 16,
    cpus: Annotated[int, typer.Option(min=1, max=1024, help="Cores of each task.")] = 1,
    output: Folder = None,
    quick: Quick = False,
    script: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Where to write it [default: NAME.sh].")
    ] = None,
) -> None:
    """Write an array script for Slurm, in which each task runs its share."""
    from lammps_skin.files import atomic_write
    from lammps_skin.study.ensemble import expected_seconds
    from lammps_skin.study.studies.design import source_of

    asked = opened(file, output, quick)
    todo = asked.todo()
    tasks = max(min(tasks, len(todo)), 1)
    path = script or Path(f"{asked.design.name}.sh")
    command = [str(Path(sys.executable).with_name("skin")), "study", "run"]
    command += [str(source_of(file).absolute()), "-o", str(asked.folder.absolute())]
    command += ["--quick"] * quick
    lines = [
        "#!/bin/sh",
        f"#SBATCH {shlex.quote(f'--job-name={asked.design.name}')}",
        f"#SBATCH --array=1-{tasks}",
        "#SBATCH --ntasks=1",
        f"#SBATCH --cpus-per-task={cpus}",
        f"#SBATCH {shlex.quote(f'--output={asked.design.name}-%a.log')}",
        "# the same script goes on with what is missing after a limit of time or a failure",
        f'exec {shlex.join(command)} --share "$SLURM_ARRAY_TASK_ID/{tasks}"',
    ]
    try:
        with atomic_write(path) as part:
            part.write_text("\n".join(lines) + "\n", "utf-8")
    except OSError as error:
        raise SceneError(f"script {path}: {error.strerror}") from None
    seconds = expected_seconds(todo) / tasks
    console.print(
        f"{path}: {counted(tasks, 'task')}, about {duration(seconds)} each on one core; start it "
        f"with sbatch {shlex.quote(str(path))}"
    )


@study.command()
def write(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Of a built-in study.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="[default: NAME.toml].")
    ] = None,
) -> None:
    """Write the file of a built-in study, to be changed."""
    from lammps_skin.study.studies.design import source_of

    source, path = source_of(Path(name)), output or Path(f"{name}.toml")
    if path.exists():
        raise SceneError(f"file {path}: exists; -o gives another name")
    path.write_text(source.read_text("utf-8"), "utf-8")
    console.print(str(path))


@study.command()
def status(file: File, output: Folder = None, quick: Quick = False) -> None:
    """Show how far a study is."""
    from lammps_skin.study.ensemble import expected_seconds
    from lammps_skin.study.studies.runs import STATES

    asked = opened(file, output, quick)
    states = {one.directory: one.state for one in asked.runs}
    counts = [Counter(states[one.directory] for one in point.runs) for point in asked.points]
    print_table(
        ["point", *STATES],
        [(point.point.label, *(str(count[state] or "") for state in STATES))
         for point, count in zip(asked.points, counts, strict=True)],
        right=True,
    )  # fmt: skip
    console.print()
    todo, missing = asked.todo(), asked.missing()
    console.print(f"{len(asked.runs) - len(missing)} of {counted(len(asked.runs), 'run')} done")
    if todo:
        console.print(f"to do: about {duration(expected_seconds(todo))} of one core")
    names = _names(asked)
    for one in asked.runs:
        if states[one.directory] == "failed":
            console.print(f"failed: {names[one.directory]}: {one.error}")


@study.command()
def show(
    file: File, columns: Columns = None, output: Folder = None, quick: Quick = False
) -> None:
    """Show means over seeds of each point, with 95 % intervals, or indices of sensitivity."""
    from lammps_skin.study.studies.answer import answers
    from lammps_skin.study.studies.sensitivity import has_indices

    asked, courses, wanted = _answered(file, output, columns, quick)
    if has_indices(asked.design.sample):
        for one in _sensitivities(asked, courses, wanted):
            _show_sensitivity(asked, one)
        if asked.design.sample and asked.design.sample.remark:
            console.print(asked.design.sample.remark)
        return
    found = answers(asked.design, courses, wanted)
    for window in asked.design.windows:
        console.print(f"t = {window}:")
        cells = {(one.point, one.column): one.mean for one in found if one.window == window}
        print_parts(
            ["point", "seeds", *wanted],
            [
                (point.label, str(max(cells[point.label, column].n for column in wanted)),
                 *(_shown(cells[point.label, column]) for column in wanted))
                for point in asked.design.points
            ],
            repeated=2,
        )  # fmt: skip
        console.print()
    if lost := len(asked.missing()):
        of_all = counted(len(asked.runs), "run")
        console.print(f"{lost} of {of_all} are not in it: skin study status tells why")


@study.command()
def plot(
    file: File,
    columns: Columns = None,
    against: Annotated[
        str | None,
        typer.Option(
            metavar="KEY",
            help="time, condition, or a key that is varied [default: such a key, else time; of a "
            "sample of Morris or Sobol neither, but sensitivities].",
        ),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option("--picture", metavar="FILE", help="Such as a.pdf, .svg, .png "
                     "[default: NAME.png in the folder]."),
    ] = None,
    output: Folder = None,
    quick: Quick = False,
) -> None:  # fmt: skip
    """Draw means with 95 % intervals over time, or against what is varied; or sensitivities."""
    from lammps_skin.figures.snapshot import save
    from lammps_skin.study.studies import answer, sensitivity

    asked, courses, wanted = _answered(file, output, columns, quick)
    axis = answer.against_of(asked.design, against)
    sample = asked.design.sample
    if against is None and sample and sensitivity.has_indices(sample):
        figure = sensitivity.draw(sample, _sensitivities(asked, courses, wanted))
    elif axis == answer.TIME:
        figure = answer.draw_over_time(courses, wanted)
    else:
        window = asked.design.windows[-1]
        figure = answer.draw_against(asked.design, courses, wanted, axis, window)
    console.print(str(save(figure, picture or asked.folder / f"{asked.design.name}.png")))


def opened(file: Path, output: Path | None, quick: bool = False) -> Study:
    """The study of a file, with its folder."""
    from lammps_skin.study.studies.design import Design
    from lammps_skin.study.studies.runs import Study

    design = Design.load(file, quick)
    name = f"{design.name}-quick" if quick else design.name
    asked = Study(design, output or Path("studies") / name)
    assert asked.runs  # what cannot be is told before anything is written
    return asked


def _names(asked: Study) -> dict[Path, str]:
    """What runs are called, by their directories: the point, the seed, the directory."""
    return {
        run.directory: f"{point.point.label}, seed {run.seed} ({run.directory.name})"
        for point in reversed(asked.points)
        for run in point.runs
    }


def _answered(
    file: Path, output: Path | None, columns: str | None, quick: bool
) -> tuple[Study, dict[str, Table], list[str]]:
    """A study whose tables are up to date, its time courses, and the columns that are wanted."""
    from lammps_skin.study.studies.answer import SHOWN, check_columns, defined
    from lammps_skin.study.studies.tables import observables_of, read_courses, write_tables

    asked = opened(file, output, quick)
    wanted = ["".join(word.split()) for word in columns.split(",")] if columns else []
    check_columns(wanted, observables_of(asked))
    if not any(run.done for run in asked.runs):
        raise SceneError(f"study {file}: no run is done in {asked.folder}")
    asked.write_design()
    write_tables(asked)
    courses = read_courses(asked.folder)
    return asked, courses, wanted or defined(asked.design, courses, SHOWN)


def _sensitivities(
    asked: Study, courses: Mapping[str, Table], wanted: list[str]
) -> list[Sensitivity]:
    """Indices of Morris or Sobol in the last window."""
    from lammps_skin.study.studies.sensitivity import sensitivities

    design = asked.design
    assert design.sample
    labels = [point.label for point in design.points]
    return sensitivities(design.sample, labels, courses, wanted, design.windows[-1])


def _show_sensitivity(asked: Study, one: Sensitivity) -> None:
    """Indices of one observable, a row for each key."""
    design = asked.design
    assert design.sample
    console.print(f"sensitivity of {one.what}, t = {design.windows[-1]}:")
    if not len(one.values):
        console.print("not all points have a value")
    print_table(
        ["key", *one.heads],
        [(key, *(f"{x:.3g}" for x in row))
         for key, row in zip(design.sample.ranges, one.values.tolist(), strict=False)],
        right=True,
    )  # fmt: skip
    console.print()


def _shown(mean: Mean) -> str:
    if not mean.n:
        return ""
    interval = "" if mean.n < 2 else f" [{mean.low:.3g}, {mean.high:.3g}]"
    return f"{mean.value:.3g}{interval}"


def _share_of(text: str) -> tuple[int, int]:
    """K and N of K/N."""
    first, _, last = text.partition("/")
    if not (first.isdecimal() and last.isdecimal() and 1 <= int(first) <= int(last)):
        raise SceneError(f"--share {text}: must be K/N with K from 1 to N, such as 3/16")
    return int(first), int(last)
