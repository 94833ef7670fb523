# SPDX-License-Identifier: GPL-3.0-or-later
"""What can go wrong between Blender's data and the model."""


class Refusal(Exception):  # noqa: N818 - a word users and operators both read
    """The object cannot be posed as it is; the message says what to do about it."""


class ObjectGone(Exception):  # noqa: N818
    """The object or mesh a posing began with has been deleted, replaced or edited meanwhile."""
