"""One rigid body: its state, its mass and inertia, how it turns and moves, and the planes that stop it."""
