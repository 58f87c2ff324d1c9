"""OpenGL contexts without a display: EGL if it works, otherwise OSMesa."""

from __future__ import annotations

import atexit
import functools
import importlib
import os
import subprocess
import sys
import threading
from typing import Any

from crowdbot.core import InputError
from crowdbot.world.physics.engine import engine

KNOWN = ("egl", "osmesa", "glfw", "cgl")
PROBE = "import mujoco.{name} as way; context = way.GLContext(16, 16); context.make_current(); context.free()"
OPEN: list[Any] = []
"""Contexts in use."""
LIBRARIES: set[str] = set()
"""Names of the libraries of all contexts of this program."""
BUSY: list[Any] = []
"""Renderers whose context is current in another thread."""
CURRENT = threading.local()
"""The context that this thread draws in, as ``CURRENT.context``."""
LONGEST = 60.0
"""Timeout of the test of a backend [s]."""


@functools.cache
def backend() -> str:
    """Return the OpenGL backend: ``MUJOCO_GL`` if set, otherwise the first of EGL and OSMesa that works.

    Raises:
        InputError: no backend works, or ``MUJOCO_GL`` is unknown.
        MissingExtra: mujoco is not installed.
    """
    engine()
    asked = os.environ.get("MUJOCO_GL", "").lower() or os.environ.get("PYOPENGL_PLATFORM", "").lower()
    if asked:
        if asked not in KNOWN:
            raise InputError(f"MUJOCO_GL = {asked!r} must be one of {', '.join(KNOWN)}, or unset")
        return asked
    if sys.platform == "darwin":
        return "cgl"
    elif sys.platform == "win32":
        return "glfw"
    else:
        for name in ("egl", "osmesa"):
            if _works(name):
                return name
    raise InputError(
        "rendering is not available: neither EGL nor OSMesa works; install one (Debian: apt install libosmesa6)"
    )


def create_gl_context(width: int, height: int) -> Any:
    """Create an OpenGL context of this size and make it current.

    Raises:
        InputError: no backend works.
    """
    name = backend()
    try:
        made = importlib.import_module(f"mujoco.{name}").GLContext(width, height)
        use_gl_context(made)
    except Exception as error:  # each backend raises its own errors
        raise InputError(
            f"rendering with {name} does not work ({str(error).strip() or type(error).__name__});"
            " set MUJOCO_GL to egl or osmesa before Python starts"
        ) from error
    LIBRARIES.add(_library(name))
    if not OPEN:
        atexit.register(_closed)  # registered after the backend is loaded, to be closed before the backend
    OPEN.append(made)
    return made


def use_gl_context(context: Any) -> None:
    """Make a context current in this thread."""
    context.make_current()
    CURRENT.context = context


def close_gl_context(context: Any, drawn_by: Any) -> None:
    """Free a context and the renderer that uses it.

    A context that is current in another thread stays until the program ends: no other thread can free it. The garbage
    collector may call this while another renderer of this thread draws, so its context becomes current again.
    """
    if context in OPEN:
        drawn_in = getattr(CURRENT, "context", None)
        try:
            context.make_current()
        except Exception:  # each backend raises its own errors
            BUSY.append(drawn_by)
            return
        OPEN.remove(context)
        drawn_by.free()
        context.free()
        if drawn_in in OPEN:
            use_gl_context(drawn_in)
        else:
            CURRENT.context = None


def graphics_library() -> tuple[str, ...]:
    """Return the libraries that have drawn images in this program, with backend, renderer and version.

    Images of other libraries may differ in the last bits; those of the renderer ``software`` do not.
    """
    return tuple(sorted(LIBRARIES))


def _library(name: str) -> str:
    """Return the name of the library of the current context."""
    from OpenGL import GL

    words = (GL.glGetString(kind) for kind in (GL.GL_RENDERER, GL.GL_VERSION))
    return f"{name}: " + ", ".join((word or b"unknown").decode("ascii", "replace") for word in words)


def _closed() -> None:
    while OPEN:
        OPEN.pop().free()


def _works(name: str) -> bool:
    """Return whether a backend works, tested in a separate process: a failure would affect later backends."""
    program = PROBE.format(name=name)
    try:
        run = subprocess.run([sys.executable, "-c", program], capture_output=True, timeout=LONGEST, check=False)  # noqa: S603
    except (OSError, subprocess.TimeoutExpired):
        return False
    return run.returncode == 0
