"""Trajectories that cannot be right: what is done to a good one, and what must be said of it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

GROUP = "particles/trajectory"
HUGE = 10**9
Damage = Callable[[h5py.File], object]


# ---- HDF5


def anew(name: str, **options: Any) -> Damage:
    """The dataset made again, of the same numbers where nothing else is said."""

    def damage(file: h5py.File) -> None:
        former = file[name]
        kept = {"shape": former.shape, "dtype": former.dtype, **options}
        if kept["shape"] == former.shape and "external" not in kept and kept["dtype"] != "S8":
            values = former[:]
            if kept["dtype"].__class__ is not list:
                kept["data"] = values.astype(kept["dtype"])
        del file[name]
        file.create_dataset(name, **kept)

    return damage


def value(name: str, place: Any, number: float) -> Damage:
    """One number of a dataset, by default in the last frame."""
    return lambda file: file[name].__setitem__(place, number)


def cell(name: str, number: float) -> Damage:
    """A number of the last cell of the last frame."""

    def damage(file: h5py.File) -> None:
        last = int(np.flatnonzero(file[f"{GROUP}/partner/value"][-1] >= 0)[-1])
        file[f"{GROUP}/{name}/value"][-1, last] = number

    return damage


def attribute(place: str, name: str, given: Any) -> Damage:
    def damage(file: h5py.File) -> None:
        if given is None:
            del file[place].attrs[name]
        else:
            file[place].attrs[name] = given

    return damage


def remove(name: str) -> Damage:
    return lambda file: file.__delitem__(name)


def linked(name: str, link: Callable[[h5py.File], Any]) -> Damage:
    """A link where something else was; that is kept under another name."""

    def damage(file: h5py.File) -> None:
        file.move(name, "moved")
        file[name] = link(file)

    return damage


def virtual(file: h5py.File) -> None:
    name = f"{GROUP}/species/value"
    layout = h5py.VirtualLayout(file[name].shape, file[name].dtype)
    layout[:] = h5py.VirtualSource("secret.h5", name, file[name].shape)
    del file[name]
    file.create_virtual_dataset(name, layout)


def particle_gone(file: h5py.File) -> None:
    """A membrane particle is not there in the last frame."""
    for name, fill in (("id", -1), ("species", -1), ("position", np.nan)):
        file[f"{GROUP}/{name}/value"][-1, 5] = fill


def nothing_there(file: h5py.File) -> None:
    file[f"{GROUP}/id/value"][-1] = -1


def more_frames(name: str, frames: int) -> Damage:
    return lambda file: file[name].resize(frames, axis=0)


def scene(old: str, new: str) -> Damage:
    def damage(file: h5py.File) -> None:
        text = file["parameters"].attrs["scene"]
        assert old in text
        file["parameters"].attrs["scene"] = text.replace(old, new)

    return damage


def elsewhere(file: h5py.File) -> Any:
    return h5py.ExternalLink("secret.h5", "/")


def soft(file: h5py.File) -> Any:
    return h5py.SoftLink("/moved")


POSITION, ID, STEP, TIME = (
    f"{GROUP}/{name}" for name in ("position/value", "id/value", "position/step", "position/time")
)
LINKS = "connectivity/links"
FOREIGN = "is stored in another file"
LINK = "is a link to somewhere else"
IN_HDF5: dict[str, tuple[Damage, str]] = {
    "external positions": (anew(POSITION, external=[("secret.txt", 0, 10**7)]), FOREIGN),
    "external links": (anew(LINKS, external=[("secret.txt", 0, 10**7)]), FOREIGN),
    "external steps": (anew(STEP, external=[("secret.txt", 0, 10**7)]), FOREIGN),
    "virtual species": (virtual, FOREIGN),
    "soft link": (linked(f"{GROUP}/partner/value", soft), LINK),
    "soft group": (linked(f"{GROUP}/partner", soft), LINK),
    "soft particles": (linked(GROUP, soft), LINK),
    "external group": (linked(f"{GROUP}/position", elsewhere), LINK),
    "external connectivity": (linked("connectivity", elsewhere), LINK),
    "soft parameters": (linked("parameters", soft), LINK),
    "external parameters": (linked("parameters", elsewhere), LINK),
    "external versions": (linked("parameters/versions", elsewhere), LINK),
    "10^9 links": (anew(LINKS, shape=(HUGE, 2)), "that are not in the file"),
    "10^9 links in chunks": (anew(LINKS, shape=(HUGE, 2), chunks=(1024, 2)), " links cannot be"),
    "10^9 slots": (lambda file: file[ID].resize(HUGE, axis=1), "1,000,000,000 slots cannot be"),
    "10^9 frames": (more_frames(STEP, HUGE), "1,000,000,000 frames cannot be in"),
    "10^9 times": (more_frames(TIME, HUGE), "1,000,000,000 frames cannot be in"),
    "10^9 in a chunk": (
        anew(f"{GROUP}/species/value", chunks=(1, 10**7), maxshape=(None, None)), "has chunks of",
    ),
    "whole positions": (anew(POSITION, dtype=np.dtype("i8")), "has numbers of the type int64"),
    "half precision": (anew(POSITION, dtype=np.dtype("f2")), "has numbers of the type float16"),
    "broken ids": (anew(ID, dtype=np.dtype("f8")), "has numbers of the type float64"),
    "unsigned ids": (anew(ID, dtype=np.dtype("u4")), "has numbers of the type uint32"),
    "text species": (anew(f"{GROUP}/species/value", dtype="S8"), "has numbers of the type"),
    "text times": (anew(TIME, dtype="S8"), "has numbers of the type"),
    "compound": (anew(f"{GROUP}/pair/value", dtype=[("a", "i4")]), "has numbers of the type"),
    "broken steps": (anew(STEP, dtype=np.dtype("f8")), "has numbers of the type float64"),
    "unit of time": (attribute(TIME, "unit", 7), "has a unit"),
    "unit of length": (attribute(POSITION, "unit", "nm"), "has a unit"),
    "steps without frames": (lambda file: [
        more_frames(name, 25)(file) or file[name].__setitem__(-1, 10**4) for name in (STEP, TIME)
    ], "must be 25 x"),
    "frames without steps": (more_frames(STEP, 7), "has 7 steps and 24 times"),
    "flat positions": (anew(POSITION, shape=(24, 700)), r"has the shape \(24, 700\)"),
    "no z": (anew(POSITION, shape=(24, 700, 2)), r"has the shape \(24, 700, 2\)"),
    "NaN position": (value(POSITION, (-1, 0), np.nan), "position of particle 1 is not finite"),
    "infinite position": (cell("position", np.inf), r"position of particle \d+ is not finite"),
    "partner beyond": (cell("partner", HUGE), f"partner of cell \\d+ is {HUGE}"),
    "partner below": (cell("partner", -7), r"partner of cell \d+ is -7"),
    "partner a cell": (cell("partner", 674), r"partner of cell \d+ is 674"),
    "parent below": (cell("parent", -2), r"parent of cell \d+ is -2"),
    "pair beyond": (cell("pair", HUGE), f"pair of cell \\d+ is {HUGE}"),
    "divisions below": (cell("divisions_left", -3), r"divisions_left of cell \d+ is -3"),
    "NaN birth": (cell("birth_time", np.nan), r"birth_time of cell \d+ is nan"),
    "infinite division": (cell("next_division", np.inf), r"next_division of cell \d+ is inf"),
    "next id too low": (
        value("observables/trajectory/next_id/value", -1, 5), r"the next id is 5, and there is",
    ),
    "unknown species": (cell("species", 9), r"is of kind 9, which the scene has not"),
    "another species": (cell("species", 1), r"is of kind 1, which the scene has not"),
    "id of another": (value(ID, (-1, 3), 5), "ids are not those of their slots"),
    "id 0": (value(ID, (-1, 3), 0), "ids are not those of their slots"),
    "falling steps": (value(STEP, -1, 3), "its steps do not rise"),
    "negative step": (value(STEP, 0, -3), "its steps do not rise from 0"),
    "falling times": (value(TIME, -1, 0.1), "its times do not rise"),
    "NaN time": (value(TIME, -1, np.nan), "its times do not rise"),
    "infinite time": (value(TIME, -1, np.inf), "its times are not all finite"),
    "no box": (value(f"{GROUP}/box/edges/value", -1, 0.0), "the box has the sides"),
    "NaN box": (value(f"{GROUP}/box/edges/value", (-1, 1), np.nan), "the box has the sides"),
    "link beyond": (value(LINKS, (4, 0), HUGE), "its links are not those of its membrane"),
    "link of a cell": (value(LINKS, (4, 0), 673), "its links are not those of its membrane"),
    "triangle below": (
        value("connectivity/triangles", (0, 0), -1), "its triangles are not those of its membrane",
    ),
    "hole": (particle_gone, "its membrane is not that of the first frame"),
    "nobody": (nothing_there, "there is no particle"),
    "no scene": (attribute("parameters", "scene", None), "is damaged"),
    "scene of numbers": (attribute("parameters", "scene", 5), "is damaged"),
    "no seed": (attribute("parameters", "seed", None), "is damaged"),
    "seed of words": (attribute("parameters", "seed", "seven"), "its seed is no whole number"),
    "two seeds": (attribute("parameters", "seed", [1, 2]), "its seed is no whole number"),
    "scene of nonsense": (attribute("parameters", "scene", "[[["), "its scene cannot be"),
    "scene of 10^10": (scene("[24, 28]", "[100000, 100000]"), "its scene "),
    "no particles": (remove("particles"), "is no trajectory in HDF5"),
    "no species": (remove(f"{GROUP}/species"), "species/value is missing"),
    "no generations": (remove(f"{GROUP}/divisions_left"), "divisions_left/value is missing"),
    "no links": (remove("connectivity"), "connectivity/links is missing"),
    "a group": (lambda file: [
        remove(f"{GROUP}/pair/value")(file), file.create_group(f"{GROUP}/pair/value")
    ], "pair/value is no dataset"),
}  # fmt: skip


def cut(content: bytes) -> bytes:
    return content[: len(content) // 2]


def garbled(content: bytes) -> bytes:
    """Noise in the packed positions, which are most of the file."""
    noise = np.random.default_rng(1).bytes(400)
    place = int(0.97 * len(content))
    return content[:place] + noise + content[place + len(noise) :]


BYTES: dict[str, tuple[Callable[[bytes], bytes], str]] = {
    "cut off": (cut, "is no trajectory in HDF5"),
    "empty": (lambda content: b"", "is no trajectory in HDF5"),
    "text": (lambda content: b"ITEM: TIME\n", "is no trajectory in HDF5"),
    "garbled": (garbled, "."),
}


# ---- the dump


def instead(old: str, new: str, frame: int | None = -1) -> Callable[[str], str]:
    """Other text in a frame, or in all."""

    def damage(text: str) -> str:
        parts = text.split("ITEM: TIME\n")
        for place in range(1, len(parts)) if frame is None else [frame]:
            assert old in parts[place]
            parts[place] = parts[place].replace(old, new, 1)
        return "ITEM: TIME\n".join(parts)

    return damage


def row(number: int, change: Callable[[list[str]], list[str]], frame: int = -1) -> Any:
    """A row of a frame, as words."""

    def damage(text: str) -> str:
        parts = text.split("ITEM: TIME\n")
        lines = parts[frame].split("\n")
        rows = slice(10, -1)
        words = lines[rows]
        words[number] = " ".join(change(words[number].split()))
        lines[rows] = words
        parts[frame] = "\n".join(lines)
        return "ITEM: TIME\n".join(parts)

    return damage


def word(place: int, new: str) -> Callable[[list[str]], list[str]]:
    return lambda words: [*words[:place], new, *words[place + 1 :]]


def without(number: int, frame: int) -> Callable[[str], str]:
    """A frame that lacks a row."""

    def damage(text: str) -> str:
        parts = text.split("ITEM: TIME\n")
        lines = parts[frame].split("\n")
        parts[frame] = "\n".join(lines[: 10 + number] + lines[11 + number :])
        return "ITEM: TIME\n".join(parts)

    return damage


COUNT, BOUNDS = "ITEM: NUMBER OF ATOMS\n", "ITEM: BOX BOUNDS pp pp ff\n"
IN_DUMP: dict[str, tuple[Callable[[str], str], str]] = {
    "blank row": (row(7, lambda words: []), "has a blank line"),
    "blank last row": (row(-1, lambda words: []), "its last line has no possible id"),
    "blank line more": (row(7, lambda words: [*words, "\n"]), "has more lines than the"),
    "blank line between": (instead("ITEM: TIMESTEP", "\nITEM: TIMESTEP", 4), "its line 3 is not"),
    "blank line at the end of a frame": (row(-1, lambda words: [*words, "\n"], 4), "more lines"),
    "frame without a row": (without(3, 4), r"frame of step \d+: lacks lines"),
    "type 9": (row(3, word(1, "9")), "has types from 1 to 9"),
    "type 0": (row(3, word(1, "0")), "has types from 0 to"),
    "type -1": (row(3, word(1, "-1")), "has types from -1 to"),
    "type 1.5": (row(3, word(1, "1.5")), "is not a whole number"),
    "type NaN": (row(3, word(1, "nan")), "is not a whole number"),
    "NaN": (row(3, word(3, "nan")), "position of particle 4 is not finite"),
    "infinite": (row(3, word(4, "inf")), "position of particle 4 is not finite"),
    "too large": (row(3, word(4, "1e999")), "position of particle 4 is not finite"),
    "text": (row(3, word(2, "here")), "no numbers or lines"),
    "a word less": (row(3, lambda words: words[:-1]), "no numbers or lines"),
    "id twice": (row(3, word(0, "3")), "its ids do not rise"),
    "id 0": (row(0, word(0, "0")), "its ids do not rise"),
    "id 10^12": (row(-1, word(0, "1000000000000")), "its last line has no possible id"),
    "partner beyond": (row(-1, word(5, "99999")), r"partner of cell \d+ is 99999"),
    "partner broken": (row(-1, word(5, "1.5")), "is not a whole number"),
    "partner NaN": (row(-1, word(5, "nan")), "is not a whole number"),
    "birth NaN": (row(-1, word(10, "nan")), r"birth_time of cell \d+ is nan"),
    "more bounds": (instead(BOUNDS, f"{BOUNDS}0.0 99.0\n"), "its line 11 is not ITEM: ATOMS"),
    "other sides": (
        instead("e+00 1.2", "e+00 1.3", None), r"its box is 13 x [\d.]+ x [\d.]+, that of skin",
    ),
    "other sides of one": (instead("e+00 1.2", "e+00 1.3"), r"its box is 13 x [\d.]+ x"),
    "box elsewhere": (instead(f"{BOUNDS}0.0", f"{BOUNDS}1.0"), "does not begin at the origin"),
    "box of text": (instead(f"{BOUNDS}0.0", f"{BOUNDS}x0.0"), "no numbers or lines"),
    "tilted": (instead(BOUNDS, "ITEM: BOX TILTED\n"), "its line 7 is not ITEM: BOX BOUNDS"),
    "other columns": (instead("id type x y z", "id type x z y"), "its columns are id type x z y"),
    "no count": (instead(COUNT, "ITEM: NUMBER\n"), "its line 5 is not ITEM: NUMBER OF ATOMS"),
    "count of text": (instead(COUNT, f"{COUNT}x"), "no numbers or lines"),
    "negative step": (instead("TIMESTEP\n", "TIMESTEP\n-"), "has .* particles and the time"),
    "NaN time": (lambda text: text.replace("ITEM: TIME\n0", "ITEM: TIME\nnan", 1), "time nan"),
    "another file": (lambda text: f"LAMMPS data file\n{text}", "does not begin with ITEM: TIME"),
    "hole": (
        lambda text: without(3, -1)(text).replace(*_one_less(text)), "its membrane is not that of",
    ),
}  # fmt: skip


def _one_less(text: str) -> tuple[str, str]:
    """The count of the last frame, and one less."""
    last = text.split("ITEM: TIME\n")[-1].split("\n")
    head = "\n".join(last[:5])
    less = "\n".join([*last[:4], str(int(last[4]) - 1)])
    return head, less


def damage_hdf5(path: Path, name: str) -> str:
    """Do what a name says to a file; what must be said of it."""
    if name in BYTES:
        change, said = BYTES[name]
        path.write_bytes(change(path.read_bytes()))
        return said
    damage, said = IN_HDF5[name]
    (path.parent / "secret.txt").write_bytes(b"a secret" * 10**5)
    with h5py.File(path.parent / "secret.h5", "w") as secret, h5py.File(path, "r+") as file:
        secret["value"] = 1
        damage(file)
    return said


def damage_dump(path: Path, name: str) -> str:
    """The same for a dump."""
    change, said = IN_DUMP[name]
    path.write_text(change(path.read_text("ascii")), "ascii")
    return said
