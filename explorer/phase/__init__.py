"""Where a state is: the disk, charts of its phase space, constants of motion and the falling set."""
