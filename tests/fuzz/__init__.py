"""Nasty arguments, command lines, files and folders; `python -m tests.fuzz --cases 20000` tries many of them."""
