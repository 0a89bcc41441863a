"""What the phase space looks like: data of pictures that need no run."""
