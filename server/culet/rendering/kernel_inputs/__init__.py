"""A scene as the kernels read it: parameters, tables of stones, the light of the room."""
