"""Buildings in glTF: triangles with materials, and doors."""
