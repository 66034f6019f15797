"""Opens a capture in Blender (3.4 or newer) and compares what Blender shows with the other files of the capture.

    blender -b --python-exit-code 1 --python tools/check_blender.py -- CAPTURE_DIR [--render PICTURE.png]

- capture.glb: counts, animation range, and every vertex of every frame against vertices.pc2
- motion.bvh: joint positions of a few frames against joints.csv
- vertices.pc2: through the Mesh Cache modifier on the actor, against the file itself

Prints one line per check and ends with exit code 1 when one fails. Not part of the tests, because Blender is not among
the required packages.
"""

import argparse
import csv
import json
import struct
import sys
from pathlib import Path

try:
    import bpy
    import numpy as np
except ModuleNotFoundError as missing:
    sys.exit(f"error: {missing.name} is missing; run this inside Blender: blender -b --python tools/check_blender.py -- DIR")

# What Blender computes in float32 on top of the error that capture.glb itself has (report.json tells it).
FLOAT_MARGIN_MM = 0.02
BVH_TOLERANCE_MM = 0.02
N_SAMPLES = 6

failures = []


def check(name, ok, text):
    print(f"{'ok  ' if ok else 'FAIL'} {name}: {text}")
    if not ok:
        failures.append(name)


def gltf_from_blender(points):
    """[n x 3] from Blender's Z up to the files' Y up."""
    return points[:, [0, 2, 1]] * np.array([1, 1, -1])


def evaluated_vertices_m(blender_object):
    """[n x 3] vertices with all modifiers at the current frame, metres, glTF frame."""
    evaluated = blender_object.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    local = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", local)
    world = np.array(evaluated.matrix_world)
    evaluated.to_mesh_clear()
    return gltf_from_blender(local.reshape(-1, 3).astype(np.float64) @ world[:3, :3].T + world[:3, 3])


def read_pc2(path):
    """[frames x points x 3] metres."""
    data = path.read_bytes()
    magic, _, n_points, _, _, n_samples = struct.unpack_from("<12siiffi", data)
    assert magic == b"POINTCACHE2\0", path
    return np.frombuffer(data, "<f4", 3 * n_points * n_samples, 32).reshape(n_samples, n_points, 3)


