"""Small robots with the quirks of vendors' packages: swivel castors, rockers, missing meshes, tiny inertias."""

# ruff: noqa: E501
from maker_texts import XACRO, box, inertial, joint, link, plugin, robot, wheel

TINY = "<inertial><mass value='1e-6'/><inertia ixx='1e-6' ixy='0' ixz='0' iyy='1e-6' iyz='0' izz='1e-6'/></inertial>"
LOST = "<mesh filename='package://vendor_description/meshes/lost.stl'/>"

HOSPITAL = f"""<?xml version="1.0"?>
<robot name="hospital" {XACRO}>
<xacro:arg name="prefix" default=""/>
<xacro:property name="prefix" value="$(arg prefix)"/>
<xacro:property name="wheel_r" value="${{0.125 / 2}}"/>
<xacro:property name="castor_r" value="${{wheel_r - 0.0125}}"/>
<xacro:macro name="box_inertia" params="m x y z"><inertial><mass value="${{m}}"/>
  <inertia ixx="${{m * (y ** 2 + z ** 2) / 12}}" ixy="0" ixz="0" iyy="${{m * (x ** 2 + z ** 2) / 12}}" iyz="0"
    izz="${{m * (x ** 2 + y ** 2) / 12}}"/></inertial></xacro:macro>
<xacro:macro name="drive_wheel" params="side reflect">
  <link name="${{prefix}}${{side}}_wheel_link"><xacro:box_inertia m="1.0" x="0.1" y="0.03" z="0.1"/>
    <visual><origin rpy="${{radians(90)}} 0 0"/><geometry><cylinder radius="${{wheel_r}}" length="0.03"/></geometry></visual>
    <collision><origin rpy="${{radians(90)}} 0 0"/><geometry><cylinder radius="${{wheel_r}}" length="0.03"/></geometry></collision>
  </link>
  <joint name="${{prefix}}${{side}}_wheel_joint" type="continuous"><parent link="${{prefix}}base_link"/>
    <child link="${{prefix}}${{side}}_wheel_link"/><axis xyz="0 1 0"/><origin xyz="0.0 ${{0.222604 * reflect}} ${{wheel_r}}"/>
    <limit effort="100" velocity="${{1.5 / wheel_r}}"/></joint>
  <transmission name="${{side}}_tr"><type>transmission_interface/SimpleTransmission</type>
    <joint name="${{prefix}}${{side}}_wheel_joint"><hardwareInterface>hardware_interface/VelocityJointInterface</hardwareInterface></joint>
    <actuator name="${{side}}_motor"><mechanicalReduction>1</mechanicalReduction></actuator></transmission>
  <gazebo reference="${{prefix}}${{side}}_wheel_link"><mu1 value="200.0"/><mu2 value="100.0"/><minDepth>0.01</minDepth></gazebo>
</xacro:macro>
<xacro:macro name="castor" params="name x y">
  <link name="${{prefix}}${{name}}_rotation_link"><xacro:box_inertia m="0.3" x="0.05" y="0.05" z="0.05"/></link>
  <joint name="${{prefix}}${{name}}_rotation_joint" type="continuous"><parent link="${{prefix}}base_link"/>
    <child link="${{prefix}}${{name}}_rotation_link"/><axis xyz="0 0 1"/><origin xyz="${{x}} ${{y}} 0.16"/>
    <dynamics damping="0.01" friction="0.0"/></joint>
  <link name="${{prefix}}${{name}}_wheel_link"><xacro:box_inertia m="0.3" x="0.1" y="0.03" z="0.1"/>
    <visual><origin rpy="${{pi / 2}} 0 0"/><geometry><cylinder radius="${{castor_r}}" length="0.03"/></geometry></visual>
    <collision><origin rpy="${{pi / 2}} 0 0"/><geometry><cylinder radius="${{castor_r}}" length="0.03"/></geometry></collision>
  </link>
  <joint name="${{prefix}}${{name}}_wheel_joint" type="continuous"><parent link="${{prefix}}${{name}}_rotation_link"/>
    <child link="${{prefix}}${{name}}_wheel_link"/><axis xyz="0 1 0"/><origin xyz="-0.0382 0 ${{castor_r - 0.16}}"/></joint>
</xacro:macro>
<link name="${{prefix}}base_footprint"/>
<joint name="${{prefix}}base_joint" type="fixed"><parent link="${{prefix}}base_footprint"/><child link="${{prefix}}base_link"/></joint>
<link name="${{prefix}}base_link"><xacro:box_inertia m="77" x="0.9" y="0.58" z="0.3"/>
  <visual><geometry>{LOST}</geometry></visual>
  <collision><origin xyz="-0.03 0 0.25"/><geometry><box size="0.9 0.58 0.2"/></geometry></collision></link>
<link name="${{prefix}}surface"/>
<joint name="${{prefix}}base_to_surface" type="fixed"><parent link="${{prefix}}base_link"/><child link="${{prefix}}surface"/>
  <origin xyz="0 0 0.352"/></joint>
<xacro:drive_wheel side="left" reflect="1"/>
<xacro:drive_wheel side="right" reflect="-1"/>
<xacro:castor name="fl_castor" x="0.341" y="0.203"/><xacro:castor name="fr_castor" x="0.341" y="-0.203"/>
<xacro:castor name="bl_castor" x="-0.270" y="0.203"/><xacro:castor name="br_castor" x="-0.270" y="-0.203"/>
<gazebo><plugin name="gazebo_ros_control" filename="libgazebo_ros_control.so"><controlPeriod>0.001</controlPeriod></plugin></gazebo>
</robot>"""
"""A vehicle for hospitals and halls: two driven wheels in the middle and four swivel castors at the corners."""


