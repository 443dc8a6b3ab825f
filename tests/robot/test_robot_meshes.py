"""Mesh files: opened from the robot's own folders alone, when shapes are asked for."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from helpers.meshes import TRIANGLE, arm, dae, stl
from helpers.urdf_texts import load

from puma_septic.doctor import examine


@pytest.fixture
def folders(tmp_path: Path) -> tuple[Path, Path]:
    """The folder that a URDF is loaded from, and one beside it that is none of its business."""
    stl(tmp_path / "outside" / "secret.stl")
    (tmp_path / "robot").mkdir()
    return tmp_path / "robot", tmp_path / "outside"


@pytest.mark.parametrize("name", ["meshes/fore.stl", "./meshes/../meshes/fore.stl", "file://HOME/meshes/fore.stl"])
def test_opens_a_mesh_in_the_urdfs_folder(folders: tuple[Path, Path], name: str) -> None:
    home, _ = folders
    mesh = stl(home / "meshes" / "fore.stl")
    robot = load(home, arm(name.replace("HOME", str(home))))
    shape = robot.visual_model.geometryObjects[0]
    assert shape.meshPath == str(mesh.resolve())
    assert shape.geometry.vertices().tolist() == TRIANGLE
    assert robot.collision_model.ngeoms == 0


def test_opens_a_package_below_package_dirs(folders: tuple[Path, Path]) -> None:
    home, outside = folders
    stl(outside / "arm_description" / "fore.stl")
    robot = load(home, arm("package://arm_description/fore.stl", "collision"), package_dirs=[outside])
    assert robot.collision_model.ngeoms == 1
    assert robot.missing_meshes == ()


def test_opens_the_package_that_the_urdf_lies_in(tmp_path: Path) -> None:
    package = tmp_path / "arm_description"
    stl(package / "meshes" / "fore.stl")
    (package / "package.xml").write_text("<package/>")
    (package / "urdf").mkdir()
    assert load(package / "urdf", arm("package://arm_description/meshes/fore.stl")).visual_model.ngeoms == 1


@pytest.mark.parametrize(
    "name",
    [
        "../outside/secret.stl",
        "OUTSIDE/secret.stl",
        "file://OUTSIDE/secret.stl",
        "link.stl",
        "package://arm_description/../../outside/secret.stl",
        "package://../outside/secret.stl",
        "package://arm_description/%2e%2e/../../outside/secret.stl",
    ],
)
def test_leaves_out_a_mesh_outside_the_robots_folders(folders: tuple[Path, Path], name: str) -> None:
    """Pinocchio opens each of these. Once they stopped the torque, which needs no mesh."""
    home, outside = folders
    (home / "arm_description").mkdir()
    (home / "arm_description" / "package.xml").write_text("<package><name>arm_description</name></package>")
    (home / "link.stl").symlink_to(outside / "secret.stl")
    robot = load(home, arm(name.replace("OUTSIDE", str(outside))))
    assert robot.visual_model.ngeoms == 0
    assert re.search("outside the robot's folders|leads outside|no package name|not exist", robot.missing_meshes[0])


def test_a_mesh_elsewhere_is_opened_where_its_folder_is_given(folders: tuple[Path, Path]) -> None:
    """What xacrodoc writes: absolute paths, in a URDF that lies elsewhere."""
    home, outside = folders
    name = arm(f"file://{outside}/secret.stl")
    (left_out,) = load(home, name).missing_meshes
    assert f"package_dirs=['{outside}'] adds it" in left_out
    assert load(home, name, package_dirs=[outside]).visual_model.ngeoms == 1


def test_refuses_no_robot_for_a_scheme(tmp_path: Path) -> None:
    robot = load(tmp_path, arm("http://example.com/fore.stl"))
    assert "http:// is not opened, only package://, file:// and plain paths" in robot.missing_meshes[0]


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("package://unknown/fore.stl", r"package 'unknown' was not found; package_dirs=\[FOLDER\]"),
        ("none.stl", "does not exist"),
        (".", "is not a file"),
        ("pipe", "is not a file"),
        ("FORE.stl", "does not exist; there is fore.stl"),
        ("meshes\\fore.stl", "does not exist; a path in a URDF has / between folders"),
        ("lfs.stl", "is a Git LFS pointer, not the mesh; run git lfs pull in"),
        ("empty.stl", "is empty"),
        ("x" * 5000, "is no usable path"),
    ],
)
def test_leaves_out_a_mesh_that_is_not_there(tmp_path: Path, name: str, why: str) -> None:
    """Torques need no meshes: the arm is usable without, and says what would help."""
    os.mkfifo(tmp_path / "pipe")
    stl(tmp_path / "fore.stl")
    (tmp_path / "empty.stl").touch()
    (tmp_path / "lfs.stl").write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n")
    robot = load(tmp_path, arm(name))
    assert re.fullmatch(f"link 'fore': {re.escape(name)} {why}.*", robot.missing_meshes[0])
    assert robot.visual_model.ngeoms == 0


def package(folder: Path, name: str) -> Path:
    """A package as vendors have it, with a mesh."""
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(f'<package format="2"><name>{name}</name></package>')
    stl(folder / "meshes" / "a.stl")
    (folder / "urdf").mkdir()
    return folder


def test_packages_are_called_what_their_package_xml_says(tmp_path: Path) -> None:
    """Folders named as cloned (UR's and Franka's descriptions), and a second package of the same repository."""
    home = package(tmp_path / "mini_description-main", "mini_description") / "urdf"
    package(tmp_path / "resources-main", "mini_resources")
    for name in ("package://mini_description/meshes/a.stl", "package://mini_resources/meshes/a.stl",
                 "model://mini_resources/meshes/a.stl", "../meshes/a.stl"):  # fmt: skip
        robot = load(home, arm(name))
        assert (robot.missing_meshes, robot.visual_model.ngeoms) == ((), 1)


@pytest.mark.parametrize(
    "manifest",
    [
        "<package><name>mini</name>" + " " * 100_000 + "</package>",  # larger than any manifest
        "<package><name>mini</package>",
        "<package><title>mini</title></package>",
        '<!DOCTYPE package [<!ENTITY n "mini">]><package><name>&n;</name></package>',
    ],
)
def test_a_package_xml_that_cannot_be_trusted_names_no_package(tmp_path: Path, manifest: str) -> None:
    home = package(tmp_path / "mini-main", "mini") / "urdf"
    (tmp_path / "mini-main" / "package.xml").write_text(manifest)
    (missing,) = load(home, arm("package://mini/meshes/a.stl")).missing_meshes
    assert "package 'mini' was not found" in missing


def test_meshes_beside_the_urdfs_folder_need_no_package(tmp_path: Path) -> None:
    (tmp_path / "robot" / "urdf").mkdir(parents=True)
    stl(tmp_path / "robot" / "meshes" / "a.stl")
    assert load(tmp_path / "robot" / "urdf", arm("../meshes/a.stl")).missing_meshes == ()


@pytest.mark.parametrize("given", ["ws/src", "ws", "ws/src/repo/mini", "ws/install"])
def test_package_dirs_are_packages_their_parents_or_workspaces(tmp_path: Path, given: str) -> None:
    """Also as `colcon build --symlink-install` leaves a workspace: links that lead out of it."""
    source = package(tmp_path / "ws" / "src" / "repo" / "mini", "mini_resources")
    share = tmp_path / "ws" / "install" / "mini_resources" / "share" / "mini_resources"
    (share / "meshes").mkdir(parents=True)
    for part in ("package.xml", "meshes/a.stl"):
        (share / part).symlink_to(source / part)
    (tmp_path / "elsewhere").mkdir()
    robot = load(tmp_path / "elsewhere", arm("package://mini_resources/meshes/a.stl"), package_dirs=[tmp_path / given])
    assert (robot.missing_meshes, robot.visual_model.ngeoms) == ((), 1)


@pytest.mark.parametrize("image", ["/etc/hostname", "../../outside/secret.stl", "file:///etc/hostname", "&#47;etc/x"])
def test_draws_no_mesh_with_a_texture_outside_the_robots_folders(folders: tuple[Path, Path], image: str) -> None:
    """A viewer copies the image that a Collada file names into its scene, whatever file that is."""
    home, _ = folders
    dae(home / "fore.dae", image)
    robot = load(home, arm("fore.dae"))
    assert robot.visual_model.ngeoms == 0
    assert re.search(r"fore\.dae takes its texture '.*' from outside the robot's folders", robot.undrawn[0])


def test_a_texture_beside_its_mesh_is_welcome(tmp_path: Path) -> None:
    dae(tmp_path / "fore.dae", "fore.png")
    assert load(tmp_path, arm("fore.dae")).visual_model.ngeoms == 1


def test_a_mesh_that_is_not_there_is_a_finding(tmp_path: Path) -> None:
    (finding,) = (one for one in examine(load(tmp_path, arm("none.stl"))).findings if one.code == "no_mesh")
    assert (finding.severity, finding.parts) == ("missing", ("fore",))
    assert finding.message.startswith("not found, so not drawn: link 'fore': none.stl")


def test_draws_no_mesh_with_a_document_type(tmp_path: Path) -> None:
    """Its entities would be expanded, or read from elsewhere."""
    path = tmp_path / "fore.dae"
    dae(path, "fore.png")
    path.write_text(path.read_text().replace("<COLLADA", '<!DOCTYPE c [<!ENTITY a "b">]><COLLADA', 1))
    (left_out,) = load(tmp_path, arm("fore.dae")).undrawn
    assert "fore.dae is not well-formed XML: a document type (DOCTYPE) is not allowed in a mesh file" in left_out


def test_zeros_after_a_collada_file_do_not_matter(tmp_path: Path) -> None:
    """ros-industrial's iiwa 14 has them; assimp reads it."""
    path = tmp_path / "fore.dae"
    dae(path, "fore.png")
    path.write_bytes(path.read_bytes() + b"\0\0")
    robot = load(tmp_path, arm("fore.dae"))
    assert (robot.visual_model.ngeoms, robot.undrawn) == (1, ())


def test_draws_no_mesh_with_a_vertex_nowhere(tmp_path: Path) -> None:
    stl(tmp_path / "fore.stl", [[0.0, 0.0, 0.0], [float("nan"), 0.0, 0.0], [0.0, 1.0, 0.0]])
    robot = load(tmp_path, arm("fore.stl"))
    assert robot.visual_model.ngeoms == 0
    assert "has a non-finite vertex" in robot.undrawn[0]


def test_one_unreadable_mesh_leaves_the_others_drawn(tmp_path: Path) -> None:
    """It once stopped the replay, with a message that began with a line of another project's source."""
    (tmp_path / "fore.stl").write_text("hello")
    shape = '<link name="base"><visual><geometry><box size="1 1 1"/></geometry></visual></link>'
    robot = load(tmp_path, arm("fore.stl").replace('<link name="base"/>', shape))
    assert robot.visual_model.ngeoms == 1
    assert robot.undrawn == (f"link 'fore': {tmp_path.resolve()}/fore.stl cannot be read: File is too small",)
