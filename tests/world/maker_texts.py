"""Small robots in the styles of several makers: names, plugins, castors, axes, units and xacro differ."""

# ruff: noqa: E501
import math
import struct

import numpy as np

XACRO = "xmlns:xacro='http://www.ros.org/wiki/xacro'"


def inertial(mass, size=0.1, xyz="0 0 0"):
    moment = mass * size**2 / 6.0
    return (
        f"<inertial><origin xyz='{xyz}'/><mass value='{mass}'/>"
        f"<inertia ixx='{moment}' iyy='{moment}' izz='{moment}' ixy='0' ixz='0' iyz='0'/></inertial>"
    )


def link(name, mass, shape, origin="0 0 0", rpy="0 0 0", visual=True, collision=True):
    part = f"<origin xyz='{origin}' rpy='{rpy}'/><geometry>{shape}</geometry>"
    body = (f"<visual>{part}</visual>" if visual else "") + (f"<collision>{part}</collision>" if collision else "")
    return f"<link name='{name}'>{inertial(mass, 0.2, origin) if mass else ''}{body}</link>"


def joint(name, kind, parent, child, xyz, axis="0 0 1", rpy="0 0 0", more=""):
    return (
        f"<joint name='{name}' type='{kind}'><origin xyz='{xyz}' rpy='{rpy}'/><parent link='{parent}'/>"
        f"<child link='{child}'/><axis xyz='{axis}'/>{more}</joint>"
    )


def cylinder(radius, length=0.04):
    return f"<cylinder radius='{radius}' length='{length}'/>"


def box(x, y, z):
    return f"<box size='{x} {y} {z}'/>"


def wheel(name, parent, xyz, radius=0.08, axis="0 1 0", kind="continuous", shape="", more="", mass=0.5, **parts):
    """Return a wheel whose link is turned, as most makers do: the cylinder lies along y of the link."""
    body = link(f"{name}_link", mass, shape or cylinder(radius), rpy="1.5707963 0 0", **parts)
    return body + joint(f"{name}_joint", kind, parent, f"{name}_link", xyz, axis, more=more)


def plugin(filename, body, name="drive"):
    return f"<gazebo><plugin name='{name}' filename='{filename}'>{body}</plugin></gazebo>"


def control(*joints, interface="velocity"):
    rows = "".join(f"<joint name='{name}'><command_interface name='{interface}'/></joint>" for name in joints)
    return f"<ros2_control name='base' type='system'><hardware><plugin>x/Y</plugin></hardware>{rows}</ros2_control>"


def robot(name, *parts, head=""):
    return f"<?xml version='1.0'?><robot name='{name}' {head}>{''.join(parts)}</robot>"


FOOTPRINT = "<link name='base_footprint'/>"
ROUND = link("base_link", 6.0, cylinder(0.18, 0.1), "0 0 0.05")


def classic_diff():
    """Gazebo classic, base_footprint as root, wheels that turn about -y, a sphere as castor."""
    return robot(
        "vacuum", FOOTPRINT, joint("base_joint", "fixed", "base_footprint", "base_link", "0 0 0.04"), ROUND,
        wheel("wheel_left", "base_link", "0 0.15 0.01", 0.05, "0 -1 0"),
        wheel("wheel_right", "base_link", "0 -0.15 0.01", 0.05, "0 -1 0"),
        link("caster_front_link", 0.1, "<sphere radius='0.02'/>"),
        joint("caster_front", "fixed", "base_link", "caster_front_link", "0.12 0 -0.02"),
        link("caster_back_link", 0.1, "<sphere radius='0.02'/>"),
        joint("caster_back", "fixed", "base_link", "caster_back_link", "-0.12 0 -0.02"),
        "<gazebo reference='wheel_left_link'><mu1>200.0</mu1><mu2>100.0</mu2></gazebo>"
        "<gazebo reference='wheel_right_link'><mu1 value='200.0'/><mu2 value='100.0'/></gazebo>",
        plugin("libgazebo_ros_diff_drive.so", "<leftJoint>wheel_left_joint</leftJoint><rightJoint>wheel_right_joint"
               "</rightJoint><wheelSeparation>0.30</wheelSeparation><wheelDiameter>0.1</wheelDiameter>"),
    )  # fmt: skip


