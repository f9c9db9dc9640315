"""Makes the documentation: `python -m tools.site` writes it to build/site.

It needs no server and no network: `build/site/index.html` opens from the folder, with its search.
"""

import sys
import tempfile
from pathlib import Path

from motionsync.blocks import BLOCKS
from motionsync_fmu import UserError, explore
from tools.site.build import make_site
from tools.site.pages import ROOT


def main() -> None:
    """Make the site in build/site."""
    folder = ROOT / "build" / "site"
    try:
        with tempfile.TemporaryDirectory() as work:
            for name in BLOCKS:
                print(f"the page to explore {name}", flush=True)
                explore(name, output=work)
            make_site(folder, Path(work))
    except UserError as error:
        sys.exit(f"site: {error}")
    print((folder / "index.html").as_uri())


if __name__ == "__main__":
    main()