def delivery():
    """A skid-steer platform: wheels without colliders, their meshes are missing, the plugin of Gazebo has four joints."""
    rows = "".join(
        wheel(f"{a}_{s}_wheel", "base_link", f"{x} {y} -0.1", shape=LOST, collision=False, mass=3.0,
              axis=f"0 {1 if s == 'left' else -1} 0")
        for a, x in (("front", 0.249), ("rear", -0.249)) for s, y in (("left", 0.29), ("right", -0.29))
    )  # fmt: skip
    joints = "".join(
        f"<{s}{a}Joint>{a.lower()}_{s}_wheel_joint</{s}{a}Joint>" for a in ("Front", "Rear") for s in ("left", "right")
    )
    body = link("base_link", 40.0, box(0.6, 0.42, 0.2))
    return robot("delivery", body, "<link name='inertial_link'/>", joint("inertial_joint", "fixed", "base_link", "inertial_link", "0 0 0"),
                 rows, plugin("libgazebo_ros_skid_steer_drive.so", f"{joints}<wheelSeparation>0.58</wheelSeparation><wheelDiameter>0.33"
                              "</wheelDiameter><torque>1000</torque>", "skid_steer_drive_controller"))  # fmt: skip


def shuttle():
    """A car: virtual centre of steering, knuckles of a millionth of a kilogram, a plugin of Gazebo with all its joints."""
    limit = "<limit lower='-0.461' upper='0.461' effort='30' velocity='5'/>"
    rows = f"<link name='steering_hinge'>{TINY}</link>" + joint(
        "steering_joint", "revolute", "base_link", "steering_hinge", "0.65 0 0", more=limit
    )
    for s, y in (("left", 0.3), ("right", -0.3)):
        rows += f"<link name='front_{s}_knuckle'>{TINY}</link>"
        rows += joint(
            f"front_{s}_steering_joint", "revolute", "base_link", f"front_{s}_knuckle", f"0.65 {y} 0", more=limit
        )
        rows += wheel(f"front_{s}_wheel", f"front_{s}_knuckle", "0 0 0", 0.165, mass=4.0)
        rows += wheel(f"rear_{s}_wheel", "base_link", f"0 {y} 0", 0.165, mass=4.0)
    body = "<max_speed>1.5</max_speed><max_steer>0.4</max_steer><front_left_joint>front_left_wheel_joint</front_left_joint>"
    return robot("shuttle", "<link name='base_footprint'/>", joint("base_footprint_joint", "fixed", "base_footprint", "base_link", "0 0 0.165"),
                 link("base_link", 60.0, box(0.9, 0.45, 0.2), "0.3 0 0.12"), rows, plugin("libgazebo_ros_ackermann_drive.so", body))  # fmt: skip


def rocker():
    """An indoor base on mecanum wheels: the front axle rocks about x, a force-based plugin moves it, nothing says mecanum."""
    limit = "<limit lower='-0.08726' upper='0.08726' effort='1000' velocity='10'/>"
    rows = (
        f"<link name='front_rocker_link'>{inertial(10.2)}</link><link name='rear_rocker_link'>{inertial(10.2)}</link>"
    )
    rows += joint("front_rocker", "revolute", "base_link", "front_rocker_link", "0.319 0 0.1", "1 0 0", more=limit)
    rows += joint("rear_rocker", "fixed", "base_link", "rear_rocker_link", "-0.319 0 0.1")
    for a in ("front", "rear"):
        for s, y in (("left", 0.2755), ("right", -0.2755)):
            rows += wheel(f"{a}_{s}_wheel", f"{a}_rocker_link", f"0 {y} -0.024", 0.0759, mass=2.3)
    return robot("rocker", "<link name='base_link'/>", link("chassis_link", 80.0, box(0.9, 0.6, 0.2), "0 0 0.2"),
                 joint("base_chassis", "fixed", "base_link", "chassis_link", "0 0 0"), rows,
                 plugin("libindoor_ros_force_based_move.so", "<robotBaseFrame>base_link</robotBaseFrame>", "force_based_move"))  # fmt: skip


VENDORS = {
    "hospital": (lambda: HOSPITAL, "differential", 81.4),
    "delivery": (delivery, "skid-steer", 52.0),
    "shuttle": (shuttle, "ackermann", 76.000003),
    "rocker": (rocker, "omnidirectional", 109.6),
}
"""Text, kind of base and mass [kg] of each robot."""


def write_vendor(folder, name):
    """Write the file of a robot, and return its path."""
    file = folder / f"{name}.urdf{'.xacro' if name == 'hospital' else ''}"
    file.write_text(VENDORS[name][0]())
    return file
