"""Text formats: XML trees, YAML and SVG drawings."""
