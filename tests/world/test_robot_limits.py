"""Limits of wheels that contradict each other, are left from a template or are implausible are marked."""

import pytest
from base_texts import base_file

from crowdbot.world import import_robot

COMMAND = (
    "<joint name='{joint}'><command_interface name='velocity'><param name='min'>-{most}</param>"
    "<param name='max'>{most}</param></command_interface></joint>"
)
WHEELS = {
    "differential": ("left_joint", "right_joint"),
    "skid-steer": tuple(f"{end}_{side}_joint" for end in ("front", "rear") for side in ("left", "right")),
    "mecanum": tuple(f"mecanum_{end}_{side}_joint" for end in ("front", "rear") for side in ("left", "right")),
}


def robot(folder, kind, *, command=None, limit=None, radius=0.1, extra=""):
    """Import a robot whose wheels have these limits [rad/s]; return the rows of its table by name."""
    text = base_file(kind).replace("radius:=0.1", f"radius:={radius}")
    if limit is not None:
        axle = "rpy='${-pi / 2} 0 ${yaw}'/><axis xyz='0 0 1'/>"
        assert axle in text
        text = text.replace(axle, f"{axle}<limit effort='9' velocity='{limit}'/>")
    if command is not None:
        rows = "".join(COMMAND.format(joint=name, most=command) for name in WHEELS[kind])
        extra += f"<ros2_control name='c' type='system'>{rows}</ros2_control>"
    file = folder / "r.xacro"
    file.write_text(text.replace("</robot>", f"{extra}</robot>"))
    return {guess.what: guess for guess in import_robot(file, "r").guesses}


@pytest.mark.parametrize("kind", WHEELS)
@pytest.mark.parametrize(("command", "limit", "radius"), [(1, 10, 0.1), (1.0, 8, 0.2), (0.5, 10, 0.1), (1, 4, 0.3)])
def test_a_template_does_not_win_over_the_joint(tmp_path, kind, command, limit, radius):
    row = robot(tmp_path, kind, command=command, limit=limit, radius=radius)["max-speed"]
    assert row.value == f"{limit * radius:.4g} m/s"
    assert row.open
    assert row.source == (
        f"{limit:g} rad/s in <limit> of the wheels; <ros2_control> of the wheels has {command:g}, perhaps of a template"
    )


@pytest.mark.parametrize(("command", "limit", "counts"), [(6, 10, 6), (12, 10, 10), (3, 40, 3)])
def test_of_two_plausible_limits_the_lower_counts_and_both_are_listed(tmp_path, command, limit, counts):
    row = robot(tmp_path, "differential", command=command, limit=limit)["max-speed"]
    assert (row.value, row.status) == (f"{0.1 * counts:.4g} m/s", "doubtful")
    assert f"{command:g}" in row.source
    assert f"{limit:g}" in row.source


@pytest.mark.parametrize(("command", "limit"), [(6, 6), (6, None), (None, 6), (6, 6.01)])
def test_places_that_agree_are_not_marked(tmp_path, command, limit):
    row = robot(tmp_path, "differential", command=command, limit=limit)["max-speed"]
    assert (row.value, row.status) == ("0.6 m/s", "file")


@pytest.mark.parametrize(
    ("words", "value", "reason"),
    [
        ({"command": 1}, "0.1 m/s", "1 rad/s, perhaps of a template; implausible: below 0.2"),
        ({"limit": 1.5}, "0.15 m/s", "implausible: below 0.2"),
        ({"command": 1, "limit": 1000}, "0.1 m/s", "<limit> of the wheels has 1000 rad/s"),
        ({"limit": 1000}, "1 m/s", "10 rad/s of the wheels; <limit> of the wheels has 1000 rad/s, not used"),
    ],
)
def test_implausible_limits_are_marked(tmp_path, words, value, reason):
    row = robot(tmp_path, "differential", **words)["max-speed"]
    assert row.value == value
    assert row.open
    assert reason in row.source


def plugin(**values):
    rows = "".join(f"<{tag}>{value}</{tag}>" for tag, value in values.items())
    return f"<gazebo><plugin name='p' filename='libgazebo_ros_diff_drive.so'>{rows}</plugin></gazebo>"


@pytest.mark.parametrize(
    ("tag", "row", "value", "reason"),
    [
        ("max_linear_velocity", "max-speed", 7, "implausible: above 5"),
        ("max_linear_velocity", "max-speed", 0.1, "implausible: below 0.2"),
        (
            "max_linear_velocity",
            "max-speed",
            1.5,
            "the drive plugin; the wheels allow 0.6 m/s: 6 rad/s in <ros2_control>",
        ),
        ("max_linear_acceleration", "max-acceleration", 20, "implausible: above 5"),
        ("max_linear_acceleration", "max-acceleration", 0.01, "implausible: below 0.1"),
        ("max_angular_velocity", "max-turn-rate", 30, "implausible: above 10"),
        ("max_angular_acceleration", "max-turn-acceleration", 0.1, "implausible: below 0.2"),
        ("wheel_radius", "wheel left_joint", 0.15, "the drive plugin has 0.15"),
    ],
)
def test_values_of_a_plugin_that_do_not_fit_are_marked(tmp_path, tag, row, value, reason):
    limit = {"command": 6, "limit": 10} if value == 1.5 else {}
    found = robot(tmp_path, "differential", extra=plugin(**{tag: value}), **limit)
    assert found[row].open
    assert reason in found[row].source


@pytest.mark.parametrize(("speed", "status"), [(0.6, "file"), (0.5, "doubtful")])
def test_a_controller_file_that_contradicts_the_plugin_is_marked(tmp_path, speed, status):
    (tmp_path / "config").mkdir()
    (tmp_path / "package.xml").write_text("<package><name>r</name></package>")
    (tmp_path / "config" / "c.yaml").write_text(
        "base: {ros__parameters: {type: diff_drive_controller/DiffDriveController, left_wheel_names: [left_joint],"
        f" right_wheel_names: [right_joint], linear.x.max_velocity: {speed}}}}}\n"
    )
    row = robot(tmp_path, "differential", extra=plugin(max_linear_velocity=0.6))["max-speed"]
    assert (row.value, row.status) == (f"{speed} m/s", status)
    assert ("the drive plugin has 0.6" in row.source) == (status == "doubtful")
