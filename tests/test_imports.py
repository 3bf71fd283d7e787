"""What importing the package costs, and what it gives."""

import subprocess
import sys

import lammps_skin
import pytest
from lammps_skin import errors

HEAVY = {"numpy", "scipy", "pydantic", "lammps", "h5py", "MDAnalysis", "typer", "rich"}


def modules_after(statement: str) -> set[str]:
    """Modules of a fresh interpreter after a statement."""
    code = f"{statement}\nimport sys; print(*sys.modules)"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(ended.stdout.split())


def test_the_plugin_module_imports_nothing_heavy():
    modules = modules_after("import lammps_skin.plugin")
    assert not HEAVY & modules
    ours = {name for name in modules if name.startswith("lammps_skin")}
    assert ours == {"lammps_skin", "lammps_skin.plugin"}


def test_the_help_of_skin_imports_nothing_heavy():
    """Nor does it load a subcommand."""
    modules = modules_after(
        "from contextlib import redirect_stdout, suppress; from io import StringIO\n"
        "from lammps_skin.cli import main\n"
        "with suppress(SystemExit), redirect_stdout(StringIO()): main(['--help'])\n"
    )
    assert HEAVY & modules == {"typer"}
    assert "lammps_skin.cli.run" not in modules


@pytest.mark.parametrize(
    ("module", "needless"),
    [
        ("engine.worker", {"scipy", "pydantic", "h5py", "MDAnalysis"}),  # on every rank
        ("study.ensemble", {"scipy.stats", "scipy.optimize", "matplotlib"}),  # in every worker
    ],
)
def test_what_starts_many_times_imports_no_more_than_it_needs(module, needless):
    assert not needless & modules_after(f"import lammps_skin.{module}")


@pytest.mark.parametrize("name", lammps_skin.__all__)
def test_public_names_are_there_at_first_use(name):
    assert getattr(lammps_skin, name).__name__ == name
    assert name in dir(lammps_skin)


def test_all_errors_are_there():
    ours = {name for name, kind in vars(errors).items() if is_error(kind)}
    assert ours and ours == {name for name in lammps_skin.__all__ if name.endswith("Error")}


def is_error(kind):
    return isinstance(kind, type) and issubclass(kind, errors.SkinError)


def test_other_names_are_not():
    with pytest.raises(AttributeError, match=r"lammps_skin.*no attribute 'Scenery'"):
        lammps_skin.Scenery  # noqa: B018
