"""A timestep that is shortened for an interval, and times that do not fit it, are told of."""

import pytest
from lammps_skin.model.remarks import remarks
from lammps_skin.model.scene import Scene

SMALL = ("--set", "membrane.lattice=[12,14]")
END, DUMP, STEP = "end_time", "output.dump_interval", "numerics.timestep"


@pytest.mark.parametrize(
    ("changes", "timestep", "said"),
    [
        ({}, 0.5, []),
        ({DUMP: 0.0, END: 1000.0}, 0.5, []),
        (
            {END: 333.33}, 0.01,
            ["numerics.timestep = 0.01 instead of 0.5, which does not fit end_time = 333.33: "
             "50 times as many steps; multiples of 0.5 fit"],
        ),
        (
            {END: 100.1, DUMP: 3.3}, 0.1,
            ["numerics.timestep = 0.1 instead of 0.5, which does not fit end_time = 100.1 and "
             "output.dump_interval = 3.3: 5 times as many steps; multiples of 0.5 fit"],
        ),
        (
            {END: 321.0, "numerics.accuracy": "fast"}, 1.0,
            ["numerics.timestep = 1 instead of 2, which does not fit end_time = 321: "
             "2 times as many steps; multiples of 2 fit"],
        ),
        # what no timestep fits shortens none
        (
            {END: 333.3333}, 0.5,
            ["end_time = 333.333: is no whole number of steps of 0.5, and becomes 333.5"],
        ),
        (
            {END: 333.33, STEP: 0.25}, 0.25,
            ["end_time = 333.33: is no whole number of steps of 0.25, and becomes 333.25"],
        ),
        (
            {DUMP: 0.3, STEP: 0.25}, 0.25,
            ["output.dump_interval = 0.3: is no whole number of steps of 0.25, and becomes 0.5"],
        ),
        ({END: 0.333, "numerics.accuracy": "reference"}, 0.01,
         ["end_time = 0.333: is no whole number of steps of 0.01, and becomes 0.33"]),
        # a cell cycle that is short is no interval
        ({"cells.cycle_delay": 1.0, "cells.cycle_rate": 1.0}, 0.2, []),
    ],
)  # fmt: skip
def test_what_is_said(changes, timestep, said):
    scene = Scene.load("demo").replace(**changes)
    assert scene.numerics.timestep == timestep
    assert [line for line in remarks(scene) if "is stable up to" not in line] == said


def test_what_is_said_is_true(skin):
    """Of a run that ends between two steps, and of frames whose interval is none of steps."""
    given = ("--set", "numerics.timestep=0.25", "--set", "output.dump_interval=0.3")
    out = skin("run", "bare-membrane", *SMALL, *given, "--until", "1.1", "-o", "x").out
    assert "end_time = 1.1: is no whole number of steps of 0.25, and becomes 1\n" in out
    assert "output.dump_interval = 0.3: is no whole number of steps of 0.25, and becomes 0.5" in out
    assert "reached t = 1," in out
    assert "3 frames, t = 0 to 1" in skin("stats", "x").out


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("command", ["check", "ensemble"])
def test_commands_that_say_it(command, skin):
    given = (*SMALL, "--set", "end_time=2.03", "--set", "output.dump_interval=1")
    more = ("--seeds", "1") if command == "ensemble" else ()
    out = skin(command, "bare-membrane", *given, *more).out
    assert "numerics.timestep = 0.01 instead of 0.5, which does not fit end_time = 2.03" in out
