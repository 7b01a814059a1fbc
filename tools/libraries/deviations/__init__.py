"""Where libraries deviate: see ../reproduction.py."""
