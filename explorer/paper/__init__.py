"""The paper reproduced: its statements as checks, its figures, its misprints."""
