"""Motion beside the gait: poses of activities, and clips from motion capture."""
