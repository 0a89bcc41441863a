"""Pictures: one function each, in the file of its family, on axes that are given or on a new figure."""
