"""Readers of ROS recordings: bags, their frames, and episodes."""
