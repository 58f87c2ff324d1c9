"""RViz 1 on an X server without a screen, and the picture that it shows."""

import contextlib
import os
import struct
import subprocess
import time

import numpy as np
import pytest

WIDTH, HEIGHT = 1280, 900


class RvizScreen(contextlib.ExitStack):
    """Starts Xvfb and RViz with a file of displays; ROS is that of the environment.

    Args:
        command: command of RViz.
        file: displays of RViz.
        environment: variables of the programs.
        folder: for logs, and the memory of the screen.
    """

    def __init__(self, command, file, environment, folder):
        super().__init__()
        self.file = folder / "Xvfb_screen0"
        reading, writing = os.pipe()
        screen = ["-screen", "0", f"{WIDTH}x{HEIGHT}x24", "-fbdir", str(folder), "-displayfd", str(writing)]
        self._start(["Xvfb", *screen, "-nolisten", "tcp"], {**os.environ}, pass_fds=(writing,))
        os.close(writing)
        with os.fdopen(reading) as told:
            number = told.readline().strip()
        own = {"DISPLAY": f":{number}", "LIBGL_ALWAYS_SOFTWARE": "1", "HOME": str(folder), "QT_X11_NO_MITSHM": "1"}
        own["XDG_RUNTIME_DIR"] = str(folder)
        self.log = folder / "rviz.txt"
        with self.log.open("w") as log:
            self.rviz = self._start([command, "-d", str(file)], {**environment, **own}, stdout=log, stderr=log)

    def _start(self, words, environment, **options):
        options = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL} | options
        process = subprocess.Popen(words, env=environment, **options)
        self.callback(process.wait)
        self.callback(process.kill)
        return process

    def picture(self):
        """Return the pixels of the screen [H, W, 3], from the XWD file in which Xvfb keeps them."""
        data = self.file.read_bytes()
        fields = struct.unpack(">25I", data[:100])
        start, width, height, line = fields[0] + 12 * fields[19], fields[4], fields[5], fields[12]
        rows = np.frombuffer(data, dtype=np.uint8, count=line * height, offset=start).reshape(height, line)
        return rows[:, : 4 * width].reshape(height, width, 4)[..., 2::-1]

    def wait(self, reached, seconds=180.0):
        """Wait until a picture has what is wanted, and return it."""
        end = time.monotonic() + seconds
        while time.monotonic() < end and self.rviz.poll() is None:
            picture = self.picture()
            if reached(picture):
                return picture
            time.sleep(0.5)
        return pytest.fail(f"RViz does not show it: {self.log.read_text()[-2000:]}")
