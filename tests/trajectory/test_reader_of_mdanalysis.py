"""The tests that MDAnalysis has for its own readers, on ours.

They need the package MDAnalysisTests (60 MB): `pip install ".[reader]"`, then
`python -m pytest tests/trajectory/test_reader_of_mdanalysis.py`. Without it they are left out;
test_modes.py has what matters of them.
"""

from __future__ import annotations

import numpy as np
import pytest
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.trajectory.frame import CELL_STATE, WHOLE, Frame
from lammps_skin.trajectory.readers import SkinReader
from lammps_skin.trajectory.writer import TrajectoryWriter
from MDAnalysis.coordinates.DCD import DCDWriter

base = pytest.importorskip("MDAnalysisTests.coordinates.base")
pytestmark = [
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::UserWarning"),
]


class Reference(base.BaseReference):
    """Their five frames of five atoms, as five particles of a membrane."""

    def __init__(self, path):
        super().__init__()
        self.trajectory, self.reader = str(path), SkinReader
        self.writer, self.ext = DCDWriter, "dcd"
        self.prec = 5
        self.dimensions = np.array([81.1, 82.2, 83.3, 90, 90, 90], np.float32)
        self.volume = self.dimensions[:3].prod()
        for frame in (self.first_frame, self.second_frame, self.last_frame, self.jump_to_frame):
            frame.dimensions = self.dimensions


@pytest.fixture(scope="module")
def trajectory(tmp_path_factory):
    path = tmp_path_factory.mktemp("reference") / "skin.h5"
    state = {
        name: np.full(5, fill, np.int64 if name in WHOLE else float)
        for name, fill in CELL_STATE.items()
    }
    first = np.arange(15.0).reshape(5, 3)
    ids, kinds = np.arange(1, 6), np.full(5, int(Kind.MEMBRANE))
    links, triangles = np.empty((0, 2), int), np.empty((0, 3), int)
    with TrajectoryWriter(path, Scene.load("bare-membrane"), links, triangles) as writer:
        for n in range(5):
            edges = np.array([81.1, 82.2, 83.3])
            writer.write(Frame(n, float(n), edges, ids, kinds, first * 2**n, state, ids[-1] + 1))
    return path


class TestReader(base.MultiframeReaderTest):
    @staticmethod
    @pytest.fixture
    def ref(trajectory):
        return Reference(trajectory)