def swivel_castors():
    """gz-sim DiffDrive, castors as swivel and wheel, base_link on the axle and no footprint."""
    castors = "".join(
        link(f"{s}_fork", 0.2, box(0.02, 0.02, 0.03), "0 0 0.03") +
        joint(f"{s}_swivel", "continuous", "base_link", f"{s}_fork", f"-0.3 {y} -0.03", "0 0 1") +
        link(f"{s}_roll", 0.2, cylinder(0.05, 0.02), rpy="1.5707963 0 0") +
        joint(f"{s}_roll_joint", "continuous", f"{s}_fork", f"{s}_roll", "-0.03 0 -0.02", "0 1 0")
        for s, y in (("left", 0.12), ("right", -0.12))
    )  # fmt: skip
    return robot(
        "amr", link("base_link", 25.0, box(0.7, 0.4, 0.2), "-0.1 0 0.12"),
        wheel("drivewhl_l", "base_link", "0 0.22 0", 0.1, mass=1.5),
        wheel("drivewhl_r", "base_link", "0 -0.22 0", 0.1, mass=1.5),
        castors,
        plugin("gz-sim-diff-drive-system", "<left_joint>drivewhl_l_joint</left_joint><right_joint>drivewhl_r_joint"
               "</right_joint><wheel_separation>0.44</wheel_separation><wheel_radius>0.1</wheel_radius>"
               "<max_linear_velocity>1.2</max_linear_velocity>", "gz::sim::systems::DiffDrive"),
    )  # fmt: skip


def german_skid():
    """ros2_control, German names, revolute wheels with huge limits, wheels on a chain of fixed joints."""
    places = {"vorne_links": (0.2, 0.2), "vorne_rechts": (0.2, -0.2), "hinten_links": (-0.2, 0.2),
              "hinten_rechts": (-0.2, -0.2)}  # fmt: skip
    limit = "<limit lower='-1e16' upper='1e16' effort='20' velocity='15'/>"
    wheels = "".join(
        link(f"traeger_{name}", 0.3, box(0.03, 0.03, 0.03)) +
        joint(f"halter_{name}", "fixed", "fahrgestell", f"traeger_{name}", f"{x} {0.8 * y} -0.02") +
        wheel(f"rad_{name}", f"traeger_{name}", f"0 {0.2 * y} 0", 0.1, kind="revolute", more=limit)
        for name, (x, y) in places.items()
    )  # fmt: skip
    names = [f"rad_{name}_joint" for name in places]
    body = link("fahrgestell", 20.0, box(0.5, 0.28, 0.14), "0 0 0.06")
    return robot("gelaende", "<link name='basis'/>", body,
                 joint("basis_joint", "fixed", "basis", "fahrgestell", "0 0 0.12"), wheels, control(*names))  # fmt: skip


def six_wheels():
    """A rover with three axles, axes of the right wheels negative."""
    rows = "".join(
        wheel(f"{a}_{s}", "chassis", f"{x} {y} 0", 0.12, f"0 {1 if y > 0 else -1} 0")
        for a, x in (("front", 0.3), ("middle", 0.0), ("rear", -0.3)) for s, y in (("l", 0.25), ("r", -0.25))
    )  # fmt: skip
    return robot("rover", link("chassis", 30.0, box(0.8, 0.4, 0.15), "0 0 0.1"), rows)


def mecanum():
    """gz-sim MecanumDrive, no word mecanum in the names of links."""
    rows = "".join(
        wheel(f"{a}{s}", "base_link", f"{x} {y} 0", 0.076)
        for a, x in (("f", 0.18), ("r", -0.18)) for s, y in (("l", 0.2), ("r", -0.2))
    )  # fmt: skip
    return robot("lift", link("base_link", 15.0, box(0.5, 0.34, 0.12), "0 0 0.06"), rows,
                 plugin("gz-sim-mecanum-drive-system", "<wheel_radius>0.076</wheel_radius>"))  # fmt: skip


