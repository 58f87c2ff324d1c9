"""Nav2 for a robot of the simulation, started with ``crowdbot run hall.xml --bridge ros2``.

    ros2 launch examples/navigation_launch/nav2/nav2.launch.py
    ros2 launch examples/navigation_launch/nav2/nav2.launch.py parameters:=nav2_humble.yaml amcl:=true rviz:=false

The simulation sends the map, the clock and the frames from ``map`` to the sensors, so there is no map server and no
localisation. All nodes are in the name space of the robot: its goals on ``/robot/goal_pose`` reach Nav2 and the
simulation alike.
"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterFile

FOLDER = str(Path(__file__).parent)
SERVERS = {
    "controller_server": ("nav2_controller", [("cmd_vel", "cmd_vel_nav")]),
    "planner_server": ("nav2_planner", []),
    "smoother_server": ("nav2_smoother", []),
    "behavior_server": ("nav2_behaviors", [("cmd_vel", "cmd_vel_nav")]),
    "bt_navigator": ("nav2_bt_navigator", []),
    "velocity_smoother": ("nav2_velocity_smoother", [("cmd_vel", "cmd_vel_nav"), ("cmd_vel_smoothed", "cmd_vel")]),
}
"""Package and remapped topics of each node; its executable has its name."""


def server(name, package, remappings, parameters, **more):
    """Return the action that starts a node of Nav2 in the name space of the robot."""
    return Node(
        package=package,
        executable=name,
        name=name,
        namespace=LaunchConfiguration("robot"),
        output="screen",
        parameters=[parameters],
        remappings=remappings,
        **more,
    )


def manager(name, nodes, **more):
    """Return the action that starts the node which configures and activates others."""
    return Node(
        package="nav2_lifecycle_manager",
        executable="lifecycle_manager",
        name=name,
        namespace=LaunchConfiguration("robot"),
        output="screen",
        parameters=[{"use_sim_time": True, "autostart": True, "node_names": nodes}],
        **more,
    )


def generate_launch_description():
    """Return what ``ros2 launch`` starts."""
    chosen = PathJoinSubstitution([FOLDER, LaunchConfiguration("parameters")])
    parameters = ParameterFile(chosen, allow_substs=True)
    with_amcl = {"condition": IfCondition(LaunchConfiguration("amcl"))}
    viewer = Node(
        package="rviz2",
        executable="rviz2",
        arguments=["-d", str(Path(FOLDER, "crowd.rviz"))],
        parameters=[{"use_sim_time": True}],
        condition=IfCondition(LaunchConfiguration("rviz")),
    )
    return LaunchDescription(
        [
            DeclareLaunchArgument("robot", default_value="robot", description="name of the robot in the trial"),
            DeclareLaunchArgument("parameters", default_value="nav2_jazzy.yaml", description="file in this folder"),
            DeclareLaunchArgument("amcl", default_value="false", description="also estimate the pose, for comparison"),
            DeclareLaunchArgument("rviz", default_value="true", description="start RViz"),
            *(server(name, *one, parameters) for name, one in SERVERS.items()),
            manager("lifecycle_manager_navigation", list(SERVERS)),
            server("amcl", "nav2_amcl", [], parameters, **with_amcl),
            manager("lifecycle_manager_localization", ["amcl"], **with_amcl),
            viewer,
        ]
    )
