"""The fast path near flat: passages and falls from the vertical by tables of the body."""