def omni_star(count):
    """Omnidirectional wheels on a circle, each turned with rpy, axes along z of the joint."""
    rows = ""
    for k in range(count):
        angle = 2.0 * math.pi * k / count + math.pi / count
        x, y = 0.16 * math.cos(angle), 0.16 * math.sin(angle)
        rows += link(f"w{k}", 0.3, cylinder(0.05, 0.025))
        rows += joint(f"w{k}_axle", "continuous", "plate", f"w{k}", f"{x} {y} 0", "0 0 1",
                      f"1.5707963267948966 0 {angle + math.pi / 2.0}")  # fmt: skip
    return robot(f"kiwi{count}", link("plate", 5.0, cylinder(0.15, 0.06), "0 0 0.06"), rows)


def ackermann():
    """A car: knuckles, the right one mimics the left, gz-sim AckermannSteering, rear wheels driven."""
    limit = "<limit lower='-0.6' upper='0.6' effort='10' velocity='2'/>"
    front = ""
    for side, y, more in (("left", 0.15, ""), ("right", -0.15, "<mimic joint='left_knuckle_joint'/>")):
        front += link(f"{side}_knuckle", 0.1, box(0.02, 0.02, 0.02))
        front += joint(f"{side}_knuckle_joint", "revolute", "base_link", f"{side}_knuckle", f"0.32 {y} 0", "0 0 1",
                       more=limit + more)  # fmt: skip
        front += wheel(f"{side}_front", f"{side}_knuckle", f"0 {math.copysign(0.02, y)} 0", 0.06)
    rear = wheel("left_rear", "base_link", "0 0.17 0", 0.06) + wheel("right_rear", "base_link", "0 -0.17 0", 0.06)
    return robot("racer", link("base_link", 4.0, box(0.45, 0.2, 0.08), "0.16 0 0.06"), front, rear,
                 plugin("gz-sim-ackermann-steering-system", "<wheel_base>0.32</wheel_base><kingpin_width>0.3"
                        "</kingpin_width><steering_limit>0.5</steering_limit>"))  # fmt: skip


def tricycle():
    """A forklift: the steering joint is continuous, with transmissions of ROS 1."""
    motor = "".join(
        f"<transmission name='t_{name}'><type>transmission_interface/SimpleTransmission</type><joint name='{name}'>"
        f"<hardwareInterface>hardware_interface/{kind}JointInterface</hardwareInterface></joint></transmission>"
        for name, kind in (("steer_joint", "Position"), ("drive_joint", "Velocity"))
    )
    return robot(
        "forklift", link("base_link", 80.0, box(1.0, 0.5, 0.3), "0.4 0 0.2"),
        link("steer", 1.0, box(0.05, 0.05, 0.05), "0 0 0.05"),
        joint("steer_joint", "continuous", "base_link", "steer", "0.9 0 0"),
        wheel("drive", "steer", "0 0 0", 0.1, mass=3.0),
        wheel("load_l", "base_link", "0 0.25 0", 0.1), wheel("load_r", "base_link", "0 -0.25 0", 0.1), motor,
    )  # fmt: skip


def quadruped():
    """Twelve joints, hips about x, feet as spheres on fixed joints; a mark above the trunk."""
    limit = "<limit lower='-2' upper='2' effort='40' velocity='20'/>"
    legs = ""
    for a, x in (("F", 0.2), ("R", -0.2)):
        for s, y in (("L", 0.08), ("R", -0.08)):
            name, out = f"{a}{s}", math.copysign(0.08, y)
            legs += link(f"{name}_hip", 0.5, cylinder(0.04)) + link(f"{name}_thigh", 1.0, box(0.03, 0.03, 0.2),
                                                                    "0 0 -0.1")  # fmt: skip
            legs += link(f"{name}_calf", 0.2, box(0.02, 0.02, 0.2), "0 0 -0.1")
            legs += link(f"{name}_foot", 0.05, "<sphere radius='0.02'/>")
            legs += joint(f"{name}_hip_joint", "revolute", "trunk", f"{name}_hip", f"{x} {y} 0", "1 0 0", more=limit)
            legs += joint(f"{name}_thigh_joint", "revolute", f"{name}_hip", f"{name}_thigh", f"0 {out} 0", "0 1 0",
                          more=limit)  # fmt: skip
            legs += joint(f"{name}_calf_joint", "revolute", f"{name}_thigh", f"{name}_calf", "0 0 -0.2", "0 1 0",
                          more=limit)  # fmt: skip
            legs += joint(f"{name}_foot_fixed", "fixed", f"{name}_calf", f"{name}_foot", "0 0 -0.2")
    mark = "<link name='base'><visual><geometry><box size='0.001 0.001 0.001'/></geometry></visual></link>"
    return robot("dog", mark, joint("floating_base", "fixed", "base", "trunk", "0 0 0"),
                 link("trunk", 8.0, box(0.5, 0.2, 0.1)), legs)  # fmt: skip


