"""`python -m explorer` is the command `nearflat`."""

import sys

from explorer.commands.main import main

sys.exit(main())
