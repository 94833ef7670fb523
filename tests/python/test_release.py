# SPDX-License-Identifier: GPL-3.0-or-later
"""What states a version or the supported Blenders agrees, and what does not is told before a release."""

import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

PROJECT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(PROJECT / "tools"))

import build_repository  # noqa: E402
import release  # noqa: E402

STATING = (
    *("CMakeLists.txt", "CHANGELOG.md", "README.md", "addon/planar_deform/blender_manifest.toml"),
    *("docs/bake.md", "tools/requirements/bpy-4.2.23.txt", "tools/requirements/bpy-5.2.3.txt"),
)


@pytest.fixture
def project(tmp_path):
    """What of the project states something."""
    kept = [release.KEPT / f"{release.version_of(PROJECT)}{suffix}" for suffix in (".blend", ".json")]
    for name in (*STATING, *kept):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(PROJECT / name, tmp_path / name)
    return tmp_path


def test_the_project_agrees_with_itself():
    assert release.disagreements(PROJECT) == []


@pytest.mark.parametrize(
    ("name", "pattern", "replacement", "told"),
    [
        (
            "CMakeLists.txt",
            r"deform VERSION [\d.]+",
            "deform VERSION 7.0.0",
            ["manifest", "CHANGELOG", "7.0.0.blend", "7.0.0.json"],
        ),
        (
            "addon/planar_deform/blender_manifest.toml",
            r'\nversion = "[^"]+"',
            '\nversion = "7.0.0"',
            ["manifest"],
        ),
        (
            "addon/planar_deform/blender_manifest.toml",
            r'blender_version_min = "[^"]+"',
            'blender_version_min = "4.5.0"',
            ["begins with Blender 4.5.0, the tests with 4.2"],
        ),
        ("CHANGELOG.md", r"\n## .*\n", "\n## Next\n", ["'## "]),
        ("CHANGELOG.md", r"Blender 4\.2.*to 5\.2", "Blender", ["CHANGELOG.md does not say"]),
        ("README.md", r"4\.2( LTS)? to 5\.2", "4.2 to 5.1", ["README.md does not say 'Blender 4.2 to 5.2'"]),
        ("docs/bake.md", r"\Z", "\nFor Blender 4.1 to 5.2.", ["docs/bake.md does not say"]),
    ],
)
def test_what_says_something_else_is_told(project, name, pattern, replacement, told):
    assert release.disagreements(project) == []
    text = (project / name).read_text()
    changed = re.sub(pattern, replacement, text, count=1)
    assert changed != text
    (project / name).write_text(changed)
    found = release.disagreements(project)
    assert len(found) == len(told)
    assert all(part in reason for part, reason in zip(told, found, strict=True))


def test_a_version_without_a_kept_file_is_told(project):
    (project / release.KEPT / f"{release.version_of(project)}.blend").unlink()
    (reason,) = release.disagreements(project)
    assert "make_kept_file.py" in reason


@pytest.mark.skipif(shutil.which("git") is None, reason="no git is here (Windows under wine)")
def test_only_a_clean_commit_with_the_version_s_tag_is_published(project):
    def git(*arguments):
        identity = ("-c", "user.name=A", "-c", "user.email=a@example.org")
        subprocess.run(["git", *identity, *arguments], cwd=project, check=True, capture_output=True)

    tag = f"v{release.version_of(project)}"
    git("init")
    git("add", ".")
    git("commit", "-m", "All")
    assert [reason[:17] for reason in release.unpublishable(project)] == [f"The tag {tag} is"]
    git("tag", tag)
    assert release.unpublishable(project) == []
    (project / "README.md").write_text("Another")
    assert ["changes" in reason for reason in release.unpublishable(project)] == [True]
    git("commit", "-am", "More")
    assert ["raise the version" in reason for reason in release.unpublishable(project)] == [True]


def archive(folder, label, version, platforms):
    path = folder / f"planar_deform-{version}-{label}.zip"
    listed = ", ".join(f'"{platform}"' for platform in platforms)
    with zipfile.ZipFile(path, "w") as content:
        content.writestr("blender_manifest.toml", f'version = "{version}"\nplatforms = [{listed}]\n')
    return path


def test_of_the_archives_each_platform_has_one_in_the_repository(tmp_path):
    windows = archive(tmp_path, "windows", "1.0.0", ["windows-x64"])
    every = archive(tmp_path, "all", "1.0.0", ["linux-x64", "windows-x64"])
    old = archive(tmp_path, "linux", "0.9.0", ["linux-x64"])
    assert build_repository.chosen([every, old, windows], "1.0.0") == [windows, every]
    linux = archive(tmp_path, "linux", "1.0.0", ["linux-x64"])
    assert build_repository.chosen([every, linux, old, windows], "1.0.0") == [linux, windows]


def test_the_page_s_links_tell_blender_what_it_asks_for():
    entry = {
        "name": "Planar <Deform>",
        "tagline": "Pose",
        "version": "1.0.0",
        "blender_version_min": "4.2.0",
        "archive_size": 1_230_000,
    }
    windows = {
        **entry,
        "archive_url": "./b.zip",
        "platforms": ["windows-x64"],
        "python_versions": ["3.11", "3.13"],
    }
    page = build_repository.page([{**entry, "archive_url": "./a.zip", "platforms": ["linux-x64"]}, windows])
    assert "<h1>Planar &lt;Deform&gt; 1.0.0</h1>" in page
    assert "@" not in page
    assert page.index("./b.zip") < page.index("./a.zip"), "by platform"
    link = "./b.zip?repository=.%2Findex.json&amp;blender_version_min=4.2.0&amp;platforms=windows-x64"
    assert f'href="{link}&amp;python_versions=3.11%2C3.13"' in page
    assert "<b>Windows</b><span>1.2 MB</span>" in page
