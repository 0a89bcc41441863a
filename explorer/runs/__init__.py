"""Runs on disk: chunks of samples, who computes them, and what is written."""
