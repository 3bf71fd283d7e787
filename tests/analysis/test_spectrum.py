"""The height spectrum of single waves, and Parseval's theorem."""

import numpy as np
import pytest
from lammps_skin.analysis.spectrum import height_spectrum
from lammps_skin.analysis.surface import height_field
from meshes import sheet

BOX = (20.0, 15.0)
SHAPE = (40, 36)


def wave(numbers, amplitude, phase=0.3):
    x, y = np.meshgrid(*(np.arange(n) / n for n in SHAPE), indexing="ij")
    return amplitude * np.cos(2 * np.pi * (numbers[0] * x + numbers[1] * y) + phase)


@pytest.mark.parametrize("numbers", [(1, 0), (0, 2), (3, -4), (5, 7)])
def test_one_wave(numbers):
    found = height_spectrum(22.4 + wave(numbers, 0.6), BOX, width=1e-3)
    q = 2 * np.pi * np.hypot(numbers[0] / BOX[0], numbers[1] / BOX[1])
    filled = np.flatnonzero(found.power > 1e-20)
    assert len(filled) == 1
    assert found.q[filled] == pytest.approx(q, abs=5e-4)
    assert found.power[filled] * found.modes[filled] == pytest.approx(2 * 0.6**2 / 4, rel=1e-12)


def test_bins():
    found = height_spectrum(wave((1, 0), 1), BOX)
    # (1, 0), (0, 1) and their opposites; next to them (1, 1), (2, 0)
    assert found.modes[0] == 4
    assert found.q[0] == pytest.approx(np.pi * (1 / BOX[0] + 1 / BOX[1]))
    assert found.power[0] == pytest.approx(1 / 8)
    assert (np.diff(found.q) > 0).all()
    assert found.q[-1] <= np.pi * SHAPE[0] / BOX[0]
    coarse = height_spectrum(wave((1, 0), 1), BOX, width=1.0)
    assert len(coarse.q) == 7 and coarse.modes.sum() == found.modes.sum()


def test_all_modes_add_up_to_the_variance():
    height = wave((1, 2), 0.4) + wave((3, 0), 0.7) + wave((4, 5), 0.1, phase=2.0)
    found = height_spectrum(height, BOX)
    assert (found.power * found.modes).sum() == pytest.approx(height.var(), rel=1e-12)


def test_white_noise_is_flat():
    noise = np.random.default_rng(1).normal(0, 0.5, (200, *SHAPE))
    found = height_spectrum(noise, BOX)
    expected = 0.5**2 / (SHAPE[0] * SHAPE[1])
    error = expected / np.sqrt(200 * found.modes / 2)
    assert (np.abs(found.power - expected) < 4 * error).all()


def test_frames_are_averaged():
    first, second = wave((2, 1), 0.3), wave((2, 1), 0.9)
    found = height_spectrum(np.stack([first, second]), BOX).power
    mean = (height_spectrum(first, BOX).power + height_spectrum(second, BOX).power) / 2
    np.testing.assert_allclose(found, mean, rtol=1e-12, atol=1e-25)


def test_wave_of_a_membrane():
    a, shape = 0.5, (60, 70)
    k = 2 * np.pi / 15
    positions, triangles, box = sheet(shape, lambda x, y: a * np.cos(k * x))
    found = height_spectrum(height_field(positions, triangles, box, 0.5), box)
    strongest = found.power.argmax()
    # linear filling of triangles lowers a wave by up to (k spacing)^2/8 of itself
    total = found.power[strongest] * found.modes[strongest]
    assert total == pytest.approx(a**2 / 2, rel=(k * 0.5) ** 2 / 4)
    assert found.q[strongest] == pytest.approx(k, abs=np.pi / box[1])  # half a bin
