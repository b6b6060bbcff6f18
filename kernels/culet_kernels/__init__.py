"""OpenCL C by physical stage, and a loader."""
