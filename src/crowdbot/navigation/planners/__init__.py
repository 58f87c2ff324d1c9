"""Navigators that choose a velocity from forces, or a twist by search; see :mod:`crowdbot.navigation`."""
