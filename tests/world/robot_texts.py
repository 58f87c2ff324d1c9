"""URDF texts for tests."""

BALL = "<collision><geometry><sphere radius='{radius}'/></geometry></collision>"


def link(name, inside="", mass=1.0, moments=(0.1, 0.1, 0.1)):
    """Return a link with a mass and anything inside."""
    x, y, z = moments
    inertia = f"<inertia ixx='{x}' iyy='{y}' izz='{z}' ixy='0' ixz='0' iyz='0'/>"
    return f"<link name='{name}'><inertial><mass value='{mass}'/>{inertia}</inertial>{inside}</link>"


def joint(name, kind, parent, child, inside=""):
    """Return a joint."""
    return f"<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>{inside}</joint>"


def robot(*parts):
    """Return a robot; every part stands on its own line, the first on line 2."""
    return "\n".join(["<robot name='r'>", *parts, "</robot>"])


def mesh(filename, tag="visual", scale=""):
    """Return a shape from a mesh file."""
    size = f" scale='{scale}'" if scale else ""
    return f"<{tag}><geometry><mesh filename='{filename}'{size}/></geometry></{tag}>"
