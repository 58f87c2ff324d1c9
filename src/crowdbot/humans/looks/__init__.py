"""What people look like: pictures of skin and cloth, carried things, and keypoints."""
