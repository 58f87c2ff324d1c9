"""Types of ROS 2 that the wheels lack, built for rclpy as a ROS installation has them: by rosidl and a compiler of C++.

    python ros2_types.py FOLDER

builds ``trajectory_msgs`` and ``control_msgs``, as far as FollowJointTrajectory needs them, in about 20 s. Programs
find them with ``PYTHONPATH=FOLDER/py`` and ``LD_LIBRARY_PATH=FOLDER/lib``.
"""

import importlib.metadata
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy

HEADER, DURATION = "std_msgs/msg/Header", "builtin_interfaces/msg/Duration"
POINT, TRAJECTORY = "trajectory_msgs/msg/JointTrajectoryPoint", "trajectory_msgs/msg/JointTrajectory"
TOLERANCE, ACTION = "control_msgs/msg/JointTolerance", "control_msgs/action/FollowJointTrajectory"
DEFINITIONS = {
    POINT: {"": ["[double positions velocities accelerations effort", f"{DURATION} time_from_start"]},
    TRAJECTORY: {"": [f"{HEADER} header", "[string joint_names", f"[{POINT} points"]},
    TOLERANCE: {"": ["string name", "double position velocity acceleration"]},
    ACTION: {
        "_Goal": [
            f"{TRAJECTORY} trajectory",
            f"[{TOLERANCE} path_tolerance goal_tolerance",
            f"{DURATION} goal_time_tolerance",
        ],
        "_Result": ["long error_code", "string error_string"],
        "_Feedback": [f"{HEADER} header", "[string joint_names", f"{POINT} desired actual error"],
    },
}
"""Fields by type and by part of an action, the first word their type; a bracket is a sequence."""
PREFIX = Path(sys.prefix)
PARTS = ("generator_c", "typesupport_c", "typesupport_fastrtps_c", "typesupport_introspection_c", "generator_py")
USED = ("builtin_interfaces", "std_msgs", "action_msgs", "unique_identifier_msgs", "service_msgs")
SUPPORTS = ("c", "fastrtps_c", "fastrtps_cpp", "introspection_c")
RUNTIME = ("rosidl_runtime_c", *(f"rosidl_typesupport_{name}" for name in SUPPORTS), "rmw", "rcutils", "fastcdr")


def write_definition(kind, folder):
    """Write the IDL file of a type."""
    package, group, name = kind.split("/")
    lines = [f"module {package} {{ module {group} {{"]
    used = set()
    for part, rows in DEFINITIONS[kind].items():
        lines.append(f"struct {name}{part} {{")
        for row in rows:
            field, *names = row.lstrip("[").split()
            used |= {field} & {item for item in row.lstrip("[").split() if "/" in item}
            text = field.replace("/", "::")
            text = f"sequence<{text}>" if row.startswith("[") else text
            lines += [f"{text} {item};" for item in names]
        lines.append("};")
    path = folder / package / group / f"{name}.idl"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join([f'#include "{item}.idl"' for item in sorted(used)] + lines + ["}; };"]) + "\n")


def build(package, earlier, folder):
    """Generate and compile the types of a package, after those of earlier packages."""
    from rosidl_cli.command.generate.api import generate

    files = [f"{folder}/idl/{package}:{kind.partition('/')[2]}.idl" for kind in DEFINITIONS if kind.startswith(package)]
    include = [str(PREFIX / "share"), *(f"{folder}/idl/{name}" for name in earlier)]

    def sources(part, ending, **words):
        target = folder / part / package
        generate(package_name=package, interface_files=files, include_paths=include, output_path=target, **words)
        return sorted(target.rglob(ending))

    found = sources("c", "*.c", types=["c"])
    for path in (folder / "c" / package).rglob("*.json"):
        shutil.copy(path, folder / "idl" / package / path.parent.name)
    for part, ending in (("typesupport", "*.cpp"), ("fastrtps_c", "*.cpp"), ("introspection_c", "*.c")):
        found += sources(part, ending, typesupports=["c" if part == "typesupport" else part])
    found += sources("py", "*_s.c", types=["py"])
    libraries = [f"{name}__rosidl_{part}" for name in (*USED, *earlier) for part in PARTS]
    library = folder / "lib" / f"lib{package}__rosidl_{PARTS[0]}.so"
    compile_library(found, library, [*libraries, *RUNTIME], folder)
    for part in PARTS[1:]:
        library.with_name(f"lib{package}__rosidl_{part}.so").symlink_to(library.name)
    module = folder / "py" / package
    (module / "__init__.py").touch()
    entry = [module / f"_{package}_s.ep.rosidl_typesupport_c.c"]
    compile_library(entry, module / f"{package}_s__rosidl_typesupport_c.so", [f"{package}__rosidl_{PARTS[0]}"], folder)


def compile_library(sources, target, libraries, folder):
    """Compile sources into a shared library."""
    target.parent.mkdir(exist_ok=True)
    include = [PREFIX / "include", *(PREFIX / "include").iterdir(), sysconfig.get_path("include"), numpy.get_include()]
    include += [folder / part for part in ("c", "fastrtps_c", "introspection_c")]
    words = ["-fPIC", "-w", *(f"-I{path}" for path in include)]
    objects = []
    for source in sources:
        objects.append(source.with_suffix(f"{source.suffix}.o"))
        compiler = "g++" if source.suffix == ".cpp" else "gcc"
        subprocess.run([compiler, "-c", *words, "-o", objects[-1], source], check=True)
    paths = [PREFIX / "lib", folder / "lib"]
    where = [word for path in paths for word in (f"-L{path}", f"-Wl,-rpath,{path}")]
    subprocess.run(["g++", "-shared", "-o", target, *objects, *where, *(f"-l{name}" for name in libraries)], check=True)


def main():
    folder = Path(sys.argv[1]).resolve()
    os.environ["AMENT_PREFIX_PATH"] = sys.prefix
    entries = {  # the wheels name each twice
        (item.group, item.name): item
        for one in importlib.metadata.distributions()
        for item in one.entry_points
        if item.group.startswith("rosidl")
    }
    importlib.metadata.entry_points = lambda: importlib.metadata.EntryPoints(entries.values())
    for kind in DEFINITIONS:
        write_definition(kind, folder / "idl")
    build("trajectory_msgs", (), folder)
    build("control_msgs", ("trajectory_msgs",), folder)


if __name__ == "__main__":
    main()