def sphere_wheels():
    """Wheels with a sphere as collider and a cylinder to look at, castor without a link of its own."""
    rows = ""
    for s, y in (("left", 0.12), ("right", -0.12)):
        rows += (
            f"<link name='{s}'>{inertial(0.2)}<visual><origin rpy='1.5707963 0 0'/><geometry>{cylinder(0.035, 0.02)}"
            f"</geometry></visual><collision><geometry><sphere radius='0.035'/></geometry></collision></link>"
        )
        rows += joint(f"{s}_wheel_joint", "continuous", "base_link", s, f"0.03 {y} 0", "0 1 0")
    body = (
        f"<link name='base_link'>{inertial(1.5, 0.15, '0 0 0.02')}"
        f"<collision><origin xyz='0 0 0.03'/><geometry>{box(0.2, 0.2, 0.05)}</geometry></collision>"
        "<collision name='castor'><origin xyz='-0.07 0 -0.025'/><geometry><sphere radius='0.01'/></geometry></collision>"
        "</link>"
    )
    return robot("small", body, rows)


def balancing():
    """Two wheels and nothing else on the ground."""
    return robot("balance", link("base_link", 10.0, box(0.15, 0.3, 0.5), "0 0 0.15"),
                 wheel("l", "base_link", "0 0.2 0", 0.15), wheel("r", "base_link", "0 -0.2 0", 0.15))  # fmt: skip


def mesh_wheels():
    """Meshes in millimetres only, in the folder of a package."""
    rows = ""
    for s, y in (("left", 0.15), ("right", -0.15)):
        shape = "<mesh filename='package://courier/meshes/wheel.stl' scale='0.001 0.001 0.001'/>"
        rows += wheel(s, "base_link", f"0 {y} 0.06", 0.06, shape=shape)
    ball = link("ball", 0.1, "<sphere radius='0.03'/>") + joint("ball_j", "fixed", "base_link", "ball", "-0.15 0 0.03")
    return robot("courier", FOOTPRINT, joint("b", "fixed", "base_footprint", "base_link", "0 0 0"),
                 link("base_link", 8.0, box(0.4, 0.25, 0.1), "-0.05 0 0.11"), rows, ball)  # fmt: skip


def conditional_xacro():
    """Arguments with defaults, property blocks, conditions, a macro with blocks, $(find) of its own package."""
    return robot(
        "shop",
        "<xacro:arg name='wheels' default='two'/><xacro:arg name='prefix' default=''/>"
        "<xacro:property name='r' value='0.07'/><xacro:property name='tf' value='$(arg prefix)'/>"
        "<xacro:property name='pose_left'><origin xyz='0 0.17 0' rpy='0 0 0'/></xacro:property>"
        "<xacro:property name='pose_right'><origin xyz='0 -0.17 0' rpy='0 0 0'/></xacro:property>"
        "<xacro:include filename='$(find courier)/urdf/round.xacro'/>"
        f"<link name='${{tf}}base_link'>{inertial(7.0, 0.3, '-0.05 0 0.08')}<collision><origin xyz='-0.05 0 0.08'/>"
        f"<geometry>{box(0.3, 0.3, 0.1)}</geometry></collision></link>"
        "<xacro:round side='left'><xacro:insert_block name='pose_left'/></xacro:round>"
        "<xacro:round side='right'><xacro:insert_block name='pose_right'/></xacro:round>"
        "<xacro:if value=\"${'$(arg wheels)' == 'two'}\"><link name='${tf}slider'>" + inertial(0.1) +
        "<collision><geometry><sphere radius='0.02'/></geometry></collision></link>"
        "<joint name='${tf}slider_joint' type='fixed'><parent link='${tf}base_link'/><child link='${tf}slider'/>"
        "<origin xyz='-0.15 0 ${0.02 - r}'/></joint></xacro:if>",
        head=XACRO,
    )  # fmt: skip


