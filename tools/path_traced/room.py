"""A room with furniture and lamps, the person in it, and its pictures by Cycles. Lists are glTF's (Y up), metres."""

import bpy
import numpy as np
from mathutils import Matrix
from PIL import Image

from cloth import mesh_object, to_blender

Y_UP_TO_Z_UP = Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))
FACES_OF_A_BOX = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])


def material(name, color, color_b=None, pattern=None, scale=5.0):
    """A dull one of one colour, or of two in a pattern: NOISE, CHECKER, WAVE, BRICK."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    shader = nodes.new("ShaderNodeBsdfDiffuse")
    links.new(shader.outputs["BSDF"], nodes["Material Output"].inputs["Surface"])
    nodes.remove(nodes["Principled BSDF"])
    if pattern is None:
        shader.inputs["Color"].default_value = (*color, 1)
        return made
    where = nodes.new("ShaderNodeTexCoord")
    texture = nodes.new({"NOISE": "ShaderNodeTexNoise", "CHECKER": "ShaderNodeTexChecker", "WAVE": "ShaderNodeTexWave",
                         "BRICK": "ShaderNodeTexBrick"}[pattern])
    texture.inputs["Scale"].default_value = scale
    links.new(where.outputs["Object"], texture.inputs["Vector"])
    mix = nodes.new("ShaderNodeMixRGB")
    mix.inputs["Color1"].default_value = (*color, 1)
    mix.inputs["Color2"].default_value = (*color_b, 1)
    links.new(texture.outputs["Fac"], mix.inputs["Fac"])
    links.new(mix.outputs["Color"], shader.inputs["Color"])
    return made


def box(name, low, high, of):
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
    mesh_object(name, corners, FACES_OF_A_BOX).data.materials.append(of)


def lamp(place, towards, watts, size, color=(1, 0.95, 0.88)):
    light = bpy.data.lights.new("lamp", "AREA")
    light.energy, light.size, light.color = watts, size, color
    thing = bpy.data.objects.new("lamp", light)
    z = np.asarray(place, float) - towards  # an area lamp shines along its -Z
    z /= np.linalg.norm(z)
    x = np.cross([0.1, 1, 0.05], z)
    x /= np.linalg.norm(x)
    frame = np.eye(4)
    frame[:3, 0], frame[:3, 1], frame[:3, 2], frame[:3, 3] = x, np.cross(z, x), z, place
    thing.matrix_world = Y_UP_TO_Z_UP @ Matrix(frame.tolist())
    bpy.context.scene.collection.objects.link(thing)


def build_room(random):
    """Floor, walls and furniture; the person stands around the origin, the camera looks along -Z."""
    tone = lambda low, high: tuple(random.uniform(low, high) * random.uniform(0.55, 1, 3))
    floor = material("floor", tone(0.15, 0.4), tone(0.1, 0.3), random.choice(["WAVE", "BRICK", "NOISE"]), 2.5)
    wall = material("wall", tone(0.35, 0.7), tone(0.3, 0.65), "NOISE", 3)
    back = -random.uniform(1.8, 2.8)
    box("floor", (-4, -0.1, back - 0.5), (4, 0, 6), floor)
    box("back", (-4, 0, back - 0.1), (4, 4, back), wall)
    for side in (-1, 1):
        x = side * random.uniform(2.0, 2.8)
        box("side", (min(x, x + side * 0.1), 0, back), (max(x, x + side * 0.1), 4, 5), wall)
    box("skirting", (-4, 0, back), (4, 0.09, back + 0.02), material("white", (0.7, 0.7, 0.68)))
    for i in range(7):  # cupboards, shelves and pictures along the back wall
        x = -1.7 + 0.55 * i + random.uniform(-0.15, 0.15)
        width, depth = random.uniform(0.2, 0.5), random.uniform(0.05, 0.4)
        colors = tone(0.05, 0.6), tone(0.05, 0.6)
        pattern = random.choice(["NOISE", "CHECKER", "WAVE", None])
        paint = material(f"paint{i}", *colors, pattern, random.uniform(3, 12))
        low = 0 if random.random() < 0.6 else random.uniform(0.9, 1.5)
        high = low + random.uniform(0.4, 1.1)
        box(f"thing{i}", (x, low, back), (x + width, high, back + (depth if low == 0 else 0.04)), paint)
    lamp((random.uniform(-1.6, 1.6), 2.7, random.uniform(0.5, 2.2)), (0, 1, 0), random.uniform(60, 110),
         random.uniform(0.5, 1.4))
    if random.random() < 0.6:
        place = (random.uniform(-2, 2), 2.2, random.uniform(2.5, 4))
        lamp(place, (0, 1, -0.5), random.uniform(25, 60), 0.8, (0.9, 0.95, 1))
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (0.75, 0.85, 1, 1)
    world.node_tree.nodes["Background"].inputs[1].default_value = random.uniform(0.15, 0.35)
    bpy.context.scene.world = world


def build_person(actor, folder):
    """The welded mesh with its texture; show() moves it."""
    person = mesh_object("person", actor.vertices, actor.faces)
    mesh = person.data
    uvs = actor.corner_uvs.reshape(-1, 2) * [1, -1] + [0, 1]  # glTF counts v downwards
    mesh.uv_layers.new().data.foreach_set("uv", uvs.reshape(-1))
    mesh.polygons.foreach_set("use_smooth", [True] * len(actor.faces))
    image = folder / "texture.bin"
    image.write_bytes(actor.image)
    paint = bpy.data.materials.new("person")
    paint.use_nodes = True
    shader = paint.node_tree.nodes["Principled BSDF"]
    shader.inputs["Roughness"].default_value, shader.inputs["Specular"].default_value = 0.7, 0.2
    texture = paint.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = bpy.data.images.load(str(image))
    paint.node_tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    mesh.materials.append(paint)
    return person


def show(person, vertices):
    person.data.vertices.foreach_set("co", to_blender(vertices).reshape(-1))
    person.data.update()


def set_camera(camera, width, height, focal_px):
    """camera [4 x 4] room from camera, glTF's axes; the principal point is in the middle."""
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "VERTICAL" if height > width else "HORIZONTAL"
    data.sensor_width = data.sensor_height = 36
    data.lens = 36 * focal_px / max(width, height)
    thing = bpy.data.objects.new("camera", data)
    bpy.context.scene.collection.objects.link(thing)
    thing.matrix_world = Y_UP_TO_Z_UP @ Matrix(camera.tolist())
    scene = bpy.context.scene
    scene.camera = thing
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100


def render(path, samples, only=None):
    """[h x w x 4] 0..1 as on a screen, top row first. only: everything else is left out, alpha is what it covers."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.max_bounces = samples, 3
    scene.cycles.use_denoising = False
    scene.cycles.use_adaptive_sampling = False
    scene.view_settings.view_transform = "Standard"
    scene.render.film_transparent = only is not None
    scene.render.use_persistent_data = True
    hidden = [thing for thing in scene.objects if only is not None and thing not in (only, scene.camera)]
    for thing in hidden:
        thing.hide_render = True
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    for thing in hidden:
        thing.hide_render = False
    pixels = np.asarray(Image.open(path), np.float32) / 255
    path.unlink()
    return pixels
