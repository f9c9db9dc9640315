"""What all pages have in common: their templates, and the colours of master and slave."""

import jinja2

TEMPLATES = jinja2.Environment(
    loader=jinja2.PackageLoader("motionsync_fmu.pages"), autoescape=True, trim_blocks=True, lstrip_blocks=True
)
MASTER, SLAVE = "#7a8793", "#c8451b"
