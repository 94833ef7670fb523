# SPDX-License-Identifier: GPL-3.0-or-later
"""The pose sequence: shapes kept over time, as absolute shape keys that one F-curve plays.

Blocks, in the order of their eval_time, which is what the Key's has to be to show them:

    Basis          0             the rest shape
    Before Poses   < FIRST       the shape before the sequence was begun, or the user's own key "Pose"
    poses          FIRST + 8 i   the keyed poses in the order of time, and what is generated in between
    hold, scratch  HOLD, SCRATCH only while an unkeyed pose is shown, see below

The Key's `eval_time` has one F-curve with a key for each keyed pose, whose value is that of the pose's block;
the curve alone says when a pose is shown, so that the user times and eases them in Blender's own editors. A
pose whose key was duplicated there is shown and edited at several frames; one whose key was removed has none.
Keys with other values are the user's retiming and stay what they are. `Object.planar.poses` lists the poses
by the eval_times of their blocks; what else is in the played range is no keyed pose.

The played range begins far above the blocks below it, and ends in a copy of its last shape far above that: a
curve that overshoots holds the first or the last pose, as at the ends of any sequence of absolute shape keys.

An unkeyed pose is written to the scratch block and shown by setting `eval_time`, which any frame change takes
back, as it does with every animated value. No curve reaches it: below it comes the hold.

Beginning changes only how shapes are stored. Without shape keys the rest shape becomes the Basis and the
object's own shape is kept in a block. A mesh with a Basis and at most one key "Pose", which is what posing
makes, keeps both. `clear` undoes exactly that. Other shape keys, drivers and actions are the user's and are
refused.
"""
