"""The page in a real browser, opened from disk."""

from __future__ import annotations

import csv
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.model.scene import Scene
from lammps_skin.report.page import report
from lammps_skin.run.simulation import Simulation
from lammps_skin.trajectory.store import Store

from tests.report.browser import Browser

VIEW = "page.views[0]"
PLACE = """(() => {{
  const view = page.views[0], run = view.run;
  view.lens.updateMatrixWorld();
  const box = view.renderer.domElement.getBoundingClientRect();
  for (let n = run.start[view.frame]; n < run.start[view.frame + 1]; n++) {{
    if (run.arrays.cell_id[n] !== {id}) continue;
    const seen = new THREE.Vector3(...run.cell(n)).project(view.lens);
    return [box.left + (seen.x + 1) / 2 * box.width, box.top + (1 - seen.y) / 2 * box.height];
  }}
}})()"""


def pixels(page: Browser) -> np.ndarray[Any, Any]:
    """Pixels of the picture in three dimensions, once it is drawn; its edges may be half ones."""
    page.until(f"!{VIEW}.due")
    box = "document.querySelector('.view canvas').getBoundingClientRect()"
    place = page.value(f"(() => {{ const b = {box}; return [b.x, b.y, b.width, b.height]; }})()")
    picture = page.picture(**dict(zip(("x", "y", "width", "height"), place, strict=True)))
    return picture[1:-1, 1:-1]


def drawn(picture: np.ndarray[Any, Any]) -> float:
    """Fraction of pixels that are not background."""
    return float((np.abs(picture.astype(int) - picture[-1, -1]).max(axis=2) > 12).mean())


def test_it_needs_nothing_else_and_complains_of_nothing(page: Browser, written: Path) -> None:
    assert page.requested == [written.as_uri()]
    assert page.errors == []
    assert page.value("document.title") == "small"
    assert 0.1 < drawn(pixels(page)) < 0.9


def test_the_slider_changes_what_is_drawn(page: Browser, run: Path) -> None:
    """As many cells, at the same places, as the trajectory has at that time."""
    store, seen = Store(run / "skin.h5"), {}
    assert page.value("Number(document.getElementById('slider').max)") == len(store) - 1
    for n, frame in enumerate(store):
        page.choose("slider", str(n))
        cells = frame.positions[is_cell(frame.kinds)]
        assert page.value(f"{VIEW}.drawn") == page.value(f"{VIEW}.balls.count") == len(cells)
        told = f"{len(cells)} cell{'s' * (len(cells) > 1)} drawn"
        assert told in page.value(f"{VIEW}.caption.textContent")
        first, until = page.value(f"[{VIEW}.run.start[{n}], {VIEW}.run.start[{n + 1}]]")
        shown = [page.value(f"{VIEW}.run.cell({m})") for m in range(first, until)]
        off = np.array(shown) - cells
        off[:, :2] -= np.array(frame.edges[:2]) * np.rint(off[:, :2] / frame.edges[:2])
        assert np.abs(off).max() < 2e-3
        seen[len(cells)] = pixels(page)
    least, most = min(seen), max(seen)
    assert least < most
    assert np.abs(seen[most].astype(int) - seen[least]).max() > 100


def test_colours_switch(page: Browser, run: Path) -> None:
    kinds = Store(run / "skin.h5")[-1].kinds
    kinds = kinds[is_cell(kinds)]
    scene = Scene.load(run / "scene.toml")
    expected = [scene.kind(kind).colour for kind in kinds.tolist()]
    colours = f"[...{VIEW}.balls.instanceColor.array].slice(0, 3 * {VIEW}.drawn)"
    assert page.value(colours) == pytest.approx(np.ravel(expected), abs=1 / 255)
    pictures = {"kind": pixels(page)}
    names = page.value("[...document.getElementById('cells-by').options].map((o) => o.value)")
    assert names == ["kind", "height", "curvature", "clone", "age", "left", "below"]
    for name in names[1:]:
        page.choose("cells-by", name)
        pictures[name] = pixels(page)
    for name in names[1:]:
        assert (pictures[name] != pictures["kind"]).any(), name
    assert len(set(map(bytes, pictures.values()))) >= len(names) - 1
    for name in ("height", "curvature"):
        page.choose("membrane-by", name)
        assert (pixels(page) != pictures["below"]).any(), name
    assert page.errors == []


