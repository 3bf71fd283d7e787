"""The keyed random numbers of the plugin, at the ends of their interval."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SEED, EVENT, PURPOSE = 1, 0, 1
PROGRAM = """
#include "skin_random.h"
#include <cstdio>
#include <cstdlib>
using namespace LAMMPS_NS::SkinRandom;
int main(int, char **arg)
{
  const uint64_t cell = strtoull(arg[1], nullptr, 10);
  printf("%.17g", uniform(1, cell, 0, WAIT));
}
"""
MASK = 2**64 - 1


def unshift(z: int, bits: int) -> int:
    """The number that z ^ (z >> bits) was made of."""
    found = z
    for _ in range(64 // bits):
        found = z ^ (found >> bits)
    return found


def unmix(z: int) -> int:
    """Inverse of `mix`, the finaliser of splitmix64."""
    z = unshift(z, 31)
    z = unshift(z * pow(0x94D049BB133111EB, -1, 2**64) & MASK, 27)
    z = unshift(z * pow(0xBF58476D1CE4E5B9, -1, 2**64) & MASK, 30)
    return (z - 0x9E3779B97F4A7C15) & MASK


def mix(z: int) -> int:
    z = (z + 0x9E3779B97F4A7C15) & MASK
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9 & MASK
    z = (z ^ (z >> 27)) * 0x94D049BB133111EB & MASK
    return z ^ (z >> 31)


def cell_of(number: int) -> int:
    """The cell whose 64 random bits are a number."""
    return unmix(unmix(unmix(number) ^ PURPOSE) ^ EVENT) ^ mix(SEED)


@pytest.fixture(scope="module")
def uniform(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A program that prints the uniform number of a cell."""
    folder = tmp_path_factory.mktemp("uniform")
    (folder / "uniform.cpp").write_text(PROGRAM)
    compiler = [os.environ.get("CXX", "c++"), "-std=c++17", "-O2", f"-I{ROOT / 'plugins'}"]
    command = [*compiler, str(folder / "uniform.cpp"), "-o", str(folder / "uniform")]
    subprocess.run(command, check=True)
    return folder / "uniform"


@pytest.mark.parametrize(
    ("bits", "expected"),
    [(0, 2.0**-54), (2**63, 0.5), (2**64 - 2**12 - 1, 1 - 2.0**-52), (2**64 - 1, 1 - 2.0**-53)],
)
def test_uniform_is_between_0_and_1(uniform: Path, bits: int, expected: float) -> None:
    printed = subprocess.run(
        [str(uniform), str(cell_of(bits))], capture_output=True, text=True, check=True
    )
    assert 0 < float(printed.stdout) < 1
    assert float(printed.stdout) == pytest.approx(expected, rel=2.0**-52)
