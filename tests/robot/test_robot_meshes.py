"""Mesh files: opened from the robot's own folders alone, when shapes are asked for."""

from __future__ import annotations

from pathlib import Path

import pytest
from helpers.meshes import TRIANGLE, arm, dae, stl
from helpers.urdf_texts import load

import puma_septic as ps


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
def test_refuses_a_mesh_outside_the_robots_folders(folders: tuple[Path, Path], name: str) -> None:
    """Pinocchio opens each of these."""
    home, outside = folders
    (home / "arm_description").mkdir()
    (home / "link.stl").symlink_to(outside / "secret.stl")
    with pytest.raises(ps.ModelError, match=r"line 5, <mesh> of link 'fore': .*(outside|not in|leaves)"):
        load(home, arm(name.replace("OUTSIDE", str(outside))), package_dirs=[home])


def test_refuses_other_schemes(tmp_path: Path) -> None:
    with pytest.raises(ps.ModelError, match="only package://, file:// and plain paths are opened, not http://"):
        load(tmp_path, arm("http://example.com/fore.stl"))


@pytest.mark.parametrize("name", ["package://unknown/fore.stl", "none.stl", ".", "pipe"])
def test_leaves_out_a_mesh_that_is_not_there(tmp_path: Path, name: str) -> None:
    """Torques need no meshes: the arm is usable without, and says so."""
    import os

    os.mkfifo(tmp_path / "pipe")
    robot = load(tmp_path, arm(name))
    assert robot.missing_meshes == (f"link 'fore': {name}",)
    assert robot.visual_model.ngeoms == 0


def test_a_name_too_long_for_the_file_system(tmp_path: Path) -> None:
    with pytest.raises(ps.ModelError, match="is no usable path"):
        load(tmp_path, arm("x" * 5000))


@pytest.mark.parametrize("image", ["/etc/hostname", "../../outside/secret.stl", "file:///etc/hostname", "&#47;etc/x"])
def test_refuses_a_texture_outside_the_robots_folders(folders: tuple[Path, Path], image: str) -> None:
    """A viewer copies the image that a Collada file names into its scene, whatever file that is."""
    home, _ = folders
    dae(home / "fore.dae", image)
    robot = load(home, arm("fore.dae"))
    with pytest.raises(ps.ModelError, match=r"fore\.dae: its texture '.*' lies outside the robot's folders"):
        _ = robot.visual_model


def test_a_texture_beside_its_mesh_is_welcome(tmp_path: Path) -> None:
    dae(tmp_path / "fore.dae", "fore.png")
    assert load(tmp_path, arm("fore.dae")).visual_model.ngeoms == 1


def test_refuses_a_mesh_with_a_vertex_nowhere(tmp_path: Path) -> None:
    stl(tmp_path / "fore.stl", [[0.0, 0.0, 0.0], [float("nan"), 0.0, 0.0], [0.0, 1.0, 0.0]])
    with pytest.raises(ps.ModelError, match=r"fore\.stl: this mesh has a non-finite vertex"):
        _ = load(tmp_path, arm("fore.stl")).visual_model


def test_a_mesh_that_is_no_mesh(tmp_path: Path) -> None:
    (tmp_path / "fore.stl").write_text("hello")
    with pytest.raises(ps.ModelError, match="the shapes cannot be built"):
        _ = load(tmp_path, arm("fore.stl")).visual_model
