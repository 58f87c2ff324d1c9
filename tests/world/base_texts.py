"""Small robots of every kind of base, as xacro files with sensors and drive plugins."""

import math

HEAD = "<robot name='{name}' xmlns:xacro='http://ros.org/wiki/xacro'>"
BOX = """
<link name='base_link'>
  <inertial><origin xyz='0 0 0.2'/><mass value='20'/>
    <inertia ixx='0.6' iyy='0.8' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>
  <visual><origin xyz='0 0 0.2'/><geometry><box size='0.6 0.36 0.2'/></geometry></visual>
  <collision><origin xyz='0 0 0.2'/><geometry><box size='0.6 0.36 0.2'/></geometry></collision>
</link>
<link name='laser'/>
<joint name='laser_joint' type='fixed'>
  <parent link='base_link'/><child link='laser'/><origin xyz='0.25 0 0.32'/></joint>
<gazebo reference='laser'><sensor name='scan' type='gpu_ray'><update_rate>20</update_rate>
  <ray><scan><horizontal><samples>181</samples><min_angle>-1.57</min_angle><max_angle>1.57</max_angle></horizontal></scan>
  <range><min>0.1</min><max>12</max></range><noise><type>gaussian</type><stddev>0.01</stddev></noise></ray>
</sensor></gazebo>
<xacro:macro name='wheel' params='name x y yaw:=0 parent:=base_link radius:=0.1'>
  <link name='${name}'>
    <inertial><mass value='1'/><inertia ixx='0.003' iyy='0.003' izz='0.005' ixy='0' ixz='0' iyz='0'/></inertial>
    <collision><geometry><cylinder radius='${radius}' length='0.04'/></geometry></collision>
  </link>
  <joint name='${name}_joint' type='continuous'><parent link='${parent}'/><child link='${name}'/>
    <origin xyz='${x} ${y} ${radius if parent == "base_link" else 0}' rpy='${-pi / 2} 0 ${yaw}'/><axis xyz='0 0 1'/>
  </joint>
</xacro:macro>
<xacro:macro name='steered' params='name x y'>
  <link name='${name}_fork'><inertial><mass value='0.3'/>
    <inertia ixx='0.001' iyy='0.001' izz='0.001' ixy='0' ixz='0' iyz='0'/></inertial></link>
  <joint name='${name}_steer' type='revolute'><parent link='base_link'/><child link='${name}_fork'/>
    <origin xyz='${x} ${y} 0.1'/><axis xyz='0 0 1'/><limit lower='-0.5' upper='0.5' effort='20' velocity='3'/></joint>
  <xacro:wheel name='${name}' x='0' y='0' parent='${name}_fork'/>
</xacro:macro>
"""
CASTOR = """<link name='castor'><inertial><mass value='0.1'/>
  <inertia ixx='0.001' iyy='0.001' izz='0.001' ixy='0' ixz='0' iyz='0'/></inertial>
  <collision><geometry><sphere radius='0.05'/></geometry></collision></link>
<joint name='castor_joint' type='fixed'>
  <parent link='base_link'/><child link='castor'/><origin xyz='-0.25 0 0.05'/></joint>
"""


def wheels(*rows):
    return "".join(f"<xacro:wheel name='{name}' x='{x}' y='{y}' yaw='{yaw}'/>" for name, x, y, yaw in rows)


PAIR = (("left", 0, 0.2, 0), ("right", 0, -0.2, 0))
FOUR = tuple(
    (f"{e}_{s}", x, y, 0) for e, x in (("front", 0.2), ("rear", -0.2)) for s, y in (("left", 0.2), ("right", -0.2))
)
REAR = (("rear_left", -0.2, 0.2, 0), ("rear_right", -0.2, -0.2, 0))
STAR = tuple(
    (f"omni{k}", 0.2 * math.cos(a), 0.2 * math.sin(a), a - math.pi / 2)
    for k, a in enumerate((0.0, 2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0))
)
LEG = """
<xacro:macro name='leg' params='name x y'>
  <xacro:macro name='part' params='link joint parent z axis'>
  <link name='${link}'><inertial><origin xyz='0 0 -0.1'/><mass value='0.5'/>
    <inertia ixx='0.002' iyy='0.002' izz='0.0005' ixy='0' ixz='0' iyz='0'/></inertial>
    <collision><origin xyz='0 0 -0.1'/><geometry><capsule radius='0.02' length='0.16'/></geometry></collision></link>
  <joint name='${joint}' type='revolute'><parent link='${parent}'/><child link='${link}'/><origin xyz='${z}'/>
    <axis xyz='0 1 0'/><limit lower='-1' upper='1' effort='30' velocity='10'/></joint></xacro:macro>
  <xacro:part link='${name}_thigh' joint='${name}_hip' parent='base_link' z='${x} ${y} 0.1' axis='0 1 0'/>
  <xacro:part link='${name}_shank' joint='${name}_knee' parent='${name}_thigh' z='0 0 -0.2' axis='0 1 0'/>
</xacro:macro>
"""
FEET = "".join(
    f"<xacro:leg name='leg{k}' x='{x}' y='{y}'/>"
    for k, (x, y) in enumerate(((0.2, 0.15), (0.2, -0.15), (-0.2, 0.15), (-0.2, -0.15)))
)
BASES = {
    "differential": wheels(*PAIR) + CASTOR,
    "skid-steer": wheels(*FOUR),
    "mecanum": wheels(*((f"mecanum_{name}", *rest) for name, *rest in FOUR)),
    "omnidirectional": wheels(*STAR),
    "ackermann": "<xacro:steered name='front_left' x='0.2' y='0.2'/>"
    "<xacro:steered name='front_right' x='0.2' y='-0.2'/>" + wheels(*REAR),
    "tricycle": "<xacro:steered name='front' x='0.2' y='0'/>" + wheels(*REAR),
    "legged": LEG + FEET,
}


def base_file(kind):
    """Return the xacro text of a robot with a kind of base."""
    return f"{HEAD.format(name=kind.replace('-', '_'))}{BOX}{BASES[kind]}</robot>"
