"""Compile what runs of scenes need of the kernel, fronts inside slabs included: python compile_kernels.py SCENE ..."""

import sys

import numpy as np

from tline.scene.file import read_scene
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe
from tline.solver.loop.march import Stepper


def compile_for(path: str) -> None:
    scene = read_scene(path)
    shortest = min(line.shortest for line in scene.lines.values())
    parts = 4 if "cable" in path else 3.3  # segments take whole slabs
    scene = scene.with_changes(solver={"order": 1, "slab": shortest / parts}, t_end=9 * shortest / parts)
    assembly = assemble(describe(scene), set())
    Stepper(assembly, 9, np.empty((2 * len(assembly.recorded), 2, 9))).compile()


if __name__ == "__main__":
    for scene in sys.argv[1:]:
        compile_for(scene)
