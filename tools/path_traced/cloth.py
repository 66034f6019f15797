"""Lets a skirt fall by Blender's cloth simulation, over hips of rings and legs that are cones. Metres; arrays are glTF's (Y up)."""

import struct
import tempfile
from pathlib import Path

import bpy
import numpy as np

from actor_file import LEG_LABELS

FABRICS = {  # per vertex kg; stiffness by Blender's scale
    "soft": dict(mass=0.15, tension_stiffness=5, compression_stiffness=5, shear_stiffness=5, bending_stiffness=1),
    "cotton": dict(mass=0.3, tension_stiffness=15, compression_stiffness=15, shear_stiffness=15, bending_stiffness=4),
    "stiff": dict(mass=0.4, tension_stiffness=30, compression_stiffness=30, shear_stiffness=30, bending_stiffness=15),
}
PINNED = (0.10, 0.22)  # of the way from waist to hem: held by the body, falls freely from there on
# What the hips fill: heights above the hip joints, and how far it is to the back, the front and the sides, all by the
# height of the person. A skirt lies on the buttocks and the belly and hangs from there.
HIPS = np.array([(0.085, 0.055, 0.066, 0.080), (0.05, 0.072, 0.062, 0.090), (0.01, 0.082, 0.052, 0.098),
                 (-0.025, 0.080, 0.035, 0.098), (-0.05, 0.068, 0.020, 0.090)])
RING_SIDES = 24
GAP_M = 0.006  # between cloth and hips or legs
THINNEST_M = 0.01  # of hips or a leg
LINING_M = 0.02  # what is so near to the cloth at rest counts as much as all neighbours


def to_blender(points):
    return points[..., [0, 2, 1]] * np.array([1, -1, 1])


def from_blender(points):
    return points[..., [0, 2, 1]] * np.array([1, 1, -1])


def vertex_normals(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normals = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(normals, faces[:, k], np.cross(b - a, c - a))
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)


