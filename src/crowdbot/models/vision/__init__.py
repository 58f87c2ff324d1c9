"""Models that react to what people see: directions, times and distances of closest approach."""
