"""Scene and configuration -> a directory in which ``lmp -in skin.in`` runs."""

from __future__ import annotations

import math
import shutil
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from lammps_skin.engine.built import SCENE_FILE
from lammps_skin.errors import SceneError, one_line
from lammps_skin.kinds import KINDS, Kind
from lammps_skin.model.changes import changes
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import to_toml
from lammps_skin.model.stiffness import evaluations
from lammps_skin.model.terms import StyledTerm, Terms
from lammps_skin.plugin import installed
from lammps_skin.start.configuration import Configuration
from lammps_skin.start.interventions import arguments, changes_script

SCRIPTS = (
    "skin.in", "state.in", "membrane.in", "dermis.in", "cells.in", "integration.in", "output.in",
)  # fmt: skip
INTERVENTIONS = "interventions.in"
MARGINS = {Kind.DERMAL: 0.4, Kind.MEMBRANE: 0.6}  # slower than cells, which have 1
CORE = 0.5  # of the contact length: no cell comes so close to the membrane


def build(
    scene: Scene, directory: Path, configuration: Configuration | None = None
) -> Configuration:
    """Write input scripts, tables, data file and the scene itself into a directory.

    Raises `SceneError` if the directory cannot be written or is that of the run from which the
    scene begins, `ConfigurationError` if the configuration does not belong to the scene. Files are
    put in place when all of them are written, the scene last; without it a directory is not
    taken for a built one.
    """
    if configuration is None:
        configuration = Configuration.from_scene(scene)
    else:
        configuration.check(scene)
    origin = configuration.origin
    if origin and directory.resolve() == origin.directory.resolve():
        raise SceneError(
            f"directory {directory}: is that of the run from which the scene begins; give another"
        )
    scene = configuration.described(scene)
    scripts = installed("lammps_inputs")
    if not scripts.is_dir():
        raise SceneError(f"{scripts} is missing: install lammps-skin with pip")
    fresh = not directory.exists()
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".building-", dir=directory) as folder:
            _write(scene, scripts, Path(folder), configuration)
            for name in (SCENE_FILE, INTERVENTIONS):
                (directory / name).unlink(missing_ok=True)
            for path in sorted(Path(folder).iterdir(), key=lambda path: path.name == SCENE_FILE):
                path.replace(directory / path.name)
    except OSError as error:
        if fresh:
            with suppress(OSError):
                directory.rmdir()
        raise SceneError(f"directory {directory}: {error.strerror}") from None
    return configuration


def _write(scene: Scene, scripts: Path, directory: Path, configuration: Configuration) -> None:
    terms = Terms.of(scene)
    for script in SCRIPTS:
        if _needed(script, scene):
            shutil.copyfile(scripts / script, directory / script)
    for name, table in terms.tables.items():
        table.write(directory / f"{name}.table")
    changed = changes(scene)
    for change in changed:
        for name, table in change.tables.items():
            table.write(directory / f"{name}.table")
    if changed:
        (directory / INTERVENTIONS).write_text(
            "\n".join(changes_script(changed)) + "\n", encoding="utf-8"
        )
    configuration.write_data(directory / "skin.data", scene.kinds)
    (directory / SCENE_FILE).write_text(to_toml(scene.given()), encoding="utf-8")
    lines = [f"# {scene.name}: {_comment(scene.description) or 'numbers of this scene'}", ""]
    if configuration.origin:
        lines.insert(1, f"# begins with the state of {_comment(str(configuration.origin))}")
    lines += _variables(terms, configuration)
    (directory / "scene.in").write_text("\n".join(lines) + "\n", encoding="utf-8")


def _needed(script: str, scene: Scene) -> bool:
    absent = {"dermis.in": not scene.dermis.present, "cells.in": not scene.has_cells}
    return not absent.get(script, False)


def _comment(text: str) -> str:
    """Text in which LAMMPS sees no new line, no continuation and no quote."""
    return one_line(text.translate({ord(c): " " for c in '"&'}))


