"""The simulation of one stone: motions whose ends are known, and drops at the ends of what is allowed."""
