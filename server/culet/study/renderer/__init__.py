"""The renderer: what its approximations cost and save, against converged pictures and other renderers."""
