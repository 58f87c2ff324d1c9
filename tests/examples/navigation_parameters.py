"""Names of the parameters of Nav2 and move_base, as their own sources spell them."""

NAV2_SOURCES = (
    "github.com/ros-navigation/navigation2, nav2_bringup/params/nav2_params.yaml,"
    " commits 00d26e079f333b791c9f3f33b4a4310e62bff0e5 (Humble) and 12936559e452d7785bdba7e448f69dbbb3e448e7 (Jazzy)",
    "the same file and the calls that declare parameters in version 1.5.1, a6354f3f39d12c6e5c3e323f8021c831752edb23"
    " (Lyrical)",
    "docs.nav2.org/configuration/packages: AMCL, costmap-plugins/static and obstacle",
    "docs.nav2.org/migration/Iron.html: enable_stamped_cmd_vel",
)
MOVE_BASE_SOURCES = (
    "github.com/ros-planning/navigation: move_base/cfg/MoveBase.cfg, dwa_local_planner/cfg/DWAPlanner.cfg,"
    " base_local_planner/src/local_planner_limits/__init__.py, costmap_2d/cfg, costmap_2d/plugins, amcl/cfg/AMCL.cfg",
    "wiki.ros.org/costmap_2d, wiki.ros.org/navfn and wiki.ros.org/amcl",
)

SERVER = {"use_sim_time"}
COSTMAP = {
    "update_frequency", "publish_frequency", "global_frame", "robot_base_frame", "rolling_window", "width", "height",
    "resolution", "robot_radius", "plugins", "always_send_full_costmap", "track_unknown_space",
    *(f"inflation_layer.{name}" for name in ("plugin", "cost_scaling_factor", "inflation_radius")),
    *(f"static_layer.{name}" for name in ("plugin", "map_subscribe_transient_local", "map_topic")),
    *(f"obstacle_layer.{name}" for name in ("plugin", "enabled", "observation_sources")),
    *(
        f"obstacle_layer.scan.{name}"
        for name in (
            "topic", "max_obstacle_height", "clearing", "marking", "data_type", "raytrace_max_range",
            "raytrace_min_range", "obstacle_max_range", "obstacle_min_range", "inf_is_valid",
        )
    ),
}  # fmt: skip
AMCL = {
    "base_frame_id", "global_frame_id", "odom_frame_id", "laser_max_range", "laser_model_type", "max_beams",
    "max_particles", "min_particles", "robot_model_type", "tf_broadcast", "update_min_a", "update_min_d", "scan_topic",
    "map_topic", "set_initial_pose", *(f"initial_pose.{name}" for name in ("x", "y", "z", "yaw")),
}  # fmt: skip
CHECKERS = {
    "goal_checker_plugins", "controller_plugins", "controller_frequency", "min_x_velocity_threshold",
    "min_y_velocity_threshold", "min_theta_velocity_threshold", "failure_tolerance",
    *(f"progress_checker.{name}" for name in ("plugin", "required_movement_radius", "movement_time_allowance")),
    *(f"goal_checker.{name}" for name in ("plugin", "xy_goal_tolerance", "yaw_goal_tolerance", "stateful")),
}  # fmt: skip
DWB = {
    "plugin", "min_vel_x", "max_vel_x", "min_vel_y", "max_vel_y", "max_vel_theta", "min_speed_xy", "max_speed_xy",
    "min_speed_theta", "acc_lim_x", "acc_lim_y", "acc_lim_theta", "decel_lim_x", "decel_lim_y", "decel_lim_theta",
    "vx_samples", "vy_samples", "vtheta_samples", "sim_time", "linear_granularity", "angular_granularity",
    "transform_tolerance", "xy_goal_tolerance", "trans_stopped_velocity", "short_circuit_trajectory_evaluation",
    "stateful", "critics", "BaseObstacle.scale", "PathAlign.scale", "PathAlign.forward_point_distance",
    "GoalAlign.scale", "GoalAlign.forward_point_distance", "PathDist.scale", "GoalDist.scale", "RotateToGoal.scale",
    "RotateToGoal.slowing_factor", "RotateToGoal.lookahead_time",
}  # fmt: skip
WEIGHTS = {"enabled", "cost_power", "cost_weight"}
CRITICS = {
    "ConstraintCritic": WEIGHTS,
    "GoalCritic": WEIGHTS | {"threshold_to_consider"},
    "GoalAngleCritic": WEIGHTS | {"threshold_to_consider"},
    "PreferForwardCritic": WEIGHTS | {"threshold_to_consider"},
    "CostCritic": WEIGHTS
    | {"near_collision_cost", "critical_cost", "consider_footprint", "collision_cost", "near_goal_distance"}
    | {"trajectory_point_step"},
    "PathAlignCritic": WEIGHTS
    | {"max_path_occupancy_ratio", "trajectory_point_step", "threshold_to_consider", "offset_from_furthest"}
    | {"use_path_orientations"},
    "PathFollowCritic": WEIGHTS | {"offset_from_furthest", "threshold_to_consider"},
    "PathAngleCritic": WEIGHTS | {"offset_from_furthest", "threshold_to_consider", "max_angle_to_furthest", "mode"},
}
MPPI = {
    "plugin", "time_steps", "model_dt", "batch_size", "iteration_count", "motion_model", "vx_max", "vx_min", "vy_max",
    "wz_max", "ax_max", "ax_min", "az_max", "vx_std", "vy_std", "wz_std", "prune_distance", "transform_tolerance",
    "temperature", "gamma", "visualize", "critics", *(f"{item}.{name}" for item in CRITICS for name in CRITICS[item]),
}  # fmt: skip
NAVIGATOR = {"global_frame", "robot_base_frame", "odom_topic", "bt_loop_duration", "default_server_timeout"}
PLANNER = {
    "expected_planner_frequency", "planner_plugins",
    *(f"GridBased.{name}" for name in ("plugin", "tolerance", "use_astar", "allow_unknown")),
}  # fmt: skip
SMOOTHER = {
    "smoother_plugins",
    *(f"simple_smoother.{name}" for name in ("plugin", "tolerance", "max_its", "do_refinement")),
}
BEHAVIORS = {
    "robot_base_frame", "global_frame", "transform_tolerance", "cycle_frequency", "behavior_plugins", "spin.plugin",
    "backup.plugin", "drive_on_heading.plugin", "wait.plugin", "simulate_ahead_time", "max_rotational_vel",
    "min_rotational_vel", "rotational_acc_lim",
}  # fmt: skip
VELOCITY = {
    "smoothing_frequency", "scale_velocities", "feedback", "max_velocity", "min_velocity", "max_accel", "max_decel",
    "odom_topic", "odom_duration", "deadband_velocity", "velocity_timeout",
}  # fmt: skip
COMMON = {
    "amcl": AMCL | SERVER,
    "planner_server": PLANNER | SERVER,
    "smoother_server": SMOOTHER | SERVER,
    "velocity_smoother": VELOCITY | SERVER,
    "local_costmap/local_costmap": COSTMAP | SERVER,
    "global_costmap/global_costmap": COSTMAP | SERVER,
}
LATER_NAVIGATOR = (
    NAVIGATOR
    | SERVER
    | {"wait_for_service_timeout", "navigators", "navigate_to_pose.plugin", "navigate_through_poses.plugin"}
)
LATER_CONTROLLER = CHECKERS | SERVER | {"progress_checker_plugins", "enable_stamped_cmd_vel"}
LATER_BEHAVIORS = (
    BEHAVIORS
    | SERVER
    | {"local_frame", "local_costmap_topic", "global_costmap_topic"}
    | {"local_footprint_topic", "global_footprint_topic"}
)
NAV2 = {
    "humble": COMMON
    | {
        "bt_navigator": NAVIGATOR | SERVER,
        "controller_server": CHECKERS | SERVER | {"progress_checker_plugin"} | {f"FollowPath.{name}" for name in DWB},
        "behavior_server": BEHAVIORS | SERVER | {"costmap_topic", "footprint_topic"},
    },
    "jazzy": COMMON
    | {
        "bt_navigator": LATER_NAVIGATOR | {"error_code_names"},
        "controller_server": LATER_CONTROLLER | {f"FollowPath.{name}" for name in MPPI},
        "behavior_server": LATER_BEHAVIORS,
    },
    "lyrical": COMMON
    | {
        "bt_navigator": LATER_NAVIGATOR | {"error_code_name_prefixes"},
        "controller_server": LATER_CONTROLLER
        | {"path_handler_plugins", "PathHandler.plugin", "PathHandler.prune_distance", "FollowPath.diff_drive.plugin"}
        | {f"FollowPath.{name}" for name in MPPI - {"prune_distance", "transform_tolerance"}},
        "behavior_server": LATER_BEHAVIORS,
    },
}
"""Names of the parameters of each node, by distribution."""

