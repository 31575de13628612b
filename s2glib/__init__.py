"""How speech becomes gesture: the companion package of the workbook."""

__version__ = "0.1.0"
