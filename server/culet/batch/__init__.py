"""Long work on many scenes: sweeps of a scene's numbers, and animations. What was done outlives an interruption."""
