"""Makes a sequence with ground truth by Blender: a room, lamps, path-traced light, and cloth that is not LiveCap's.

    apt-get install blender ffmpeg python3-numpy python3-pil
    blender -b --python-exit-code 1 --python tools/path_traced/make_sequence.py -- \\
        --actor V/actor.glb --motion walk --seed 1 --out V2

Any actor with _LABEL, a texture, Mixamo's bones and a skirt will do, so V may be what `livecap synth` made. Writes what
`livecap synth` writes (docs/formats.md: A sequence). Same options, same sequence on the same machine. Two cores take
some 20 seconds for a frame of 540x960 with 32 paths a pixel, one a minute or two for the cloth of a sequence.
"""

import argparse
import json
import shutil
import signal
import struct
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

try:
    import bpy
    import numpy as np
    from PIL import Image
except ModuleNotFoundError as missing:
    print(f"error: {missing.name} is missing: run this in Blender, with python3-numpy and python3-pil", file=sys.stderr)
    sys.exit(2)

import balance
import cloth
import motions
import posing
import room
from actor_file import ActorFile

FPS = 30
EMPTY_FRAMES = 10
SETTLING_FRAMES = 30  # cloth falls from its rest shape, nobody sees it
NOISE_LEVELS = 1.6  # sensor noise, standard deviation of 8 bits


def fail(text):
    print(f"error: {text}", file=sys.stderr)
    sys.exit(2)


class Parser(argparse.ArgumentParser):
    def error(self, message):  # one line, without the usage
        fail(message)


def parse_arguments():
    parser = Parser(prog="make_sequence.py", description=__doc__.split("\n")[0])
    parser.add_argument("--actor", type=Path, required=True, help="GLB")
    parser.add_argument("--out", type=Path, required=True, help="folder, made when missing")
    parser.add_argument("--motion", choices=sorted(motions.MOVEMENTS), default="walk")
    parser.add_argument("--pace", type=float, default=1.0, help="2: twice as fast")
    parser.add_argument("--crouch", type=float, default=0.04,
                        help="metres that the hips are low; legs reach the floor from 0.04 on")
    parser.add_argument("--fabric", choices=sorted(cloth.FABRICS), default="cotton")
    parser.add_argument("--skirt-length", type=float, default=1.0, help="by that of the actor's")
    parser.add_argument("--skirt-width", type=float, default=1.0, help="at the hem, by that of the actor's")
    parser.add_argument("--frames", type=int, default=0, help="at most, with a person; 0: until the movement ends")
    parser.add_argument("--width", type=int, default=540)
    parser.add_argument("--height", type=int, default=960)
    parser.add_argument("--samples", type=int, default=32, help="paths per pixel")
    parser.add_argument("--floor", action="store_true", help="camera.json says where the floor is")
    parser.add_argument("--seed", type=int, default=1, help="of room, lamps, camera, balance and noise")
    arguments = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])
    for size in (arguments.width, arguments.height):
        if size < 64 or size % 2:
            parser.error(f"a picture's side must be even and at least 64, not {size}")
    for name, low, high in (("pace", 0.25, 4), ("crouch", 0.04, 0.3), ("skirt_length", 0.5, 2), ("skirt_width", 0.5, 2),
                            ("samples", 1, 10000), ("frames", 0, 100000), ("seed", 0, 2**32)):
        if not low <= getattr(arguments, name) <= high:
            parser.error(f"--{name.replace('_', '-')} {getattr(arguments, name)}: must be in {low} .. {high}")
    if not arguments.actor.is_file():
        parser.error(f"--actor {arguments.actor}: no such file")
    if arguments.actor.resolve() == (arguments.out / "actor.glb").resolve():
        parser.error(f"--out {arguments.out}: the actor lies there and would be written over")
    if bpy.app.version >= (4, 0, 0):
        parser.error(f"Blender {bpy.app.version_string}: its shaders have other names; 3.x is needed")
    if not shutil.which("ffmpeg"):
        parser.error("ffmpeg is missing: apt-get install ffmpeg")
    return arguments


def moved_person(actor, arguments, random):
    """[frames x n x 3] vertices, [frames x bones x 3] joints, room frame."""
    poser = posing.Poser(actor)
    sequence = motions.postures(arguments.motion, FPS, arguments.crouch, arguments.pace)
    feet = motions.Feet(poser, sequence, FPS)
    balance.balance(poser, sequence, feet, FPS, random)
    sequence = sequence[: arguments.frames or len(sequence)]
    settling = [dict(sequence[0], dip=sequence[0]["dip"] * min(i / 20, 1)) for i in range(SETTLING_FRAMES)]
    vertices, joints, hips = [], [], []
    for i, posture in enumerate(settling + sequence):
        rotations, places = poser.pose(posture, feet.at(max(i - SETTLING_FRAMES, 0)))
        vertices.append(poser.skinned(rotations, places))
        joints.append(places)
        hips.append(rotations[poser.at["Hips"]])
    vertices, joints = np.array(vertices), np.array(joints)
    fallen = cloth.Skirt(actor).simulate(vertices, joints, np.array(hips), arguments.fabric)
    return fallen[SETTLING_FRAMES:], joints[SETTLING_FRAMES:]


