"""The libraries' views of the components, one function each: see ../bases.py."""
