"""Warnings of this package, so that filters can name them."""


class ConversionWarning(UserWarning):
    """A model was made for another nominal robot, and its numbers were converted to this one."""
