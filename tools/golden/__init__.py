"""Generators of the committed fixtures, one module a component; run through tools/golden.py."""
