"""Navigators that open a connection of their own: to robot software, or to a real robot."""
