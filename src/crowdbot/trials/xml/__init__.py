"""The XML of trials: reader, writer, schema."""