def template_order(path):
    """Per vertex of the GLB its index in the template: equal positions are one vertex, in order of first occurrence."""
    data = path.read_bytes()
    json_size = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + json_size])
    accessor = document["accessors"][document["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
    start = 28 + json_size + document["bufferViews"][accessor["bufferView"]]["byteOffset"]
    seen = {}
    return np.array([seen.setdefault(data[start + 12 * i : start + 12 * (i + 1)], len(seen))
                     for i in range(accessor["count"])])


def start_scene(fps):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    render = bpy.context.scene.render
    render.fps = round(fps)
    render.fps_base = round(fps) / fps


def import_glb(path):
    # Not the default NORMALS, with which Debian's Blender 3.4 and NumPy 1.24 fail on any file.
    bpy.ops.import_scene.gltf(filepath=str(path), import_shading="SMOOTH")
    meshes = [o for o in bpy.data.objects if o.type == "MESH" and o.find_armature()]
    armatures = [o for o in bpy.data.objects if o.type == "ARMATURE"]
    assert len(meshes) == 1 and len(armatures) == 1, [o.name for o in bpy.data.objects]
    return meshes[0], armatures[0]


def check_glb(folder, report, truth, tracked, fps):
    start_scene(fps)
    mesh, armature = import_glb(folder / "capture.glb")
    order = template_order(folder / "capture.glb")
    n_shapes = len(mesh.data.shape_keys.key_blocks) - 1 if mesh.data.shape_keys else 0
    check("glb vertices", len(mesh.data.vertices) == len(order) and order.max() + 1 == truth.shape[1],
          f"{len(mesh.data.vertices)} with seams, {order.max() + 1} welded, vertices.pc2 has {truth.shape[1]}")
    check("glb shapes", n_shapes == report["morph_targets"], f"{n_shapes} shape keys")
    check("glb bones", len(armature.data.bones) >= 14, f"{len(armature.data.bones)}")
    ranges = [action.frame_range for action in bpy.data.actions]
    check("glb animation", all(np.allclose(r, [tracked[0], tracked[-1]], atol=1e-3) for r in ranges) and ranges,
          f"{len(ranges)} actions, frames {ranges[0][0]:g} to {ranges[0][1]:g} at {fps:g} fps")
    worst, means = 0, []
    for frame in tracked:
        bpy.context.scene.frame_set(frame)
        error = 1000 * np.linalg.norm(evaluated_vertices_m(mesh) - truth[frame][order], axis=1)
        worst = max(worst, error.max())
        means.append(error.mean())
    check("glb surface", abs(worst - report["max_error_mm"]) <= FLOAT_MARGIN_MM,
          f"mean {np.mean(means):.4f} mm, max {worst:.4f} mm; the capture itself says "
          f"{report['mean_error_mm']:.4f} and {report['max_error_mm']:.4f} mm")


def mend_bvh_importer():
    """Debian's Blender 3.4 opens the file in a mode that its Python 3.11 no longer has."""
    from io_anim_bvh import import_bvh

    import_bvh.open = lambda path, mode="r": open(path, mode.replace("U", ""))


def check_bvh(folder, tracked, fps):
    start_scene(fps)
    mend_bvh_importer()
    bpy.ops.import_anim.bvh(filepath=str(folder / "motion.bvh"), global_scale=0.01)
    armature = bpy.context.object
    with open(folder / "joints.csv") as file:
        rows = list(csv.DictReader(file))
    worst = 0
    for frame in samples(tracked):
        bpy.context.scene.frame_set(frame + 1)  # the importer knows no frame 0
        for bone in armature.pose.bones:
            head = gltf_from_blender(np.array([armature.matrix_world @ bone.head]))[0]
            truth = [float(rows[frame][f"joint_{bone.name}_{axis}"]) for axis in "xyz"]
            worst = max(worst, 1000 * np.linalg.norm(head - truth))
    check("bvh joints", worst <= BVH_TOLERANCE_MM, f"{len(armature.pose.bones)} bones, max {worst:.4f} mm from joints.csv")


def check_pc2(folder, truth, fps):
    start_scene(fps)
    mesh, armature = import_glb(folder / "actor.glb")
    bpy.data.objects.remove(armature)
    mesh.parent = None
    mesh.matrix_world.identity()
    mesh.modifiers.clear()
    bpy.context.view_layer.objects.active = mesh
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.remove_doubles(threshold=1e-6)
    bpy.ops.object.mode_set(mode="OBJECT")
    cache = mesh.modifiers.new("capture", "MESH_CACHE")
    cache.cache_format = "PC2"
    cache.filepath = str(folder / "vertices.pc2")
    cache.frame_start = 0
    cache.forward_axis, cache.up_axis = "POS_Z", "NEG_Y"  # what turns the file's Y up into Blender's Z up
    worst = 0
    for frame in samples(range(len(truth))):
        bpy.context.scene.frame_set(frame)
        shown = evaluated_vertices_m(mesh)
        if shown.shape != truth[frame].shape:
            check("pc2", False, f"{len(shown)} vertices after merging, the file has {truth.shape[1]}")
            return
        worst = max(worst, 1000 * np.linalg.norm(shown - truth[frame], axis=1).max())
    check("pc2", worst <= FLOAT_MARGIN_MM, f"max {worst:.4f} mm through the Mesh Cache modifier")


def samples(frames):
    return [frames[i] for i in sorted({round(x) for x in np.linspace(0, len(frames) - 1, N_SAMPLES)})]


def render(folder, frame, fps, picture):
    """A picture of capture.glb from where the camera of the capture was."""
    start_scene(fps)
    import_glb(folder / "capture.glb")
    scene = bpy.context.scene
    scene.frame_set(frame)
    of_capture = json.loads((folder / "camera.json").read_text())
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.rotation_euler = (np.pi / 2, 0, 0)  # glTF looks along -Z, which is Blender's +Y
    camera.data.sensor_fit = "HORIZONTAL"
    camera.data.angle = 2 * np.arctan(of_capture["width"] / 2 / of_capture["fx"])
    light = bpy.data.objects.new("light", bpy.data.lights.new("light", "SUN"))
    light.data.energy = 3
    light.rotation_euler = (0.9, 0.2, 0.3)
    for thing in (camera, light):
        scene.collection.objects.link(thing)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("world")
    scene.world.color = (0.4, 0.4, 0.4)
    scene.render.engine = "CYCLES"  # needs no display
    scene.cycles.samples = 8
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y = of_capture["width"], of_capture["height"]
    scene.render.resolution_percentage = 50
    scene.render.filepath = str(Path(picture).resolve())
    bpy.ops.render.render(write_still=True)


def main():
    parser = argparse.ArgumentParser(prog="check_blender.py")
    parser.add_argument("capture", type=Path)
    parser.add_argument("--render", metavar="PICTURE.png")
    options = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])
    folder = options.capture.resolve()
    truth = read_pc2(folder / "vertices.pc2")
    with open(folder / "joints.csv") as file:
        tracked = [i for i, row in enumerate(csv.DictReader(file)) if row["tracked"] == "1"]
    bvh_head = (folder / "motion.bvh").read_text().split("Frame Time:")[1].split()
    fps = 1 / float(bvh_head[0])
    report = json.loads((folder / "report.json").read_text())["capture_glb"]
    check_glb(folder, report, truth, tracked, fps)
    check_bvh(folder, tracked, fps)
    check_pc2(folder, truth, fps)
    if options.render:
        render(folder, tracked[len(tracked) // 2], fps, options.render)
    if failures:
        sys.exit("check_blender.py: failed: " + ", ".join(failures))


main()