def test_a_click_shows_the_history_of_a_cell(page: Browser, run: Path) -> None:
    """All rows of events.csv in which the cell is, with their times and generations."""
    with (run / "events.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert {"birth", "death"} <= {row["kind"] for row in rows}
    page.value("document.querySelector('[data-look=above]').click()")
    page.until(f"!{VIEW}.due")
    ids = page.value(
        f"(() => {{ const r = {VIEW}.run, f = {VIEW}.frame;"
        " return [...r.arrays.cell_id.slice(r.start[f], r.start[f + 1])]; })()"
    )
    involved = Counter(int(row[column]) for row in rows for column in ("id", "parent"))
    found = 0
    for cell in sorted(ids, key=lambda cell: -involved[cell]):
        place = page.value(PLACE.format(id=cell))
        if page.value(f"{VIEW}.run.arrays.cell_id[{VIEW}.cellAt({place[0]}, {place[1]})]") != cell:
            continue  # another cell lies above it
        page.click(*place)
        page.until(f"document.querySelector('[data-history=\"{cell}\"]') !== null")
        cells = "[...document.querySelectorAll('[data-history] tr')].slice(1).map((row) => "
        told = page.value(cells + "[...row.children].map((cell) => cell.textContent))")
        theirs = [row for row in rows if str(cell) in (row["id"], row["parent"])]
        assert [(float(row[0]), int(row[3])) for row in told] == [
            (pytest.approx(float(row["time"]), abs=6e-4), int(row["divisions_left"]))
            for row in sorted(theirs, key=lambda row: float(row["time"]))
        ]
        found += bool(theirs)
        if found == 2:
            break
    assert found == 2
    page.click(30, 300)
    page.until("document.querySelector('[data-history]') === null")


def test_copies_cuts_and_kinds(page: Browser) -> None:
    page.value("document.querySelector('[data-look=above]').click()")
    alone = drawn(pixels(page))
    page.value("document.getElementById('copies').click()")
    assert drawn(pixels(page)) > 1.5 * alone
    page.value("document.getElementById('copies').click()")
    page.choose("clip-axis", "x")
    assert 0.3 * alone < drawn(pixels(page)) < 0.7 * alone
    for _ in range(2):  # the viewer stands on the side that is cut away, wherever that is
        page.until(f"!{VIEW}.due")
        assert page.value(f"{VIEW}.plane.distanceToPoint({VIEW}.lens.position)") < 0
        page.value("page.camera.look('aside'); page.camera.turn(450, 0)")  # half a turn
    page.value("page.camera.look('above')")
    page.choose("clip-axis", "")
    assert drawn(pixels(page)) == pytest.approx(alone, abs=1e-3)
    cells = page.value(f"{VIEW}.drawn")
    page.value("document.querySelector('#kinds input[value=stem]').click()")
    assert page.value(f"{VIEW}.drawn") == cells - 1


def test_play_turn_and_come_closer(page: Browser) -> None:
    """It plays from the start to the end and stops there, or at the space bar."""
    page.choose("speed", "15")
    page.value("document.getElementById('play').click()")
    assert page.value("page.time") == 0
    page.until("page.time === page.steps.at(-1) && !page.playing")
    page.value("document.getElementById('play').click(); document.activeElement.blur()")
    page.call("Input.dispatchKeyEvent", type="keyDown", code="Space", key=" ")
    assert page.value("page.playing") == 0
    page.choose("slider", "5")
    seen = [pixels(page)]
    x, y = page.value("(() => { const b = document.querySelector('.view canvas')"
                      ".getBoundingClientRect(); return [b.x + 200, b.y + 200]; })()")  # fmt: skip
    mouse = {"button": "left", "buttons": 1, "clickCount": 1}
    for kind, step in (("mousePressed", 0), ("mouseMoved", 60), ("mouseReleased", 60)):
        page.call("Input.dispatchMouseEvent", type=kind, x=x + step, y=y, **mouse)
    seen.append(pixels(page))
    wheel = {"type": "mouseWheel", "deltaX": 0, "deltaY": -300}
    page.call("Input.dispatchMouseEvent", x=x, y=y, **wheel)
    page.until("page.camera.distance < 2")
    seen.append(pixels(page))
    assert page.value("page.camera.azimuth") == pytest.approx(-62 - 0.4 * 60)
    assert (seen[1] != seen[0]).any() and drawn(seen[2]) > 1.2 * drawn(seen[1])


def test_curves_are_those_of_the_table_and_lead_to_a_time(page: Browser, run: Path) -> None:
    from lammps_skin.analysis.observables import observables

    table = observables(run)
    page.choose("slider", "3")
    shown = "document.querySelector('[data-column={}] b').textContent"
    for column in ("ta", "births", "coverage", "height_std"):
        said = float(page.value(shown.format(column)).replace(",", ""))
        assert said == pytest.approx(table[column][3], rel=6e-3), column
    box = "document.querySelector('[data-column=coverage] svg').getBoundingClientRect()"
    page.value("document.querySelector('[data-column=coverage]').scrollIntoView()")
    left, top, width = page.value(f"(() => {{ const b = {box}; return [b.x, b.y, b.width]; }})()")
    page.click(left + 0.2 * width, top + 50)
    assert page.value("page.time") == table["time"][1]


def test_two_runs_side_by_side(browser: Browser, run: Path, tmp_path: Path) -> None:
    browser.errors.clear()
    browser.open(report([run, run], tmp_path / "two.html", frames=3).as_uri())
    assert browser.value("page.views.map((view) => view.frame)") == [2, 2]
    browser.choose("slider", "0")
    assert browser.value("page.views.map((view) => view.drawn)") == [1, 1]
    assert "3 of 6 frames" in browser.value("document.getElementById('warnings').textContent")
    assert browser.errors == []


def test_the_dermis_is_drawn_where_it_is(browser: Browser, tmp_path: Path) -> None:
    """Only if it is wanted; its box hides it."""
    scene = Scene.load("one-stem").replace(end_time=1.0, **{"membrane.lattice": [24, 28]})
    with Simulation.begin(scene, tmp_path / "run") as simulation:
        simulation.run()
    plain = report([tmp_path / "run"], tmp_path / "plain.html").read_text()
    browser.errors.clear()
    path = report([tmp_path / "run"], tmp_path / "dermis.html", dermis=True)
    assert len(plain) < len(path.read_text())
    browser.open(path.as_uri())
    frame = Store(tmp_path / "run" / "skin.h5")[-1]
    dermal = frame.positions[frame.kinds == Kind.DERMAL]
    count = browser.value(f"{VIEW}.grains.count")
    assert count == len(dermal) > 0
    matrix = browser.value(f"[...{VIEW}.grains.instanceMatrix.array]")
    off = np.reshape(matrix, (count, 16))[:, 12:15] - dermal
    off[:, :2] -= np.array(frame.edges[:2]) * np.rint(off[:, :2] / frame.edges[:2])
    assert np.abs(off).max() < 1e-3
    shown = pixels(browser)
    browser.value("document.getElementById('dermis-shown').click()")
    assert drawn(pixels(browser)) < 0.8 * drawn(shown)
    assert browser.errors == []


def test_what_a_run_lacks_has_no_box(page: Browser) -> None:
    for name, shown in (("copies", True), ("dermis-shown", False), ("clip-at", False)):
        box = f"document.getElementById('{name}').getBoundingClientRect()"
        assert (page.value(f"{box}.width") > 0) == shown, name


def test_a_membrane_alone(browser: Browser, tmp_path: Path) -> None:
    scene = Scene.load("bare-membrane").replace(end_time=1.0, **{"membrane.lattice": [12, 14]})
    with Simulation.begin(scene, tmp_path / "bare") as simulation:
        simulation.run()
    browser.errors.clear()
    browser.open(report([tmp_path / "bare"], tmp_path / "bare.html").as_uri())
    assert browser.value("page.views[0].drawn") == 0
    assert drawn(pixels(browser)) > 0.1
    assert browser.errors == []
