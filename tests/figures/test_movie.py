"""Movies: their pictures are snapshots, from one camera."""

from __future__ import annotations

import matplotlib.image
import numpy as np
import pytest
from lammps_skin.errors import FigureError
from lammps_skin.figures.look import Look
from lammps_skin.figures.moments import all_moments
from lammps_skin.figures.movie import movie, pixels_of
from lammps_skin.figures.scenery import camera_of
from lammps_skin.figures.snapshot import figure_of, shown_of, snapshot
from lammps_skin.style import plain
from PIL import Image

SMALL = Look(size=160, dpi=40)


def pictures(path):
    """Pictures of a webp or gif, and of an mp4 by another reader than its writer."""
    if path.suffix == ".mp4":
        ffmpeg = pytest.importorskip("imageio_ffmpeg")
        frames = ffmpeg.read_frames(str(path))
        wide, high = next(frames)["size"]
        return [np.frombuffer(one, np.uint8).reshape(high, wide, 3) for one in frames]
    with Image.open(path) as image:
        found = []
        for n in range(image.n_frames):
            image.seek(n)
            found.append(np.asarray(image.convert("RGB")))
        return found


@pytest.mark.parametrize("suffix", ["webp", "mp4", "gif"])
def test_pictures_of_a_movie_are_the_snapshots_of_their_times(run, tmp_path, suffix):
    if suffix == "mp4":
        pytest.importorskip("imageio_ffmpeg")
    told = []
    path = movie(
        run, tmp_path / f"new/a.{suffix}", look=SMALL, told=lambda *news: told.append(news)
    )
    assert [number for number, _ in told] == [1, 2, 3]
    assert [time for _, time in told] == pytest.approx([0, 5, 10])
    found = pictures(path)
    assert len(found) == 3
    for time, picture in zip((0, 5, 10), found, strict=True):
        still = snapshot(run, time, tmp_path / "still.png", look=SMALL)
        still = (255 * matplotlib.image.imread(still)[..., :3]).round()
        high, wide = picture.shape[:2]
        lost = np.abs(still[:high, :wide] - picture)  # by compression
        assert lost.mean() < 6
        others = [np.abs(picture.astype(float) - other).mean() for other in found]
        assert lost.mean() < np.median([difference for difference in others if difference > 0]) + 6


@plain
def test_before_compression_a_picture_is_the_snapshot(run, tmp_path):
    for moment in all_moments(run, 2):
        figure = figure_of(moment, "3d", shown_of(moment, None, None, SMALL))
        still = snapshot(run, moment.time, tmp_path / "still.png", look=SMALL)
        assert np.array_equal(
            pixels_of(figure), (255 * matplotlib.image.imread(still)[..., :3]).round()
        )


def test_colours_of_heights_mean_the_same_all_the_time(run):
    limits = {
        figure.axes[0].images[0].get_clim()
        for moment in all_moments(run)
        for figure in [figure_of(moment, "height", shown_of(moment, ["none"], None, SMALL))]
    }
    assert len(limits) == 1


def test_what_a_movie_needs_is_told_before_it_is_drawn(run, tmp_path, monkeypatch):
    monkeypatch.setattr("lammps_skin.figures.movie.find_spec", lambda name: None)
    with pytest.raises(FigureError, match=r"a\.mp4: needs the package imageio-ffmpeg"):
        movie(run, tmp_path / "a.mp4")


def test_the_camera_stays(run):
    first, *others = [camera_of(moment, SMALL) for moment in all_moments(run)]
    for camera in others:
        assert camera.scale == first.scale and camera.shape == first.shape
        assert np.array_equal(camera.origin, first.origin)


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"path": "a.avi"}, r"a\.avi: its suffix must be one of gif, mp4, webp"),
        ({"view": "side"}, r"view = 'side': must be one of"),
        ({"rate": 0.0}, r"fps = 0: must be from 0\.1 to 100"),
        ({"every": 0}, r"every = 0: must be 1 or more"),
    ],
)
def test_movies_that_cannot_be_are_refused(run, tmp_path, options, text):
    path = tmp_path / options.pop("path", "a.webp")
    with pytest.raises(FigureError, match=text):
        movie(run, path, **options)
    assert not path.exists()
