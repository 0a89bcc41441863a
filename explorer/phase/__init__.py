"""The place of a state: the disk, charts of its phase space, constants of motion and the falling set."""
