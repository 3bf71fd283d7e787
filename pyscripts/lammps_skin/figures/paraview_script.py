"""A script with which ParaView shows what has been exported."""

from __future__ import annotations

from collections.abc import Sequence

from lammps_skin.kinds import Kind

SCRIPT = '''\
"""Membrane, cells and dermis in ParaView, from this folder: paraview --script=view.py"""

from pathlib import Path

from paraview import simple

FOLDER = Path(globals().get("__file__", "view.py")).resolve().parent
KINDS = {kinds}
DERMIS = {dermis!r}


def spheres(name):
    """The points of a series as spheres of their radius."""
    points = simple.PVDReader(registrationName=name, FileName=str(FOLDER / f"{{name}}.pvd"))
    glyphs = simple.Glyph(registrationName=f"{{name}} as spheres", Input=points, GlyphType="Sphere")
    glyphs.ScaleArray = ["POINTS", "radius"]
    glyphs.ScaleFactor = 2.0  # the sphere has a diameter of 1
    glyphs.OrientationArray = ["POINTS", "No orientation array"]
    glyphs.GlyphMode = "All Points"
    return glyphs


view = simple.GetActiveViewOrCreate("RenderView")
membrane = simple.PVDReader(registrationName="membrane", FileName=str(FOLDER / "membrane.pvd"))
shown = simple.Show(membrane, view)
simple.ColorBy(shown, ("POINTS", "height"))

shown = simple.Show(spheres("cells"), view)
simple.ColorBy(shown, ("POINTS", "kind"))  # or "clone", "divisions_left", "birth_time"
colours = simple.GetColorTransferFunction("kind")
colours.InterpretValuesAsCategories = 1
colours.Annotations = [text for number, (name, _) in KINDS.items() for text in (str(number), name)]
colours.IndexedColors = [part for _, colour in KINDS.values() for part in colour]
shown.SetScalarBarVisibility(view, True)

if DERMIS:
    shown = simple.Show(spheres("dermis"), view)
    simple.ColorBy(shown, None)
    shown.DiffuseColor = {dermal}
    shown.Opacity = 0.3

simple.GetAnimationScene().UpdateAnimationUsingDataTimeSteps()
view.ResetCamera()
simple.Render()
'''


def paraview_script(kinds: Sequence[Kind], dermis: bool) -> str:
    """Text of the script.

    Parameters
    ----------
    kinds : sequence of Kind
        Kinds of cells, whose names and colours are shown.
    dermis : bool
        Whether there is a series of the dermis.
    """
    table = {int(kind): (kind.name, kind.colour) for kind in kinds}
    return SCRIPT.format(kinds=table, dermis=dermis, dermal=list(Kind.DERMAL.colour))
