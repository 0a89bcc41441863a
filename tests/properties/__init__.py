"""Claims about any input: calls, command lines and run folders; `nox -s fuzz` tries 20,000 of them."""
