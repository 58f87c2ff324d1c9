"""`crowdbot new trial --import` with agent files of HuNavSim and drawings in DXF."""

from crowdbot.cli import main
from crowdbot.trials import load_trial

DRAWING = (
    "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n"
    "0\nLINE\n8\nwalls\n10\n0\n20\n0\n11\n5000\n21\n0\n0\nLINE\n8\ndoors\n10\n0\n20\n1000\n11\n900\n21\n1000\n"
    "0\nENDSEC\n0\nEOF\n"
)
AGENTS = """hunav_loader:
  ros__parameters:
    agents: [ann]
    ann:
      behavior: {type: 4, configuration: 0}
      init_pose: {x: 1.0, y: 2.0, h: 0.0}
      goals: [g0]
      g0: {x: 6.0, y: 2.0}
"""


def test_a_layer_of_a_drawing_becomes_a_trial(tmp_path, capsys):
    (tmp_path / "plan.dxf").write_text(DRAWING)
    out = tmp_path / "plan.xml"
    assert main(["new", "trial", str(out), "--import", str(tmp_path / "plan.dxf"), "--layer", "walls"]) == 0
    said = capsys.readouterr().out
    assert "layer doors: not chosen" in said
    assert [wall.points for wall in load_trial(str(out)).stage.walls] == [((0.0, 0.0), (5.0, 0.0))]
    other = tmp_path / "large.xml"
    command = ["new", "trial", str(other), "--import", str(tmp_path / "plan.dxf"), "--unit", "m"]
    assert main(command) == 0
    assert load_trial(str(other)).stage.walls[0].points[1] == (5000.0, 0.0)


def test_agents_of_hunavsim_become_a_trial(tmp_path, capsys):
    (tmp_path / "agents.yaml").write_text(AGENTS)
    out = tmp_path / "agents.xml"
    assert main(["new", "trial", str(out), "--import", str(tmp_path / "agents.yaml")]) == 0
    assert "the robot is not in the file" in capsys.readouterr().out
    (ann,) = load_trial(str(out)).agents
    assert [reaction.type for reaction in ann.reactions] == ["scared"]


def test_a_wrong_layer_is_told(tmp_path, capsys):
    (tmp_path / "plan.dxf").write_text(DRAWING)
    out = tmp_path / "plan.xml"
    assert main(["new", "trial", str(out), "--import", str(tmp_path / "plan.dxf"), "--layer", "wall"]) == 2
    assert "there is no layer 'wall' with walls; layers are doors, walls" in capsys.readouterr().err
    assert not out.exists()