OLD_COSTMAP = {
    "global_frame", "robot_base_frame", "robot_radius", "transform_tolerance", "update_frequency", "publish_frequency",
    "rolling_window", "width", "height", "resolution", "plugins", "static_layer.map_topic",
    "static_layer.track_unknown_space", "inflation_layer.inflation_radius", "inflation_layer.cost_scaling_factor",
    "obstacle_layer.observation_sources", "obstacle_layer.max_obstacle_height",
    *(
        f"obstacle_layer.scan.{name}"
        for name in ("topic", "data_type", "marking", "clearing", "inf_is_valid", "obstacle_range", "raytrace_range")
    ),
}  # fmt: skip
DWA = {
    "odom_topic", "max_vel_trans", "min_vel_trans", "max_vel_x", "min_vel_x", "max_vel_y", "min_vel_y", "max_vel_theta",
    "min_vel_theta", "acc_lim_x", "acc_lim_y", "acc_lim_theta", "acc_lim_trans", "xy_goal_tolerance",
    "yaw_goal_tolerance", "trans_stopped_vel", "theta_stopped_vel", "sim_time", "sim_granularity",
    "angular_sim_granularity", "vx_samples", "vy_samples", "vth_samples", "path_distance_bias", "goal_distance_bias",
    "occdist_scale", "forward_point_distance", "stop_time_buffer", "oscillation_reset_dist", "prune_plan",
}  # fmt: skip
MOVE_BASE = {
    "base_global_planner", "base_local_planner", "controller_frequency", "controller_patience", "planner_frequency",
    "planner_patience", "oscillation_timeout", "oscillation_distance", "recovery_behavior_enabled", "shutdown_costmaps",
    *(f"{costmap}.{name}" for costmap in ("global_costmap", "local_costmap") for name in OLD_COSTMAP),
    "NavfnROS.allow_unknown", "NavfnROS.default_tolerance", *(f"DWAPlannerROS.{name}" for name in DWA),
}  # fmt: skip
OLD_AMCL = {
    "tf_broadcast", "use_map_topic", "odom_frame_id", "base_frame_id", "global_frame_id", "odom_model_type",
    "initial_pose_x", "initial_pose_y", "initial_pose_a", "laser_model_type", "laser_max_range", "laser_max_beams",
    "min_particles", "max_particles", "update_min_d", "update_min_a",
}  # fmt: skip
