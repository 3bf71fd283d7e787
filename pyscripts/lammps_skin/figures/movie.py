"""Movies of a run: the snapshot of every frame, one after the other, from one camera."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from lammps_skin.errors import FigureError
from lammps_skin.figures.look import Look
from lammps_skin.figures.moments import Source, all_moments, read_moments
from lammps_skin.figures.snapshot import check_suffix, check_view, figure_of, shown_of
from lammps_skin.files import atomic_write
from lammps_skin.style import plain

FORMATS = ("gif", "mp4", "webp")
QUALITY = 85  # of a webp, to 100
COMPRESSION = 18  # of an mp4: 0 keeps all, 23 is usual

Pixels = NDArray[np.uint8]


def pixels_of(figure: Figure) -> Pixels:
    """Red, green and blue (height, width, 3) of a figure, as a file of pixels has them."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()  # type: ignore[no-untyped-call]
    return np.asarray(canvas.buffer_rgba())[..., :3]  # type: ignore[no-untyped-call]


@plain
def movie(
    source: Source, path: str | Path, view: str = "3d", show: Sequence[str] | None = None,
    y: float | None = None, look: Look | None = None, rate: float = 12.0, every: int = 1,
    told: Callable[[int, float], None] = lambda done, time: None,
) -> Path:  # fmt: skip
    """Write a movie of a run.

    Parameters
    ----------
    source : path
        Of a run, see `read_moments`.
    path : path
        File to write, .mp4, .webp or .gif.
    view, show, look
        As for `snapshot`.
    y : float, optional
        Of the section; through the highest stem cell of the last frame if not given.
    rate : float
        Pictures per second.
    every : int
        Show each of so many frames.
    told : callable
        Called after each picture, with the number of pictures made and the time of the last one.

    Raises
    ------
    FigureError
        If there is no such view or kind of cell, or if the file cannot be written.
    """
    check_view(view)
    path = Path(path)
    check_suffix(path, FORMATS)
    if not 0.1 <= rate <= 100:
        raise FigureError(f"fps = {rate:g}: must be from 0.1 to 100")
    if every < 1:
        raise FigureError(f"every = {every}: must be 1 or more")
    look = look or Look()
    (last,) = read_moments(source, [None])
    shown = shown_of(last, show, y, look)

    def pictures() -> Iterator[Pixels]:
        for number, moment in enumerate(all_moments(source, every), start=1):
            yield pixels_of(figure_of(moment, view, shown))
            told(number, moment.time)

    if path.suffix == ".mp4" and find_spec("imageio_ffmpeg") is None:
        raise FigureError(
            f"output {path}: needs the package imageio-ffmpeg (pip install imageio-ffmpeg); "
            "a .webp or .gif does without"
        )
    write = _write_video if path.suffix == ".mp4" else _write_images
    try:
        with atomic_write(path) as place:
            write(place, path.suffix, pictures(), rate)
    except OSError as error:
        raise FigureError(f"output {path}: {error.strerror or error}") from None
    return path


def _write_images(place: Path, suffix: str, pictures: Iterator[Pixels], rate: float) -> None:
    """An animated webp or gif, which is played again and again."""
    images = (Image.fromarray(picture) for picture in pictures)
    next(images).save(
        place, format=suffix.removeprefix("."), save_all=True, append_images=images,
        duration=round(1000 / rate), loop=0, quality=QUALITY,
    )  # fmt: skip


def _write_video(place: Path, _: str, pictures: Iterator[Pixels], rate: float) -> None:
    """An mp4 that browsers and slides play."""
    import imageio_ffmpeg

    first = _even(next(pictures))
    video = imageio_ffmpeg.write_frames(
        str(place), first.shape[1::-1], fps=rate, macro_block_size=2, quality=None,
        output_params=["-crf", str(COMPRESSION), "-f", "mp4", "-movflags", "+faststart"],
    )  # fmt: skip
    video.send(None)
    video.send(np.ascontiguousarray(first))
    for picture in pictures:
        video.send(np.ascontiguousarray(_even(picture)))
    video.close()


def _even(picture: Pixels) -> Pixels:
    """The picture without its last row or column where their number is odd: mp4 has even ones."""
    high, wide = picture.shape[:2]
    return picture[: high - high % 2, : wide - wide % 2]