ROUND_XACRO = f"""<robot {XACRO}>
<xacro:macro name="round" params="side *origin parent:=base_link mass:=0.4 ">
  <link name="${{tf}}${{side}}_wheel"><inertial><mass value="${{mass}}"/><inertia ixx="${{mass*(3*r**2+0.03**2)/12}}"
    iyy="${{mass*r*r/2}}" izz="${{mass*(3*r**2+0.03**2)/12}}" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin rpy="${{pi/2}} 0 0"/><geometry><cylinder radius="${{r}}" length="0.03"/></geometry></collision>
  </link>
  <joint name="${{tf}}${{side}}_wheel_joint" type="continuous"><parent link="${{tf}}${{parent}}"/>
    <child link="${{tf}}${{side}}_wheel"/><xacro:insert_block name="origin"/><axis xyz="0 1 0"/></joint>
</xacro:macro></robot>"""


def sdf_diff():
    """SDF of gz-sim: poses of links in the model, wheels turned by roll, a castor on a ball joint."""

    def one(name, mass, pose, shape):
        moment = mass * 0.005
        return (
            f"<link name='{name}'><pose>{pose}</pose><inertial><mass>{mass}</mass><inertia><ixx>{moment}</ixx><iyy>"
            f"{moment}</iyy><izz>{moment}</izz></inertia></inertial><collision name='c'><geometry>{shape}</geometry>"
            f"</collision><visual name='v'><geometry>{shape}</geometry></visual></link>"
        )

    disc = "<cylinder><radius>0.1</radius><length>0.04</length></cylinder>"
    axle = "".join(
        f"<joint name='{s}_wheel_joint' type='revolute'><parent>chassis</parent><child>{s}_wheel</child><axis>"
        "<xyz expressed_in='__model__'>0 1 0</xyz><limit><lower>-1.79769e+308</lower><upper>1.79769e+308</upper>"
        "</limit></axis></joint>" for s in ("left", "right")
    )  # fmt: skip
    return (
        "<?xml version='1.0'?><sdf version='1.8'><model name='vehicle_blue'>"
        + one("chassis", 12.0, "-0.1 0 0.16 0 0 0", "<box><size>0.5 0.3 0.12</size></box>")
        + one("left_wheel", 1.0, "0 0.19 0.1 -1.5707963 0 0", disc)
        + one("right_wheel", 1.0, "0 -0.19 0.1 -1.5707963 0 0", disc)
        + one("caster", 0.3, "-0.28 0 0.05 0 0 0", "<sphere><radius>0.05</radius></sphere>")
        + axle
        + "<joint name='caster_joint' type='ball'><parent>chassis</parent><child>caster</child></joint>"
        "<plugin filename='gz-sim-diff-drive-system' name='gz::sim::systems::DiffDrive'><left_joint>left_wheel_joint"
        "</left_joint><right_joint>right_wheel_joint</right_joint><wheel_separation>0.38</wheel_separation>"
        "<wheel_radius>0.1</wheel_radius></plugin></model></sdf>"
    )


