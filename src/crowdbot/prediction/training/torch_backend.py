"""Access to PyTorch: optional import, devices, threads, tensors."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Any

from crowdbot.core import InputError, import_optional


def torch_module() -> Any:
    """Return torch.

    Raises:
        MissingExtra: PyTorch is not installed.
    """
    return import_optional("torch", "learned prediction", "learn")


def torch_device(name: str) -> Any:
    """Return the torch device ``cpu``, ``cuda`` or ``cuda:N``.

    Raises:
        MissingExtra: torch is not installed.
        InputError: the device does not exist.
    """
    torch = torch_module()
    kind, _, number = name.partition(":")
    if kind not in ("cpu", "cuda") or (number and not number.isdigit()):
        raise InputError(f"unknown device {name!r}; known are cpu, cuda and cuda:N")
    if kind == "cuda":
        count = torch.cuda.device_count() if torch.cuda.is_available() else 0
        if int(number or 0) >= count:
            raise InputError(f"device {name!r} does not exist: torch finds {count} CUDA devices; use cpu")
    return torch.device(name)


@contextlib.contextmanager
def torch_threads(count: int = 1) -> Iterator[None]:
    """Set the number of PyTorch threads in a context; with one thread, the summation order is fixed.

    Small networks are as fast with one thread.
    """
    torch = torch_module()
    before = torch.get_num_threads()
    torch.set_num_threads(count)
    try:
        yield
    finally:
        torch.set_num_threads(before)


def to_tensors(tree: Any, device: Any = "cpu") -> Any:
    """Return a tree of :func:`load_checkpoint` with its arrays as tensors.

    >>> to_tensors({"step": 3})
    {'step': 3}
    """
    if isinstance(tree, dict):
        return {key: to_tensors(value, device) for key, value in tree.items()}
    if isinstance(tree, list):
        return [to_tensors(value, device) for value in tree]
    if hasattr(tree, "dtype") and hasattr(tree, "shape"):
        return torch_module().as_tensor(tree, device=device)
    return tree
