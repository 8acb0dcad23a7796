"""A cell of a page that says what its picture shows has one."""

from docutils import nodes
from sphinx.errors import ExtensionError


def check(app, doctree):
    """Fail for a cell with the option ``alt`` that shows no picture: its readers would see nothing of it.

    Raises
    ------
    ExtensionError
        With the page and the words.
    """
    for cell in doctree.findall(nodes.container):
        words = cell.get("cell_metadata", {}).get("mystnb", {}).get("image", {}).get("alt")
        if words and not list(cell.findall(nodes.image)):
            raise ExtensionError(f"{app.env.docname}: a cell with this alt shows no picture: {words!r}")