def manipulator():
    """A mobile manipulator: lift, arm, gripper with mimic joints; sensors on fixed chains."""
    limit = "<limit lower='-2' upper='2' effort='50' velocity='1'/>"
    return robot(
        "butler", link("base_link", 40.0, cylinder(0.27, 0.2), "0 0 0.2"),
        wheel("wheel_left", "base_link", "0 0.2 0.0985", 0.0985), wheel("wheel_right", "base_link", "0 -0.2 0.0985", 0.0985),
        *(link(f"caster_{k}", 0.1, "<sphere radius='0.03'/>") + joint(f"caster_{k}_joint", "fixed", "base_link",
          f"caster_{k}", f"{x} {y} 0.03") for k, (x, y) in enumerate(((0.18, 0.1), (0.18, -0.1), (-0.18, 0.1), (-0.18, -0.1)))),
        link("torso", 10.0, box(0.2, 0.2, 0.6), "0 0 0.3"),
        joint("torso_lift", "prismatic", "base_link", "torso", "0 0 0.3", "0 0 1",
              more="<limit lower='0' upper='0.3' effort='500' velocity='0.1'/>"),
        link("arm_1", 2.0, box(0.3, 0.08, 0.08), "0.15 0 0"),
        joint("arm_1_joint", "revolute", "torso", "arm_1", "0.1 0 0.5", "0 1 0", more=limit),
        link("finger_l", 0.1, box(0.08, 0.01, 0.02), "0.04 0 0"), link("finger_r", 0.1, box(0.08, 0.01, 0.02), "0.04 0 0"),
        joint("finger_l_joint", "prismatic", "arm_1", "finger_l", "0.3 0.02 0", "0 1 0",
              more="<limit lower='0' upper='0.03' effort='5' velocity='1'/>"),
        joint("finger_r_joint", "prismatic", "arm_1", "finger_r", "0.3 -0.02 0", "0 -1 0",
              more="<limit lower='0' upper='0.03' effort='5' velocity='1'/><mimic joint='finger_l_joint'/>"),
        "<link name='laser_mount'/>", joint("lm", "fixed", "base_link", "laser_mount", "0.2 0 0.2"),
        "<link name='laser'/>", joint("lj", "fixed", "laser_mount", "laser", "0 0 0.05"),
    )  # fmt: skip


def swerve():
    """Four wheels that all steer."""
    rows = ""
    for name, x, y in (("fl", 0.3, 0.25), ("fr", 0.3, -0.25), ("rl", -0.3, 0.25), ("rr", -0.3, -0.25)):
        rows += link(f"{name}_pod", 0.5, box(0.05, 0.05, 0.05), "0 0 0.1")
        rows += joint(f"{name}_pod_joint", "continuous", "base_link", f"{name}_pod", f"{x} {y} 0", "0 0 1")
        rows += wheel(f"{name}_wheel", f"{name}_pod", "0 0 0", 0.08)
    names = [f"{n}_pod_joint" for n in ("fl", "fr", "rl", "rr")]
    return robot("swerve", link("base_link", 40.0, box(0.8, 0.6, 0.15), "0 0 0.15"), rows,
                 control(*names, interface="position"))  # fmt: skip


def tracked():
    """A crawler: four axles on each side, all wheels are meshes, the first axle is nearer to the second."""
    rows = ""
    for k, x in enumerate((0.3, 0.1, -0.1, -0.3)):
        for s, y in (("left", 0.2), ("right", -0.2)):
            shape = "<mesh filename='package://courier/meshes/wheel.stl' scale='0.001 0.001 0.001'/>"
            rows += wheel(f"track_{s}_{k}", "hull", f"{x} {y} 0", 0.06, shape=shape, mass=0.4)
    return robot("crawler", link("hull", 18.0, box(0.7, 0.3, 0.1), "0.03 0 0.05"), rows)


def sprung():
    """Driven wheels on sprung slides, four castors at the corners of a heavy box, as robots in warehouses."""
    slide = "<limit lower='-0.02' upper='0.02' effort='400' velocity='1'/><dynamics damping='200'/>"
    rows = ""
    for s, y in (("left", 0.25), ("right", -0.25)):
        rows += link(f"{s}_arm", 0.5, box(0.1, 0.04, 0.04), "0 0 0.1")
        rows += joint(f"{s}_spring", "prismatic", "base_link", f"{s}_arm", f"0 {0.9 * y} 0", more=slide)
        rows += wheel(f"{s}_wheel", f"{s}_arm", f"0 {0.1 * y} 0", 0.08, mass=2.0)
    for k, (x, y) in enumerate(((0.3, 0.2), (0.3, -0.2), (-0.3, 0.2), (-0.3, -0.2))):
        rows += link(f"caster_{k}", 0.3, "<sphere radius='0.03'/>")
        rows += joint(f"caster_{k}_joint", "fixed", "base_link", f"caster_{k}", f"{x} {y} -0.05")
    return robot("carrier", link("base_link", 60.0, box(0.8, 0.5, 0.2), "0 0 0.1"), rows)