def place_camera(joints, arguments, random):
    """[4 x 4] room from camera, and the focal length in px: everybody is in the picture, which looks down a little."""
    focal = arguments.height * random.uniform(0.95, 1.15)
    pitch = np.radians(random.uniform(0, 10))
    middle = (joints.reshape(-1, 3).min(axis=0) + joints.reshape(-1, 3).max(axis=0)) / 2
    turn = posing.rotation(posing.Y, random.uniform(-0.15, 0.15)) @ posing.rotation(posing.X, -pitch)
    turn = turn @ posing.rotation(posing.Z, np.radians(random.uniform(-0.8, 0.8)))
    camera = np.eye(4)
    camera[:3, :3] = turn
    distance = 2.4
    while True:
        camera[:3, 3] = middle + turn @ (0, 0, distance)
        seen = (joints - camera[:3, 3]) @ turn
        picture = focal * np.abs(seen[..., :2]) / -seen[..., 2:]
        if (picture[..., 0].max() < 0.43 * arguments.width) and (picture[..., 1].max() < 0.42 * arguments.height):
            return camera, focal
        distance += 0.05


def write_camera(arguments, camera, focal):
    values = dict(width=arguments.width, height=arguments.height, fx=focal, fy=focal, cx=(arguments.width - 1) / 2,
                  cy=(arguments.height - 1) / 2, distortion=[0] * 5)
    if arguments.floor:
        up = camera[:3, :3].T @ posing.Y * [1, -1, -1]  # OpenCV's axes
        values["floor"] = dict(normal=up.tolist(), distance_mm=1000 * camera[1, 3])
    (arguments.out / "camera.json").write_text(json.dumps(values))


class Sensor:
    """What a camera makes of a picture: slowly drifting gain, noise, H.264."""

    def __init__(self, path, arguments, random):
        self.random, self.phase, self.frame = random, random.uniform(0, 6), 0
        self.encoder = subprocess.Popen(
            ["ffmpeg", "-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s",
             f"{arguments.width}x{arguments.height}", "-r", str(FPS), "-i", "-", "-c:v", "libx264", "-crf", "18",
             "-pix_fmt", "yuv420p", str(path)], stdin=subprocess.PIPE, start_new_session=True)

    def see(self, picture):
        gain = 1 + 0.015 * np.sin(self.phase + 0.05 * self.frame)
        levels = 255 * gain * picture + self.random.normal(0, NOISE_LEVELS, picture.shape)
        try:
            self.encoder.stdin.write(np.clip(np.rint(levels), 0, 255).astype(np.uint8).tobytes())
        except BrokenPipeError:
            fail("ffmpeg stopped; it must have libx264")
        self.frame += 1

    def close(self):
        self.encoder.stdin.close()
        if self.encoder.wait():
            fail("ffmpeg failed")


def write_truth(folder, vertices, joints, actor):
    """vertices, joints: camera frame, of the frames with a person."""
    nobody = np.full((EMPTY_FRAMES, *vertices.shape[1:]), np.nan)
    cloth.write_pc2(folder / "vertices.pc2", np.concatenate([nobody, vertices]), FPS)
    frames = [None] * EMPTY_FRAMES + [np.round(frame, 6).tolist() for frame in joints]
    (folder / "joints.json").write_text(json.dumps({"names": actor.names, "frames": frames}))
    np.save(folder / "labels.npy", actor.labels.astype(np.uint8))


def main():
    try:
        make(parse_arguments())
    except OSError as wrong:
        fail(wrong)


def make(arguments):
    random = np.random.default_rng(arguments.seed)
    try:
        actor = ActorFile(arguments.actor)
        if (arguments.skirt_length, arguments.skirt_width) != (1, 1):
            actor.reshape_skirt(arguments.skirt_length, arguments.skirt_width)
    except (ValueError, KeyError, IndexError, TypeError, struct.error) as wrong:
        fail(f"{arguments.actor} is no actor for this: {wrong}")
    masks = arguments.out / "truth" / "masks"
    masks.mkdir(parents=True, exist_ok=True)
    for old in masks.glob("*.png"):
        old.unlink()
    actor.write(arguments.out / "actor.glb")

    bpy.ops.wm.read_factory_settings(use_empty=True)
    try:
        vertices, joints = moved_person(actor, arguments, np.random.default_rng([arguments.seed, 1]))
    except ValueError as wrong:
        fail(f"{arguments.actor} is no actor for this: {wrong}")
    camera, focal = place_camera(joints, arguments, random)
    seen = lambda points: (points - camera[:3, 3]) @ camera[:3, :3]
    write_truth(masks.parent, seen(vertices), seen(joints), actor)
    write_camera(arguments, camera, focal)

    room.build_room(random)
    room.set_camera(camera, arguments.width, arguments.height, focal)
    scratch = arguments.out / "frame.png"
    empty = room.render(scratch, 2 * arguments.samples)[..., :3]
    Image.fromarray(np.rint(255 * empty).astype(np.uint8)).save(arguments.out / "background.png")
    person = room.build_person(actor, arguments.out)
    sensor = Sensor(arguments.out / "video.mp4", arguments, random)
    nothing = np.zeros((arguments.height, arguments.width), np.uint8)
    for frame in range(EMPTY_FRAMES):
        sensor.see(empty)
        Image.fromarray(nothing).save(masks / f"{frame:06d}.png")
    ended = []  # a run that is ended leaves a video of what there is
    signal.signal(signal.SIGTERM, lambda number, _: ended.append(number))
    for frame, points in enumerate(vertices):
        if ended:
            break
        room.show(person, points)
        sensor.see(room.render(scratch, arguments.samples)[..., :3])
        covered = room.render(scratch, 8, only=person)[..., 3]
        Image.fromarray(np.rint(255 * covered).astype(np.uint8)).save(masks / f"{frame + EMPTY_FRAMES:06d}.png")
        print(f"frame {frame + 1} of {len(vertices)}", flush=True)
    (arguments.out / "texture.bin").unlink()
    sensor.close()
    if ended:
        sys.exit(1)


if __name__ == "__main__":
    main()
