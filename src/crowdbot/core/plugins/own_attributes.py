"""Class attributes that a subclass does not inherit, since they say what the code of one class does."""

from __future__ import annotations


def reset_undeclared(kind: type, **defaults: object) -> None:
    """Give a class the default of every attribute that its own body does not assign.

    A contract calls this in ``__init_subclass__`` for attributes such as ``batched``, which promise something about
    the methods of a class: a subclass that changes a method would otherwise repeat a promise that it may not keep.

    >>> class Model:
    ...     batched = False
    ...     def __init_subclass__(cls):
    ...         reset_undeclared(cls, batched=False)
    >>> class Straight(Model):
    ...     batched = True
    >>> class Drunk(Straight): pass
    >>> Straight.batched, Drunk.batched
    (True, False)
    """
    for name, value in defaults.items():
        if name not in vars(kind):
            setattr(kind, name, value)