def rear_steering():
    """A forklift that steers and drives at its rear."""
    return robot(
        "truck", link("base_link", 90.0, box(1.2, 0.6, 0.3), "-0.5 0 0.25"),
        link("pivot", 1.0, box(0.05, 0.05, 0.05), "0 0 0.15"),
        joint("pivot_joint", "revolute", "base_link", "pivot", "-1.0 0 0",
              more="<limit lower='-1.3' upper='1.3' effort='200' velocity='2'/>"),
        wheel("drive", "pivot", "0 0 0", 0.1, mass=3.0),
        wheel("fork_l", "base_link", "0 0.3 0", 0.1), wheel("fork_r", "base_link", "0 -0.3 0", 0.1),
        control("pivot_joint", interface="position"),
    )  # fmt: skip


def write_stl(path, radius=60.0, length=30.0, sides=24):
    """Write a disc along z in millimetres as binary STL."""
    ring = [(radius * math.cos(a), radius * math.sin(a)) for a in np.linspace(0, 2 * math.pi, sides, endpoint=False)]
    rows = []
    for (ax, ay), (bx, by) in zip(ring, ring[1:] + ring[:1], strict=True):
        for z in (-length / 2, length / 2):
            rows.append(((0, 0, z), (ax, ay, z), (bx, by, z)) if z > 0 else ((0, 0, z), (bx, by, z), (ax, ay, z)))
        low, high = -length / 2, length / 2
        rows += [((ax, ay, low), (bx, by, low), (bx, by, high)), ((ax, ay, low), (bx, by, high), (ax, ay, high))]
    data = b"\0" * 80 + struct.pack("<I", len(rows))
    data += b"".join(struct.pack("<12fH", 0, 0, 0, *(value for point in row for value in point), 0) for row in rows)
    path.write_bytes(data)


MAKERS = {
    "classic_diff": (classic_diff, "differential", 7.2),
    "swivel_castors": (swivel_castors, "differential", 28.8),
    "german_skid": (german_skid, "skid-steer", 23.2),
    "six_wheels": (six_wheels, "skid-steer", 33.0),
    "mecanum": (mecanum, "mecanum", 17.0),
    "kiwi3": (lambda: omni_star(3), "omnidirectional", 5.9),
    "kiwi4": (lambda: omni_star(4), "omnidirectional", 6.2),
    "ackermann": (ackermann, "ackermann", 6.2),
    "tricycle": (tricycle, "tricycle", 85.0),
    "quadruped": (quadruped, "legged", 15.0),
    "sphere_wheels": (sphere_wheels, "differential", 1.9),
    "balancing": (balancing, "differential", 11.0),
    "mesh_wheels": (mesh_wheels, "differential", 9.1),
    "conditional_xacro": (conditional_xacro, "differential", 7.9),
    "sdf_diff": (sdf_diff, "differential", 14.3),
    "manipulator": (manipulator, "differential", 53.6),
    "swerve": (swerve, "omnidirectional", 44.0),
    "tracked": (tracked, "skid-steer", 21.2),
    "sprung": (sprung, "differential", 66.2),
    "rear_steering": (rear_steering, "tricycle", 95.0),
}
"""Text, kind of base and mass [kg] of each robot."""


def write_maker(folder, name):
    """Write the package of a robot and return its file."""
    home = folder / "courier"
    for part in ("urdf", "meshes"):
        (home / part).mkdir(parents=True, exist_ok=True)
    (home / "package.xml").write_text("<package format='2'><name>courier</name></package>")
    (home / "urdf" / "round.xacro").write_text(ROUND_XACRO)
    write_stl(home / "meshes" / "wheel.stl")
    ending = {"sdf_diff": "sdf", "conditional_xacro": "urdf.xacro"}.get(name, "urdf")
    file = home / "urdf" / f"{name}.{ending}"
    file.write_text(MAKERS[name][0]())
    return file
