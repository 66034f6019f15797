"""Reads what a sequence needs of an actor.glb, and writes it with other positions (docs/formats.md: The actor)."""

import json
import struct

import numpy as np

COMPONENTS = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
BONES = ("Hips", "Spine", "Spine1", "Spine2", "Neck", "Head",
         *(f"{side}{part}" for side in ("Left", "Right")
           for part in ("Shoulder", "Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot")))
LEAST_HEM_M = 0.08
SKIRT_LABEL = 12  # LIP
LEG_LABELS = (8, 16, 17, 18, 19)  # socks, legs, shoes


class ActorFile:
    """One skinned, textured primitive. Metres, Y up, +Z front, +X the subject's left.

    vertices [n x 3] welded in order of first occurrence, faces [m x 3] of them, corner_uvs [m x 3 x 2], labels [n],
    weights [n x bones], names and parents of the bones (parents come first), joints [bones x 3] at rest, image: bytes.
    """

    def __init__(self, path):
        data = path.read_bytes()
        if data[:4] != b"glTF":
            raise ValueError("no GLB file")
        size = struct.unpack_from("<I", data, 8)[0]
        if len(data) < size:
            raise ValueError(f"cut short, {len(data)} of {size} bytes")
        json_size = struct.unpack_from("<I", data, 12)[0]
        self.document = json.loads(data[20 : 20 + json_size])
        self.binary = bytearray(data[20 + json_size + 8 :])
        primitives = [p for mesh in self.document["meshes"] for p in mesh["primitives"]]
        if len(primitives) != 1 or "_LABEL" not in primitives[0]["attributes"]:
            raise ValueError("must have one primitive, with _LABEL")
        self.primitive = primitives[0]
        for key, what in (("skins", "skin"), ("images", "texture")):
            if not self.document.get(key):
                raise ValueError(f"it has no {what}")
        if "TEXCOORD_0" not in self.primitive["attributes"] or "indices" not in self.primitive:
            raise ValueError("it has no texture coordinates or no indices")
        attributes = {name: self._values(index) for name, index in self.primitive["attributes"].items()}
        self._weld(attributes["POSITION"])
        corners = self._values(self.primitive["indices"]).reshape(-1, 3).astype(int)
        self.faces = self.welded[corners]
        self.corner_uvs = attributes["TEXCOORD_0"][corners]
        self.labels = np.rint(attributes["_LABEL"].reshape(-1)[self.first]).astype(int)
        self._read_skin(attributes)
        missing = sorted(set(BONES) - set(self.names))
        if missing:
            raise ValueError(f"bones are missing: {', '.join(missing)}")
        if not self.skirt().any():
            raise ValueError(f"it wears no skirt (label {SKIRT_LABEL}); dresses are not made")
        if not (self.weights.sum(axis=1) > 0).all():
            raise ValueError("a vertex has no skinning weight")
        material = self.document["materials"][self.primitive["material"]]
        texture = self.document["textures"][material["pbrMetallicRoughness"]["baseColorTexture"]["index"]]
        image = self.document["images"][texture["source"]]
        if "bufferView" not in image:
            raise ValueError("its texture must lie in the file")
        view = self.document["bufferViews"][image["bufferView"]]
        start = view.get("byteOffset", 0)
        self.image = bytes(self.binary[start : start + view["byteLength"]])

    def _values(self, accessor_index):
        accessor = self.document["accessors"][accessor_index]
        view = self.document["bufferViews"][accessor["bufferView"]]
        dtype = np.dtype(COMPONENTS[accessor["componentType"]])
        width = WIDTHS[accessor["type"]]
        stride = view.get("byteStride", width * dtype.itemsize)
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return np.ndarray((accessor["count"], width), dtype, self.binary, start, (stride, dtype.itemsize))

    def _weld(self, positions):
        index_of = {}
        self.welded = np.array([index_of.setdefault(tuple(p), len(index_of)) for p in positions.tolist()])
        self.first = np.unique(self.welded, return_index=True)[1]
        self.vertices = positions[self.first].astype(np.float64)

    def _read_skin(self, attributes):
        nodes = self.document["nodes"]
        skin = self.document["skins"][0]
        parent_of = {child: i for i, node in enumerate(nodes) for child in node.get("children", [])}
        depth = lambda node: 1 + depth(parent_of[node]) if node in parent_of else 0
        order = sorted(range(len(skin["joints"])), key=lambda i: depth(skin["joints"][i]))
        place = {skin["joints"][i]: k for k, i in enumerate(order)}
        self.names = [nodes[skin["joints"][i]]["name"].split(":")[-1] for i in order]
        self.parents = [place.get(parent_of.get(skin["joints"][i]), -1) for i in order]
        inverse_binds = self._values(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1).astype(float)
        self.joints = np.linalg.inv(inverse_binds)[order][:, :3, 3]
        self.weights = np.zeros((len(self.vertices), len(order)))
        weights = attributes["WEIGHTS_0"].astype(float)
        if attributes["WEIGHTS_0"].dtype != np.float32:
            weights /= np.iinfo(attributes["WEIGHTS_0"].dtype).max
        back = np.argsort(order)
        for k in range(4):
            np.add.at(self.weights, (np.arange(len(self.vertices)), back[attributes["JOINTS_0"][self.first, k]]),
                      weights[self.first, k])
        self.weights /= np.maximum(self.weights.sum(axis=1, keepdims=True), 1e-9)

    def skirt(self):
        """[n] whether a vertex is of a skirt."""
        return self.labels == SKIRT_LABEL

    def reshape_skirt(self, length, width):
        """Stretches what hangs below the waist; normals stay as they are."""
        mask = self.skirt()
        waist = self.vertices[mask, 1].max()
        hem = self.vertices[mask, 1].min()
        if waist - (waist - hem) * length < LEAST_HEM_M:
            raise ValueError(f"a skirt {length:g} times as long would lie on the floor")
        axis = self.joints[self.names.index("Hips")][[0, 2]]
        drop = (waist - self.vertices[mask, 1]) / (waist - hem)  # 0 at the waist, 1 at the hem
        self.vertices[mask, 1] = waist - drop * (waist - hem) * length
        widened = 1 + (width - 1) * drop[:, None]
        self.vertices[np.ix_(mask, [0, 2])] = axis + (self.vertices[np.ix_(mask, [0, 2])] - axis) * widened

    def write(self, path):
        """The file with the positions of today."""
        accessor = self.document["accessors"][self.primitive["attributes"]["POSITION"]]
        positions = self._values(self.primitive["attributes"]["POSITION"])
        positions[:] = self.vertices[self.welded]
        accessor["min"], accessor["max"] = positions.min(axis=0).tolist(), positions.max(axis=0).tolist()
        text = json.dumps(self.document).encode()
        text += b" " * (-len(text) % 4)
        size = 12 + 8 + len(text) + 8 + len(self.binary)
        path.write_bytes(struct.pack("<4sIII4s", b"glTF", 2, size, len(text), b"JSON") + text
                         + struct.pack("<I4s", len(self.binary), b"BIN\0") + self.binary)
