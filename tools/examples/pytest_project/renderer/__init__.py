"""A small renderer in numpy, as a project may have one."""
