"""Warnings of this package, so that filters can name them."""


class UmbmarkWarning(UserWarning):
    """Any warning of this package."""


class ConversionWarning(UmbmarkWarning):
    """A model was made for another nominal robot, and its numbers were converted to this one."""