def _variables(terms: Terms, configuration: Configuration) -> Iterator[str]:
    """Lines of scene.in; index variables can be overridden with ``-var``."""
    scene = terms.scene

    def index(name: str, value: Any) -> str:
        return f"variable        {name} index {value}"

    def string(name: str, *values: Any) -> str:
        return index(name, '"' + " ".join(str(value) for value in values) + '"')

    start_step = round(configuration.time / scene.numerics.timestep)
    yield "# run: these can be overridden with -var"
    yield index("seed", scene.cell_seed)
    yield index("timestep", scene.numerics.timestep)
    yield index("end_time", scene.end_time)
    yield index("thermo_interval", scene.output.thermo_interval)
    yield index("dump_interval", scene.output.dump_interval)
    yield index("checkpoint_interval", scene.output.checkpoint_interval)
    yield index("event_interval", scene.numerics.event_interval)
    yield index("integrator", scene.numerics.integrator)
    yield index("stages", evaluations(scene))
    yield index("largest_move", scene.numerics.largest_move)
    yield index("stiffness_limit", scene.numerics.stiffness_limit)
    yield index("rounding", scene.rounding)
    yield index("rounding_interval", scene.numerics.rounding_interval)
    yield index("running", 1)
    yield "\n# parts"
    yield index("has_dermis", int(scene.dermis.present))
    yield index("has_cells", int(scene.has_cells))
    yield index("has_changes", int(bool(scene.later_stages)))
    yield index("start_step", start_step)
    yield index("start_time", float(configuration.time))
    yield "\n# numerics"
    yield index("neighbor_skin", scene.numerics.neighbor_skin)
    yield string("margins", *_margins(scene))
    yield index("ghost_cutoff", ghost_cutoff(terms, configuration))
    yield string("collections", *_collections(scene))
    yield index("bin_size", scene.spacing + scene.numerics.neighbor_skin)
    yield "\n# pair terms: sub-style, where its table is if it has one, and its coefficients"
    styles = ["skin/core"] * bool(terms.cores) + [term.style for term in terms.pairs]
    yield string("pair_styles", *styles)
    for term, style in zip(terms.pairs, _numbered(terms.pairs), strict=True):
        yield string(f"{term.name}_style", style)
        yield index(f"{term.name}_path", "${dir}/" if term.table else '""')
        yield string(term.name, term.coefficients)
    yield index("has_cores", int(bool(terms.cores)))
    for pair, core in terms.cores.items():
        yield string(f"{pair}_core", core)
    yield "\n# membrane"
    yield string("stretch_style", terms.stretch.style)
    yield index("stretch_path", "${dir}/" if terms.stretch.table else '""')
    yield string("stretch", terms.stretch.coefficients)
    yield string("link_limits", *_link_limits(terms.stretch))
    yield index("bending_stiffness", scene.membrane.bending_stiffness)
    yield index("bending_form", scene.membrane.bending_form)
    if scene.dermis.present:
        yield "\n# dermis"
        yield string("wall", terms.wall)
        yield index("frozen_below", scene.dermis.frozen_below)
    if scene.has_cells:
        yield from _cell_variables(terms, configuration, string)


def _link_limits(stretch: StyledTerm) -> list[str]:
    """Keyword of the motion for the ends of a table of stretch; nothing without a table."""
    if stretch.table is None:
        return []
    return ["link", *(repr(float(stretch.table.distances[end])) for end in (0, -1))]


def _cell_variables(terms: Terms, configuration: Configuration, string: Any) -> Iterator[str]:
    scene, cells = terms.scene, terms.scene.cells
    labels = [row.label for row in scene.cell_kinds]
    last = len(scene.kinds)
    yield "\n# cells"
    yield string("cell_types", f"{last - len(labels) + 1}*{last}")
    yield string("cell_labels", *labels)
    yield string("cell_kinds", " &\n                ".join(_kind_arguments(terms)))
    yield string("cell_counts", *_places_of_counts([row.kind for row in scene.cell_kinds]))
    yield string("contact", scene.contact)
    yield string("core", CORE * scene.contact if cells.membrane_exclusion_stiffness else 0)
    yield string("spring", *terms.division)
    yield string("offset", cells.division_separation * cells.radius)
    yield string("pairs_stay", "no" if cells.removal_in_pair else "yes")
    yield string("apart", cells.division_distance * 2 * cells.radius)
    yield string("next_id", configuration.next_id)
    yield string("interventions", " &\n                ".join(arguments(scene, configuration)))


def _places_of_counts(kinds: list[Kind]) -> Iterator[str]:
    """Entries of the vector of fix skin/cells that count the cells of kinds."""
    others = [kind for kind in kinds if kind not in KINDS]
    for kind in kinds:
        yield f"f_cells[{12 + others.index(kind) if kind in others else kind + 1}]"


def _kind_arguments(terms: Terms) -> Iterator[str]:
    """Arguments of fix skin/cells, one line for each kind of cell."""
    rows = terms.scene.cell_kinds
    labels = [row.label for row in rows]
    for row in rows:
        values = (f"{key} {value}" for key, value in terms.kind(row, labels).items())
        yield " ".join(["kind", row.label, "type", row.label, f"number {row.kind:d}", *values])


def _margins(scene: Scene) -> list[str]:
    """Keyword of the motion for the rooms of types in lists of the plugin's own pair styles."""
    if scene.numerics.pair_form != "skin":
        return []
    return ["margins", *(f"{MARGINS.get(kind, 1.0):g}" for kind in scene.kinds)]


def _collections(scene: Scene) -> list[str]:
    """Collections of types for the neighbor search: the membrane, and all that is larger."""
    larger = [str(n) for n, kind in enumerate(scene.kinds, 1) if kind != Kind.MEMBRANE]
    membrane = str(scene.kinds.index(Kind.MEMBRANE) + 1)
    return ["2", membrane, ",".join(larger)] if larger else ["1", membrane]


def _numbered(terms: Sequence[StyledTerm]) -> Iterator[str]:
    """Names of sub-styles as hybrid wants them: with a number where one occurs several times."""
    names = [term.style.split()[0] for term in terms]
    total, seen = Counter(names), Counter[str]()
    for name in names:
        seen[name] += 1
        yield f"{name} {seen[name]}" if total[name] > 1 else name


def ghost_cutoff(terms: Terms, configuration: Configuration) -> float:
    """Reach of ghost particles: pairs, links, dividing pairs, and the nearest membrane particle."""
    scene, skin = terms.scene, terms.scene.numerics.neighbor_skin
    reach = [
        max(terms.cutoffs[name] for name in terms.pair_potentials) + skin,
        terms.longest_link + skin,
    ]
    if scene.has_cells:
        detachment = terms.cutoffs["adhesion"]
        _, distance = configuration.nearest_membrane()
        furthest = float(distance[configuration.is_cell].max(initial=0.0))
        reach.append(max(detachment, furthest) + 2.5 * skin)
        reach.append(3 * scene.cells.radius)
    return math.ceil(100 * max(reach)) / 100
