"""Participant: a context of rclpy with one node and the thread that spins it."""

from __future__ import annotations

import importlib
import threading
import warnings
from typing import Any

from crowdbot.core import InputError, MissingExtra

SPIN = 0.1
"""Longest time [s] until the thread sees that it has to end."""


class Participant:
    """One node with a thread of its own, in a DDS participant of its own.

    Args:
        ros: the module rclpy.
        name: name of the node.
        domain: ROS domain; None: that of the environment.
        threads: number of callbacks that can run at the same time.

    Raises:
        MissingExtra: a part of ROS is not installed.
        InputError: the node cannot be started.
    """

    def __init__(self, ros: Any, name: str, domain: int | None, threads: int = 1) -> None:
        signals = importlib.import_module("rclpy.signals").SignalHandlerOptions
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", DeprecationWarning)  # of what ROS imports
                self.context = ros.Context()
                ros.init(context=self.context, domain_id=domain, signal_handler_options=signals.NO)
                self.node = ros.create_node(name, context=self.context)
        except ImportError as error:  # for instance the library of the middleware
            raise MissingExtra(f"the bridge ros2 ({error})", "ros2-wheels") from None
        except RuntimeError as error:
            raise InputError(f"ros2 cannot start a node: {str(error).splitlines()[0]}") from None
        executors = importlib.import_module("rclpy.executors")
        if threads == 1:
            self._executor = executors.SingleThreadedExecutor(context=self.context)
        else:
            self._executor = executors.MultiThreadedExecutor(threads, context=self.context)
        self._executor.add_node(self.node)
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._spin, name=name, daemon=True)

    def start(self) -> None:
        """Start the thread; without effect if it runs."""
        if not self._thread.is_alive():
            self._thread.start()

    def stop(self) -> None:
        """End the thread and the node."""
        self._end.set()
        if self._thread.is_alive():
            self._thread.join()
        self._executor.shutdown()
        self.node.destroy_node()
        self.context.try_shutdown()

    def _spin(self) -> None:
        while not self._end.is_set() and self.context.ok():
            self._executor.spin_once(timeout_sec=SPIN)
