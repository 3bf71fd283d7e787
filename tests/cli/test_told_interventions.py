"""What the command tells of interventions: before a run, at its end, and afterwards."""

SOWN = """
name = "sown"
end_time = 4.0
[dermis]
present = false
[membrane]
lattice = [16, 18]
[output]
dump_interval = 2.0
[[interventions]]
name = "seeds"
at = 1.0
add = "nd"
places = [[1.0, 1.0], [4.0, 4.0]]
[[interventions]]
name = "softening"
at = 2.0
set = {membrane.bending_stiffness = 0.1}
[[interventions]]
name = "thinning"
every = 3.0
remove = "all"
within = {half_space = [1.0, 0.0, 0.0, 2.0]}
"""


def test_what_is_told(skin, tmp_path):
    (tmp_path / "sown.toml").write_text(SOWN)
    checked = skin("check", "sown.toml", "--set", "interventions.seeds.at=1.5").out
    for line in (
        "seeds at t = 1.5 adds 2 nd",
        "softening at t = 2 sets membrane.bending_stiffness = 0.1",
        "thinning at t = 3, every 3 removes all within half_space [1.0, 0.0, 0.0, 2.0]",
    ):
        assert line in " ".join(checked.split())
    ran = skin("run", "sown.toml", "-o", "sown")
    assert ran.code == 0
    told = ran.out + ran.err
    assert "1 ND; 0 births, 1 removal\n" in told
    for line in ("seeds: 2 added", "softening: changed", "thinning: 1 removed"):
        assert line in told
    stats = " ".join(skin("stats", "sown").out.split())
    assert "removals 1 thinning seeds 2 added softening changed thinning 1 removed" in stats
