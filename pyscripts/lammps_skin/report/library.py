"""three.js, which draws the page in three dimensions, from an installed package."""

from __future__ import annotations

import re
from importlib.metadata import PackageNotFoundError, distribution
from zipfile import BadZipFile, ZipFile

from lammps_skin.errors import SkinError

PACKAGE = "trimesh"  # small, and has three.js in the page with which it shows meshes
ARCHIVE, MEMBER = "trimesh/resources/templates/viewer.zip", "viewer.html.template"
# three.js is the first script of that page, and ends like this; what follows is trimesh's own use
SCRIPT = re.compile(r'<script>(/\*\*\s+\* @license.*?"__esModule",\{value:!0\}\)\}\)\);)', re.S)
NEEDED = f"needs {PACKAGE}: pip install '{PACKAGE}>=5,<6'"


def three() -> str:
    """Source of three.js, which defines `THREE`.

    Raises
    ------
    SkinError
        If the package is not installed, or keeps it elsewhere.
    """
    try:
        package = distribution(PACKAGE)
    except PackageNotFoundError:
        raise SkinError(f"three.js: {NEEDED}") from None
    try:
        with ZipFile(str(package.locate_file(ARCHIVE))) as archive:
            page = archive.read(MEMBER).decode()
    except (OSError, KeyError, BadZipFile):
        page = ""
    found = SCRIPT.search(page)
    if not found:
        raise SkinError(f"three.js: is not in {PACKAGE} {package.version}; {NEEDED}")
    return found[1]
