"""What several stones are held to when they touch: trials with a known answer, and the table of how near they come."""
