"""What has been measured, as tables: rows, CSV, Markdown."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

from lammps_skin.errors import SkinError
from lammps_skin.files import atomic_write
from lammps_skin.study.tradeoff.bias import Bias, root_mean_square
from lammps_skin.study.tradeoff.errors import Distance, Order
from lammps_skin.study.tradeoff.grid import Variant
from lammps_skin.study.tradeoff.store import EndState, Timing


@dataclass(frozen=True)
class Row:
    """A variant: what it costs and how far it is from the truth.

    Attributes
    ----------
    variant, keys : str
    cpu : float
        CPU seconds of a time unit over those of the reference, median of rounds.
    cpu_spread : float
        Half of the difference between the largest and the smallest of these.
    cpu_seconds : float
        CPU seconds of a time unit.
    evaluations : float
        Force evaluations in a time unit.
    divided : float
        Fraction of steps that were divided.
    lowered, lowest_mobility : float
        Fraction of particles whose mobility was lowered, and the lowest of all.
    rms, median, largest : float
        Distance of particles from the truth.
    bias : float
        Root of the mean square, over statistics and windows, of the differences from the
        reference in units of their standard error; NaN without ensembles.
    problem : str
        Why numbers are missing.
    """

    variant: str
    keys: str
    cpu: float
    cpu_spread: float
    cpu_seconds: float
    evaluations: float
    divided: float
    lowered: float
    lowest_mobility: float
    rms: float
    median: float
    largest: float
    bias: float
    problem: str


def row(
    one: Variant,
    interval: float,
    reached: EndState,
    timing: Timing,
    distance: Distance,
    found: Sequence[Bias],
) -> Row:
    """The row of a variant."""
    motion = reached.motion
    return Row(
        one.name, one.words, timing.ratio, timing.spread, timing.seconds,
        motion.evaluations / interval, motion.divided / motion.steps, motion.lowered,
        motion.lowest_mobility, *distance, root_mean_square(found),
        reached.problem or timing.problem,
    )  # fmt: skip


@dataclass(frozen=True)
class Report:
    """All that has been measured of a scene.

    Attributes
    ----------
    title : str
    notes : list of str
        What was measured, and how to do it again.
    rows : list of Row
    orders : list of Order
    biases : dict of str to list of Bias
        By name of the variant.
    """

    title: str
    notes: list[str]
    rows: list[Row]
    orders: list[Order]
    biases: Mapping[str, Sequence[Bias]] = field(default_factory=dict)

    def write(self, folder: Path, name: str) -> list[Path]:
        """Write NAME.csv, NAME-orders.csv, NAME-ensemble.csv and NAME.md."""
        contents = {
            f"{name}.csv": csv_text([asdict(row) for row in self.rows]),
            f"{name}-orders.csv": csv_text(
                {
                    "variant": variant,
                    "timestep": timestep,
                    **apart._asdict(),
                    "order_rms": order.of_rms,
                    "order_median": order.of_median,
                }
                for order in self.orders
                for variant, timestep, apart in zip(
                    order.names, order.timesteps, order.distances, strict=True
                )
            ),
            f"{name}-ensemble.csv": csv_text(
                {"variant": variant, **bias._asdict(), "in_errors": bias.in_errors}
                | {"window": "{:g}-{:g}".format(*bias.window)}
                for variant, found in self.biases.items()
                for bias in found
            ),
            f"{name}.md": self.markdown(),
        }
        paths = []
        try:
            for file, content in contents.items():
                if content:
                    paths.append(folder / file)
                    with atomic_write(paths[-1]) as place:
                        place.write_text(content, "utf-8")
        except OSError as error:
            raise SkinError(f"table {paths[-1]}: {error.strerror}") from None
        return paths

    def markdown(self) -> str:
        """All tables as a page."""
        parts = [f"# {self.title}", *self.notes, markdown_table(*rows_table(self.rows))]
        problems = [f"* {row.variant}: {row.problem}" for row in self.rows if row.problem]
        if problems:
            parts.append("\n".join(problems))
        if self.orders:
            parts += ["## Orders of convergence", markdown_table(*orders_table(self.orders))]
        if self.biases:
            parts.append("## Statistics of ensembles")
        for name, found in self.biases.items():
            parts += [f"### {name}", markdown_table(*bias_table(found))]
        return "\n\n".join(parts) + "\n"


# ---- tables as text: names of columns, and cells

Text = tuple[list[str], list[list[str]]]


def rows_table(rows: Iterable[Row]) -> Text:
    """Cost and distance of every variant."""
    names = [
        "variant", "CPU", "faster", "evaluations", "divided", "lowered", "rms", "median",
        "largest", "bias",
    ]  # fmt: skip
    cells = [
        [
            row.variant, f"{number(row.cpu)} ± {number(row.cpu_spread, 1)}", number(1 / row.cpu),
            number(row.evaluations), number(row.divided, 2), number(row.lowered, 2),
            number(row.rms, 2), number(row.median, 2), number(row.largest, 2),
            number(row.bias, 2),
        ]
        for row in rows
    ]  # fmt: skip
    return names, cells


def orders_table(orders: Iterable[Order]) -> Text:
    """Errors at the timesteps of every family, and its order."""
    names = ["variants", "rms", "its order", "median", "its order"]
    cells = [
        [
            ", ".join(order.names),
            ", ".join(number(apart.rms, 2) for apart in order.distances), f"{order.of_rms:.2f}",
            ", ".join(number(apart.median, 2) for apart in order.distances),
            f"{order.of_median:.2f}",
        ]
        for order in orders
    ]  # fmt: skip
    return names, cells


def bias_table(found: Iterable[Bias]) -> Text:
    """Every statistic in every window."""
    names = [
        "statistic", "times", "reference", "difference", "in errors", "percent", "seeds", "needed",
    ]  # fmt: skip
    cells = [
        [
            bias.name, "{:g} to {:g}".format(*bias.window),
            f"{number(bias.reference)} (sd {number(bias.deviation, 2)})",
            f"{number(bias.difference, 2)} ± {number(bias.error, 1)}", number(bias.in_errors, 2),
            f"{number(bias.percent, 2)} ± {number(bias.percent_error, 1)}", 
            f"{bias.seeds}, {bias.reference_seeds}", number(bias.needed, 6),
        ]
        for bias in found
    ]  # fmt: skip
    return names, cells


def number(value: float, digits: int = 3) -> str:
    """A number with some digits; a dash where there is none."""
    if math.isnan(value):
        return "-"
    text = f"{value:.{digits}g}"
    return f"{float(text):.0f}" if "e+" in text else text


def markdown_table(names: Sequence[str], cells: Iterable[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = [names, ["---"] * len(names), *cells]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def csv_text(records: Iterable[Mapping[str, object]]) -> str:
    """Records as CSV, numbers with seven digits; empty without records."""
    text = io.StringIO()
    writer: csv.DictWriter[str] | None = None
    for record in records:
        if writer is None:
            writer = csv.DictWriter(text, list(record), lineterminator="\n")
            writer.writeheader()
        writer.writerow({
            key: f"{value:.7g}" if isinstance(value, float) else value
            for key, value in record.items()
        })  # fmt: skip
    return text.getvalue()
