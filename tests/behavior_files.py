"""Behaviour trees and a trial with them for tests, in the form of the files of HuNavSim."""

from pathlib import Path

REGULAR = """<root main_tree_to_execute = "WalkTree">
  <TreeNodesModel>
    <Action ID="RegularNav"><input_port name="agent_id" type="int">the agent</input_port></Action>
  </TreeNodesModel>
  <BehaviorTree ID="WalkTree">
    <Fallback name="WalkFallback">
      <Sequence name="Walk">
        <Inverter><IsGoalReached agent_id="{id}" /></Inverter>
        <RegularNav agent_id="{id}" time_step="{dt}" />
      </Sequence>
      <UpdateGoal agent_id="{id}" />
    </Fallback>
  </BehaviorTree>
</root>
"""
VISITOR = """<root main_tree_to_execute = "VisitorTree">
  <include path="walk.xml"/>
  <BehaviorTree ID="VisitorTree">
    <Fallback name="Visitor">
      <Sequence name="Meets">
        <IsRobotVisible agent_id="{id}" distance="4.0" />
        <Inverter><TimeExpiredCondition seconds="3.0" ts="{dt}" only_once="True" /></Inverter>
        <CuriousNav agent_id="{id}" time_step="{dt}" gap="0.6" />
      </Sequence>
      <Sequence name="Walks">
        <SetBlackboard output_key="agentid" value="{id}" />
        <SetBlackboard output_key="timestep" value="{dt}" />
        <SubTree ID="WalkTree" id="agentid" dt="timestep" />
      </Sequence>
    </Fallback>
  </BehaviorTree>
  <BehaviorTree ID="GroupTree">
    <ReactiveFallback>
      <Sequence><IsRobotNear distance="2.5"/><TalkInGroup/></Sequence>
      <Sequence><IsGoalReached/><Wait seconds="1.5"/><UpdateGoal/></Sequence>
      <RegularNav/>
    </ReactiveFallback>
  </BehaviorTree>
</root>
"""
HALL = """
<trial name="hall" duration="9">
  <stage walkable="0,0 16,0 16,8 0,8"/>
  <crowd type="orca"/>
  <journey name="tour" then="again"><point x="3" y="2"/><point x="12" y="2"/><point x="12" y="6"/></journey>
  <agent name="ann" x="9" y="4.3" journey="tour"><behavior file="visitor.xml" regular="ignore"/></agent>
  <spawner name="pairs" count="6" zone="7,1 15,1 15,7 7,7" journey="tour">
    <group size="2"/>
    <reaction type="scared" share="0.3"/>
    <behavior file="visitor.xml" tree="GroupTree" share="0.6"/>
  </spawner>
  <source zone="14,1 15,1 15,7 14,7" journey="tour" rate="0.5"><behavior file="visitor.xml" share="0.5"/></source>
  <robot name="cart" x="1" y="4" radius="0.3">
    <goal x="15" y="4"/>
    <drive type="differential-drive"/>
    <navigator type="orca"/>
  </robot>
  <end goal="false" collision="false"/>
</trial>
"""


def write_hall(folder: Path) -> Path:
    """Write the trial and its trees to a folder, and return the path of the trial."""
    for name, text in (("hall.xml", HALL), ("visitor.xml", VISITOR), ("walk.xml", REGULAR)):
        (folder / name).write_text(text, encoding="utf-8")
    return folder / "hall.xml"
