"""Commands give no warnings of Python, whatever kinds and interventions a scene has."""

import pytest

SMALL = """
end_time = 1.0
[dermis]
present = false
[membrane]
lattice = [24, 28]
[output]
dump_interval = 0.5
"""
SCENES = {
    "wound": """
[cells]
stem = 2
[[interventions]]
name = "disk"
every = 0.5
until = 1.0
remove = ["stem", "ta"]
within = {cylinder = [6.0, 6.0, 2.0], half_space = [1.0, 0.0, 0.0, 1.0]}
[[interventions]]
name = "softening"
at = 0.75
set = {membrane.bending_stiffness = 0.1, cells.kinds.ta.generations = 3}
[[interventions]]
name = "sown"
at = 0.75
add = "nd"
places = [[2.0, 2.0], [9.0, 9.0, 25.0]]
""",
    "mutant": """
[cells]
stem = 1
generations = "endless"
[cells.kinds.mutant]
like = "stem"
count = 1
generations = 4
after_last = "nd"
stiffness = 75.0
color = "#e0559d"
""",
}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("name", "workers"), [("wound", True), ("mutant", False)])
def test_no_warnings(name, workers, skin, tmp_path, monkeypatch, request):
    if not workers:
        request.getfixturevalue("in_this_process")
    monkeypatch.setenv("PYTHONWARNINGS", "error::UserWarning")  # in the processes of an ensemble
    file = tmp_path / f"{name}.toml"
    file.write_text(f'name = "{name}"\n{SMALL}{SCENES[name]}')
    for command in (
        ("check", file), ("build", file, "-o", "built"),
        ("ensemble", file, "--seeds", "1", "-o", "many"),
    ):  # fmt: skip
        answer = skin(*command)
        assert (answer.code, "Warning" in answer.out + answer.err) == (0, False), answer
