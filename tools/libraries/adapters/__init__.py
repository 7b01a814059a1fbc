"""One file a library: its own functions, unchanged, behind the names of the contract's arrays."""