def mesh_object(name, vertices, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(to_blender(vertices).tolist(), [], faces.tolist())
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def write_pc2(path, frames, fps):
    """frames [f x n x 3], as they are."""
    header = struct.pack("<12siiffi", b"POINTCACHE2", 1, frames.shape[1], 0, 1 / fps, len(frames))
    path.write_bytes(header + frames.astype("<f4").tobytes())


class MovingMesh:
    """A mesh whose vertices are given for each frame; frame i of the list is frame i + 1 of the scene."""

    def __init__(self, name, frames, faces, folder):
        self.thing = mesh_object(name, frames[0], faces)
        path = folder / f"{name}.pc2"
        write_pc2(path, to_blender(frames), 1)
        cache = self.thing.modifiers.new("frames", "MESH_CACHE")
        cache.cache_format = "PC2"
        cache.filepath = str(path)
        cache.frame_start = 1

    def remove(self):
        bpy.data.objects.remove(self.thing)


def capsule(ends, radii, rings=10, sides=16):
    """[v x 3] of a cone with round ends (their vertices always in the same order), and its faces."""
    axis = ends[1] - ends[0]
    length = np.linalg.norm(axis)
    w = axis / length
    u = np.cross(w, [0.2, 0.1, 1.0])
    u /= np.linalg.norm(u)
    v = np.cross(w, u)
    points = []
    for k in range(2 * rings):
        end = k // rings
        latitude = np.pi / 2 * ((k % rings) / (rings - 0.5) - (0.95 if end == 0 else 0))
        for turn in 2 * np.pi * np.arange(sides) / sides:
            ring = np.cos(latitude) * (np.cos(turn) * u + np.sin(turn) * v) + np.sin(latitude) * w
            points.append(ends[end] + radii[end] * ring)
    grid = np.arange(len(points)).reshape(-1, sides)
    a, b = grid[:-1], grid[1:]
    quads = np.stack([a, np.roll(a, -1, 1), np.roll(b, -1, 1), b], -1).reshape(-1, 4)
    return np.array(points), quads


def ring_faces(rings, sides):
    """Triangles of a closed body of rings, from the top downwards."""
    grid = np.arange(rings * sides).reshape(rings, sides)
    a, b = grid[:-1], grid[1:]
    after_a, after_b = np.roll(a, -1, 1), np.roll(b, -1, 1)
    walls = np.concatenate([np.stack(corners, -1).reshape(-1, 3)
                            for corners in ((a, b, after_a), (after_a, b, after_b))])
    second = np.arange(1, sides - 1)
    first = np.zeros_like(second)
    lid = np.stack([first, second, second + 1], -1)
    return np.concatenate([walls, lid, grid[-1, 0] + lid[:, ::-1]])


def distance_to_segment(points, a, b):
    """Distances, and where along the segment (0..1)."""
    t = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
    return np.linalg.norm(points - a - t[:, None] * (b - a), axis=1), t


class Skirt:
    """sheet: what falls; lid: the inside that closes a skirt towards the legs and goes between both."""

    def __init__(self, actor):
        self.actor = actor
        skirt = actor.skirt()
        normals = vertex_normals(actor.vertices, actor.faces)
        outwards = actor.vertices - actor.joints[actor.names.index("Hips")]
        outwards[:, 1] = 0
        outwards /= np.maximum(np.linalg.norm(outwards, axis=1, keepdims=True), 1e-9)
        inside = ((normals * outwards).sum(axis=1) < -0.2) | (normals[:, 1] < -0.6)
        waist, hem = actor.vertices[skirt, 1].max(), actor.vertices[skirt, 1].min()
        drop = (waist - actor.vertices[:, 1]) / (waist - hem)
        legs = np.isin(actor.labels, LEG_LABELS)
        lid = self._reached(legs[actor.faces].any(axis=1), skirt & inside)
        self.sheet = self._reached((drop < 0.15)[actor.faces].any(axis=1), skirt & ~lid)
        self.lid = skirt & ~self.sheet
        fade = np.clip((PINNED[1] - drop) / (PINNED[1] - PINNED[0]), 0, 1)
        self.pin = np.where(self.sheet, fade, 1.0)

    def _reached(self, first_faces, allowed):
        """Those allowed vertices that are connected with some faces through faces that are allowed wholly."""
        reached = np.zeros(len(allowed), bool)
        reached[self.actor.faces[first_faces]] = True
        reached &= allowed
        faces = self.actor.faces[allowed[self.actor.faces].all(axis=1)]
        while True:
            grown = reached.copy()
            grown[faces[reached[faces].any(axis=1)]] = True
            if (grown == reached).all():
                return reached
            reached = grown

    def simulate(self, skinned, joints, hips, fabric):
        """skinned [frames x n x 3], joints [frames x bones x 3], hips [frames x 3 x 3] how they are turned ->
        [frames x n x 3]."""
        faces = self.actor.faces
        used_faces = faces[self.sheet[faces].any(axis=1) & ~self.lid[faces].any(axis=1)]
        used = np.unique(used_faces)
        place = np.full(len(self.pin), -1)
        place[used] = np.arange(len(used))
        result = skinned.copy()
        with tempfile.TemporaryDirectory() as name:
            sheet = MovingMesh("sheet", skinned[:, used], place[used_faces], Path(name))
            limbs = [self._hips(joints, hips, Path(name)), *self._limbs(joints, Path(name))]
            self._set_up(sheet.thing, fabric, used, len(skinned))
            for frame in range(len(skinned)):
                bpy.context.scene.frame_set(frame + 1)
                shown = sheet.thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
                points = np.empty(3 * len(used))
                shown.vertices.foreach_get("co", points)
                result[frame, used] = from_blender(points.reshape(-1, 3))
            for mesh in [sheet, *limbs]:
                mesh.remove()
        return self._with_lid(result, skinned)

    def _set_up(self, thing, fabric, used, n_frames):
        group = thing.vertex_groups.new(name="pin")
        for i, weight in enumerate(self.pin[used]):
            group.add([i], weight, "REPLACE")
        cloth = thing.modifiers.new("cloth", "CLOTH")
        for name, value in FABRICS[fabric].items():
            setattr(cloth.settings, name, value)
        cloth.settings.quality = 8
        cloth.settings.air_damping = 1.5
        cloth.settings.vertex_group_mass = "pin"
        cloth.settings.pin_stiffness = 50
        cloth.collision_settings.distance_min = GAP_M
        cloth.collision_settings.collision_quality = 4
        cloth.collision_settings.use_self_collision = True
        cloth.collision_settings.self_distance_min = GAP_M / 2
        cloth.point_cache.frame_start, cloth.point_cache.frame_end = 1, n_frames

    def _hips(self, joints, turned, folder):
        """Elliptic rings around the middle of the hip joints, nowhere nearer to the cloth at rest than it may be."""
        at = self.actor.names.index
        middle = (self.actor.joints[at("LeftUpLeg")] + self.actor.joints[at("RightUpLeg")]) / 2
        tall = self.actor.vertices[:, 1].max()
        sheet = self.actor.vertices[self.actor.skirt() & ~self.lid] - middle
        far = np.hypot(sheet[:, 0], sheet[:, 2])
        towards = np.arctan2(sheet[:, 0], sheet[:, 2])
        points = []
        for height, back, front, sides in tall * HIPS:
            level = np.abs(sheet[:, 1] - height) < 0.03
            for angle in 2 * np.pi * np.arange(RING_SIDES) / RING_SIDES:
                depth = front if np.cos(angle) > 0 else back
                body = 1 / np.hypot(np.sin(angle) / sides, np.cos(angle) / depth)
                beside = level & (np.abs(np.angle(np.exp(1j * (towards - angle)))) < 0.3)
                reach = min(body, far[beside].min(initial=1) - 1.5 * GAP_M)
                if reach < THINNEST_M:
                    raise ValueError("its skirt is too narrow for the hips in it")
                points.append((reach * np.sin(angle), height, reach * np.cos(angle)))
        points = np.array(points) + middle - self.actor.joints[at("Hips")]
        frames = np.einsum("fij,pj->fpi", turned, points) + joints[:, None, at("Hips")]
        return self._obstacle("hips", frames, ring_faces(len(HIPS), RING_SIDES), 0.5, folder)

    @staticmethod
    def _obstacle(name, frames, faces, friction, folder):
        body = MovingMesh(name, frames, faces, folder)
        body.thing.modifiers.new("collision", "COLLISION")
        body.thing.collision.thickness_outer = GAP_M / 2
        body.thing.collision.cloth_friction = friction
        return body

    def _limbs(self, joints, folder):
        rest, at = self.actor.joints, self.actor.names.index
        sheet = self.actor.vertices[self.sheet]
        tall = self.actor.vertices[:, 1].max()
        limbs = []
        for names, thick in [(("LeftUpLeg", "RightUpLeg"), (0.062, 0.062)),
                             *[((f"{side}UpLeg", f"{side}Leg"), (0.050, 0.036)) for side in ("Left", "Right")],
                             *[((f"{side}Leg", f"{side}Foot"), (0.036, 0.026)) for side in ("Left", "Right")]]:
            a, b = (at(name) for name in names)
            far, along = distance_to_segment(sheet, rest[a], rest[b])
            near = [far[along < 0.5].min(initial=1), far[along >= 0.5].min(initial=1)]
            radii = [min(tall * thick[k], near[k] - 1.5 * GAP_M) for k in (0, 1)]  # cloth at rest is outside
            if min(radii) < THINNEST_M:
                raise ValueError("its skirt is too narrow for the legs in it")
            shapes = [capsule(frame[[a, b]], radii) for frame in joints]
            points = np.array([points for points, _ in shapes])
            limbs.append(self._obstacle("-".join(names), points, shapes[0][1], 3, folder))
        return limbs

    def _with_lid(self, fallen, skinned):
        """The lid's displacement is harmonic between that of the hem and that of the legs. Where cloth is close, the
        lid is its lining and goes with it."""
        rest = self.actor.vertices
        lid, sheet = np.flatnonzero(self.lid), np.flatnonzero(self.sheet)
        far = np.linalg.norm(rest[lid, None] - rest[sheet], axis=2)
        nearest = sheet[far.argmin(axis=1)]
        lining = 6 * (LINING_M / np.maximum(far.min(axis=1), 1e-4)) ** 2
        edges = np.concatenate([self.actor.faces[:, [i, (i + 1) % 3]] for i in range(3)])
        edges = edges[self.lid[edges[:, 0]]]
        place = np.cumsum(self.lid) - 1
        total_weight = np.bincount(place[edges[:, 0]], minlength=len(lid)) + lining
        for frame in range(len(fallen)):
            moved = fallen[frame] - skinned[frame]
            worn = lining[:, None] * moved[nearest]
            for _ in range(300):
                total = worn.copy()
                np.add.at(total, place[edges[:, 0]], moved[edges[:, 1]])
                moved[lid] = total / total_weight[:, None]
            fallen[frame] = skinned[frame] + moved
        return fallen
