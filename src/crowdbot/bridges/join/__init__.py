"""A real robot in a trial: its odometry moves its avatar, virtual sensors and guarded commands go back to it."""
