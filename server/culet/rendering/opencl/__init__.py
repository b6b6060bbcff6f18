"""The OpenCL device: its driver, processors and compiler, where programs are kept, and what it reads."""
