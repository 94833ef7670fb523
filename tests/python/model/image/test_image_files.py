# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the files of images are what they were."""

from planar_deform.model.image.image_files import (
    ImageFile,
    is_changed,
    joined,
    packed,
    recognised,
    size_of,
    unpacked,
)

BODY, ARM = ImageFile("body.png", "1/9", 40, 30), ImageFile("arm.png", "2/5", 8, 8)
PAINTED = BODY._replace(state="7/9")
OTHER = ImageFile("paper.png", "4/4")


def test_what_was_written_again_is_changed():
    assert not is_changed([BODY, ARM], [BODY, ARM])
    assert is_changed([BODY, ARM], [PAINTED, ARM])
    assert not is_changed([BODY], [BODY._replace(state="")])  # it is gone


def test_order_and_images_beside_them_do_not_count():
    assert not is_changed([BODY, ARM], [OTHER, ARM, BODY])
    assert is_changed([BODY, ARM], [OTHER, ARM, PAINTED])
    assert not is_changed([BODY, ARM], [ARM])


def test_another_file_in_its_place_is_a_change_and_a_new_name_is_none():
    assert is_changed([BODY, ARM], [OTHER, ARM])
    assert not is_changed([BODY], [BODY._replace(name="hero.png")])


def test_files_of_one_name_are_told_apart():
    left, right = ImageFile("body.png", "1/9", 40, 30), ImageFile("body.png", "2/2", 50, 30)
    assert not is_changed([left, right], [right, left])
    assert is_changed([left, right], [left, right._replace(state="3/3")])
    assert size_of([left, right], [left, right], "body.png") is None
    assert size_of([left, ARM], [left, ARM], "body.png") == (40, 30)
    assert size_of([OTHER], [OTHER], "paper.png") is None


def test_a_new_version_has_the_size_of_the_one_before_it():
    version = BODY._replace(name="body_v2.png", state="8/8", width=90)
    assert size_of([BODY, ARM], [version, ARM], "body_v2.png") == (40, 30)
    assert size_of([BODY, ARM], [version], "body_v2.png") is None  # of either


def test_it_is_stored_as_text():
    assert unpacked(packed([BODY, ARM]), ()) == [BODY, ARM]
    assert unpacked(joined(packed([BODY, ARM]), packed([ARM, OTHER])), ()) == [BODY, ARM, OTHER]
    assert joined("", packed([ARM])) == packed([ARM])
    assert joined(packed([ARM]), "") == packed([ARM])


def test_older_files_kept_states_alone():
    assert unpacked("1/9||4/4", ["body.png", "arm.png", "paper.png"]) == [
        ImageFile("body.png", "1/9"),
        ImageFile("paper.png", "4/4"),
    ]
    assert unpacked("", ["body.png"]) == []


def test_a_copy_is_told_by_its_bytes_which_are_looked_at_only_where_the_size_is_the_same():
    asked = []

    def digest() -> str:
        asked.append(1)
        return "abc"

    kept = ["1/9/abc", "2/5/def", "3/7"]
    assert recognised("1/9", kept, digest) == "1/9/abc"
    assert recognised("8/6", kept, digest) == "8/6"
    assert recognised("8/7", kept, digest) == "8/7"
    assert not asked
    assert recognised("8/9", kept, digest) == "1/9/abc"
    assert recognised("8/5", kept, digest) == "8/5"
    assert recognised("8/9", kept, lambda: "") == "8/9"
